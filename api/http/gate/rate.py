"""How often a client may ask."""

from http import HTTPStatus
from math import ceil

from starlette.types import ASGIApp, Receive, Scope, Send

from api.http.gate.policies import RoutePolicies
from api.http.gate.refusals import Refusals, address_of, refuse
from api.http.problems import make_problem
from api.http.schemas.problem import Problem
from domain.timebase import NANOSECONDS_PER_SECOND, Duration, Instant, to_seconds
from service.clock import Clock

MAX_ADDRESSES = 10_000
_BURST_S = 2
"""A client that was quiet may ask at once what it may ask in so many seconds."""


class TokenBuckets:
    """A token bucket for each address.

    Of a bucket one instant is kept: when it will be full again. It is full if that has passed, and
    empty if that is as far ahead as it takes to fill it.
    """

    def __init__(self, per_s: int, max_addresses: int = MAX_ADDRESSES) -> None:
        """Begin with full buckets.

        Args:
            per_s: Requests per second that each address may make.
            max_addresses: So many buckets are kept.
        """
        self._each: Duration = NANOSECONDS_PER_SECOND // per_s
        self._depth: Duration = _BURST_S * NANOSECONDS_PER_SECOND
        self._max_addresses = max_addresses
        self._full_at: dict[str, Instant] = {}

    def __len__(self) -> int:
        return len(self._full_at)

    def take(self, address: str, now: Instant) -> Duration:
        """Take a token; return 0, or how long it is until there is one.

        Args:
            address: Of the client.
            now: Monotonic time.
        """
        full_at = self._full_at.get(address)
        if full_at is None:
            if len(self._full_at) >= self._max_addresses:
                self._forget_some()
            full_at = now
        full_at = max(full_at, now) + self._each
        missing = full_at - now - self._depth
        if missing > 0:
            return missing
        self._full_at[address] = full_at
        return 0

    def _forget_some(self) -> None:
        """Forget the tenth with the fullest buckets: a full one is as good as none.

        So many at once, that the search is seldom, however many addresses there are.
        """
        fullest = sorted(self._full_at, key=self._full_at.__getitem__)
        for address in fullest[: max(1, self._max_addresses // 10)]:
            del self._full_at[address]


class RateGate:
    """Refuse who asks too often, before anything is done for it; but never a stop."""

    def __init__(
        self,
        app: ASGIApp,
        per_s: int,
        clock: Clock,
        policies: RoutePolicies,
        refusals: Refusals,
    ) -> None:
        """Guard `app`.

        Args:
            app: What is behind the gate.
            per_s: Requests per second of one address; twice as many may come at once.
            clock: Tells how often that is.
            policies: Tells which routes are never limited.
            refusals: Counts who was refused.
        """
        self._app = app
        self._per_s = per_s
        self._clock = clock
        self._policies = policies
        self._refusals = refusals
        self._buckets = TokenBuckets(per_s)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 429."""
        if scope["type"] == "lifespan" or not self._is_limited(scope):
            await self._app(scope, receive, send)
            return
        missing = self._buckets.take(address_of(scope), self._clock.now())
        if not missing:
            await self._app(scope, receive, send)
            return
        self._refusals.note(HTTPStatus.TOO_MANY_REQUESTS, address_of(scope))
        headers = {"Retry-After": str(max(1, ceil(to_seconds(missing))))}
        await refuse(self._problem(scope["path"]), scope, receive, send, headers)

    def _is_limited(self, scope: Scope) -> bool:
        declared = self._policies.of(scope)
        return declared is None or declared.permission.is_limited

    def _problem(self, path: str) -> Problem:
        detail = f"more than {self._per_s} requests a second came from this address"
        hint = "`limits.requests_per_s` in the robot file sets how many may; WS /ws tells by itself"
        status = HTTPStatus.TOO_MANY_REQUESTS
        return make_problem(status, status.name, detail, path, more={"hint": hint})
