"""Routes over which a stop or hold may be asked: it is taken, whatever else is in the request."""

import json
from collections.abc import Callable, Coroutine, Mapping
from typing import Annotated, Any

from fastapi import Depends, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute

from api.http.body_parsing import (
    BodyTooLargeError,
    InvalidBodyError,
    as_pointer,
    faults_of,
    read_limited,
)
from api.http.request_body import JsonRequest, JsonRoute, limits_of
from api.http.schemas.health import MAX_REASON, MAX_SOURCE
from api.http.schemas.problem import BodyFault
from api.http.schemas.tasks import MAX_HOLD_REASON
from api.http.stop_asked import kept_texts, stop_body
from domain.actor import Actor
from domain.errors import InvalidValueError, PilothouseError
from domain.health.signals import ESTOP_SIGNAL
from service.refused_readings import RefusedReadings

QUERY_FAULT = "pilothouse.query_fault"
"""Key of the scope: the error for which a request is rejected that asks for no stop."""
_IGNORED = "pilothouse.ignored"
_OUTSIDE = frozenset({"body", "query", "path", "header"})

_Handle = Callable[[Request], Coroutine[Any, Any, Response]]


class StopRoute(JsonRoute):
    """A route that can engage a stop, or set a hold.

    A request that is valid is handled as usual. If one is rejected and asks for a stop, it is
    handled again with what is valid of it; the answer has the rest in `ignored`.
    """

    def get_route_handler(self) -> _Handle:
        """Return the framework's handler, called again for a stop that it rejected."""
        handle = APIRoute.get_route_handler(self)
        if self.body_field is None:
            return handle

        async def handle_stop(request: Request) -> Response:
            limit, raw = limits_of(request).json_bytes, b""
            try:
                raw = await read_limited(request.stream(), limit)
                if QUERY_FAULT in request.scope:
                    raise request.scope.pop(QUERY_FAULT)
                return await handle(JsonRequest.parse(request, raw))
            except (PilothouseError, RequestValidationError) as error:
                cut = error.start if isinstance(error, BodyTooLargeError) else None
                asked = _asked(request, raw if cut is None else cut)
                # Not the error itself: with this frame it would be a cycle of garbage.
                faults = _faults_of(error)
                if asked is None:
                    _note_refused(request, faults)
                    raise
            return await _handle_again(handle, request, asked, faults, is_cut=cut is not None)

        return handle_stop


async def _handle_again(
    handle: _Handle,
    request: Request,
    asked: Mapping[str, object],
    faults: list[BodyFault],
    *,
    is_cut: bool,
) -> Response:
    """Handle what is valid of a request that was rejected.

    Args:
        handle: Of the route.
        request: The request.
        asked: The body that is handled.
        faults: Why it was rejected, shown in the answer.
        is_cut: Whether the body is too large, so that its end was not read.
    """
    taken = JsonRequest.of(request, json.dumps(asked).encode(), asked)
    taken.scope[_IGNORED] = faults
    answer = await handle(taken)
    if is_cut:
        # The rest of the body is not read; otherwise it would be read as the next request.
        answer.headers["Connection"] = "close"
    _refused(request).note_ignored(_sender(request), _told(faults))
    return answer


def _note_refused(request: Request, faults: list[BodyFault]) -> None:
    """Count and log a reading that was rejected; other requests are answered, and audited."""
    if request.url.path.startswith("/signals"):
        _refused(request).note(_sender(request), _told(faults))


# A coroutine, since the framework would call a plain function in a thread.
async def _ignored(request: Request) -> dict[str, list[BodyFault]]:
    found: list[BodyFault] = request.scope.get(_IGNORED, [])
    return {"ignored": found} if found else {}


IgnoredDep = Annotated[dict[str, list[BodyFault]], Depends(_ignored)]
"""The member `ignored` of the answer to a request that asked for a stop; empty: there is none."""


def _asked(request: Request, raw: bytes) -> Mapping[str, object] | None:
    """Return the body of a stop or hold that a request asks for; None: it asks for none.

    Args:
        request: That was rejected.
        raw: Its body, or as much of it as was read.
    """
    match [name for name in request.url.path.split("/") if name]:
        case ["emergency_stop"]:
            return stop_body(raw, "engaged", {"reason": MAX_REASON})
        case ["holds", _]:
            return kept_texts(raw, {"reason": MAX_HOLD_REASON})
        case ["signals", signal] if signal == ESTOP_SIGNAL:
            return stop_body(raw, "value", {"source": MAX_SOURCE})
        case ["signals"]:
            return stop_body(raw, ESTOP_SIGNAL, {"source": MAX_SOURCE})
        case ["mock", signal] if signal == ESTOP_SIGNAL:
            return stop_body(raw, "value", {})
    return None


def _told(faults: list[BodyFault]) -> str:
    return "; ".join(f"{fault.pointer} {fault.message}".strip() for fault in faults)


def _faults_of(error: PilothouseError | RequestValidationError) -> list[BodyFault]:
    if isinstance(error, RequestValidationError):
        return faults_of(error.errors(), _OUTSIDE)
    if isinstance(error, InvalidBodyError):
        return list(error.faults)
    pointer = as_pointer(error.pointer) if isinstance(error, InvalidValueError) else ""
    return [BodyFault(pointer=pointer, code=error.code, message=error.message)]


def _sender(request: Request) -> Actor:
    return Actor(way="http", address=request.client.host if request.client else "unknown")


def _refused(request: Request) -> RefusedReadings:
    found: RefusedReadings = request.app.state.supervisor.refused_readings
    return found
