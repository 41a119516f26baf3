"""The rate limit of requests."""

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
"""After a pause a client may send the requests of this many seconds at once."""


class TokenBuckets:
    """A token bucket for each address.

    Only one instant is stored per bucket: when it will be full again. The bucket is full if that
    has passed, and empty if it is as far ahead as filling the bucket takes.
    """

    def __init__(self, per_s: int, max_addresses: int = MAX_ADDRESSES) -> None:
        """Start with full buckets.

        Args:
            per_s: Requests per second of each address.
            max_addresses: Most buckets that are kept.
        """
        self._each: Duration = NANOSECONDS_PER_SECOND // per_s
        self._depth: Duration = _BURST_S * NANOSECONDS_PER_SECOND
        self._max_addresses = max_addresses
        self._full_at: dict[str, Instant] = {}

    def __len__(self) -> int:
        return len(self._full_at)

    def take(self, address: str, now: Instant) -> Duration:
        """Take a token; return 0, or the time until there is one.

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
        """Remove the fullest tenth of the buckets: a full bucket holds no information.

        A tenth at once, so that the search is rare, however many addresses there are.
        """
        fullest = sorted(self._full_at, key=self._full_at.__getitem__)
        for address in fullest[: max(1, self._max_addresses // 10)]:
            del self._full_at[address]


class RateGate:
    """Rejects clients that send too many requests; never limits a stop."""

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
            clock: Of the service.
            policies: Which routes are never limited.
            refusals: Counts rejected requests.
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
        hint = "see `limits.requests_per_s` in the robot file; use WS /ws instead of polling"
        status = HTTPStatus.TOO_MANY_REQUESTS
        return make_problem(status, status.name, detail, path, more={"hint": hint})
