"""Requests rejected at the gate: answered, counted, and logged at a limited rate.

They are not recorded as events, since a flood of them would displace the others.
"""

import logging
from collections import Counter
from collections.abc import Mapping
from http import HTTPStatus

from starlette.types import Receive, Scope, Send

from api.http.problems import problem_response
from api.http.schemas.problem import Problem
from domain.timebase import Instant, seconds
from service.clock import Clock

log = logging.getLogger(__name__)

COUNTED = (HTTPStatus.UNAUTHORIZED, HTTPStatus.FORBIDDEN, HTTPStatus.TOO_MANY_REQUESTS)

_LOG_EVERY = seconds(1)
_POLICY_VIOLATION = 1008


class Refusals:
    """Counts of rejected requests by status; at most one log line per second and status."""

    def __init__(self, clock: Clock) -> None:
        self.counts: Counter[HTTPStatus] = Counter()
        self._clock = clock
        self._quiet_until: dict[HTTPStatus, Instant] = {}
        self._untold: Counter[HTTPStatus] = Counter()

    def note(self, status: HTTPStatus, address: str) -> None:
        """Count a rejected request, and log it if none of its status was in the last second.

        Args:
            status: Of the answer; `/metrics` shows those of `COUNTED`.
            address: Of the client; the request itself is not logged.
        """
        self.counts[status] += 1
        now = self._clock.now()
        if now < self._quiet_until.get(status, now):
            self._untold[status] += 1
            return
        self._quiet_until[status] = now + _LOG_EVERY
        more = self._untold.pop(status, 0)
        untold = f", and {more} more since the last line" if more else ""
        log.warning("%d %s: rejected %s%s", status, status.phrase, address, untold)


async def refuse(
    problem: Problem,
    scope: Scope,
    receive: Receive,
    send: Send,
    headers: Mapping[str, str] | None = None,
) -> None:
    """Answer a request with a problem, or close a WebSocket before it is accepted.

    The server answers such a handshake with 403; browsers do not show pages its body anyway.
    """
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": _POLICY_VIOLATION})
    else:
        await problem_response(problem, headers)(scope, receive, send)


def address_of(scope: Scope) -> str:
    """Return the address of the client, without its port."""
    client = scope.get("client")
    return client[0] if client else "unknown"
