"""Routes over which a stop may be asked: it is taken, whatever else is wrong with the request."""

import json
from collections.abc import Callable, Coroutine, Mapping
from typing import Annotated, Any

from fastapi import Depends, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute

from api.http.body_parsing import InvalidBodyError, as_pointer, faults_of
from api.http.request_body import JsonRequest, JsonRoute, limits_of, read_body
from api.http.schemas.health import MAX_REASON, MAX_SOURCE
from api.http.schemas.problem import BodyFault
from api.http.stop_asked import stop_body
from domain.actor import Actor
from domain.errors import InvalidValueError, PilothouseError
from domain.health.signals import ESTOP_SIGNAL
from service.refused_readings import RefusedReadings

_IGNORED = "pilothouse.ignored"
_OUTSIDE = frozenset({"body", "query", "path", "header"})

_Handle = Callable[[Request], Coroutine[Any, Any, Response]]


class StopRoute(JsonRoute):
    """A route that can engage a stop.

    A request that is valid is handled as usual. If one is rejected and asks for a stop, it is
    handled again with what is valid of it; the answer has the rest in `ignored`.
    """

    def get_route_handler(self) -> _Handle:
        """Return the framework's handler, called again for a stop that it rejected."""
        handle = APIRoute.get_route_handler(self)
        if self.body_field is None:
            return handle

        async def handle_stop(request: Request) -> Response:
            raw = await read_body(request, limits_of(request).json_bytes)
            try:
                return await handle(JsonRequest.parse(request, raw))
            except (PilothouseError, RequestValidationError) as error:
                faults = _faults_of(error)
                asked = _asked(request, raw)
                told = "; ".join(f"{fault.pointer} {fault.message}".strip() for fault in faults)
                if asked is None:
                    if request.url.path.startswith("/signals"):
                        _refused(request).note(_sender(request), told)
                    raise
            _refused(request).note_ignored(_sender(request), told)
            taken = JsonRequest.of(request, json.dumps(asked).encode(), asked)
            taken.scope[_IGNORED] = faults
            return await handle(taken)

        return handle_stop


# A coroutine, since the framework would call a plain function in a thread.
async def _ignored(request: Request) -> dict[str, list[BodyFault]]:
    found: list[BodyFault] = request.scope.get(_IGNORED, [])
    return {"ignored": found} if found else {}


IgnoredDep = Annotated[dict[str, list[BodyFault]], Depends(_ignored)]
"""The member `ignored` of the answer to a request that asked for a stop; empty: there is none."""


def _asked(request: Request, raw: bytes) -> Mapping[str, object] | None:
    """Return the body of a stop that a request asks for; None: it asks for none."""
    match request.url.path.strip("/").split("/"):
        case ["emergency_stop"]:
            return stop_body(raw, "engaged", {"reason": MAX_REASON})
        case ["signals", signal] if signal == ESTOP_SIGNAL:
            return stop_body(raw, "value", {"source": MAX_SOURCE})
        case ["signals"]:
            return stop_body(raw, ESTOP_SIGNAL, {"source": MAX_SOURCE})
        case ["mock", signal] if signal == ESTOP_SIGNAL:
            return stop_body(raw, "value", {})
    return None


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
