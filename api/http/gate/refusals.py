"""Refusals at the gate: answered, counted, and told in the log without filling it.

They are no events: a flood of them would wash out of the log of events what happened.
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
    """How often clients were turned away, by status; the log has one line a second of each."""

    def __init__(self, clock: Clock) -> None:
        self.counts: Counter[HTTPStatus] = Counter()
        self._clock = clock
        self._quiet_until: dict[HTTPStatus, Instant] = {}
        self._untold: Counter[HTTPStatus] = Counter()

    def note(self, status: HTTPStatus, address: str) -> None:
        """Count a refusal, and log it if none of its kind was logged in the last second.

        Args:
            status: As it was answered; `/metrics` shows those of `COUNTED`.
            address: Of the client; what it tried is not told.
        """
        self.counts[status] += 1
        now = self._clock.now()
        if now < self._quiet_until.get(status, now):
            self._untold[status] += 1
            return
        self._quiet_until[status] = now + _LOG_EVERY
        more = self._untold.pop(status, 0)
        untold = f", and {more} more since the last line" if more else ""
        log.warning("%d %s: refused %s%s", status, status.phrase, address, untold)


async def refuse(
    problem: Problem,
    scope: Scope,
    receive: Receive,
    send: Send,
    headers: Mapping[str, str] | None = None,
) -> None:
    """Answer a request with a problem; a WebSocket is closed before it was accepted.

    The server makes 403 of that. A page is not shown a body anyway.
    """
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": _POLICY_VIOLATION})
    else:
        await problem_response(problem, headers)(scope, receive, send)


def address_of(scope: Scope) -> str:
    """Return the address of the client, without its port."""
    client = scope.get("client")
    return client[0] if client else "unknown"
