"""Signals and their readings."""

from typing import Annotated

from fastapi import APIRouter, Body, Path

from api.http.body_parsing import InvalidBodyError
from api.http.dependencies import ActorDep, SupervisorDep
from api.http.request_body import JsonRoute
from api.http.route_policy import Permission, policy
from api.http.routes.system_state import current_system_state
from api.http.schemas.health import (
    MAX_SOURCE,
    ReadingBody,
    SignalJson,
    SignalsJson,
    SystemStateJson,
)
from api.http.schemas.sent_values import SentSignalValue
from domain.errors import InvalidValueError, UnknownSignalError
from domain.inputs import Reading

router = APIRouter(prefix="/signals", tags=["health"], route_class=JsonRoute)

SignalPath = Annotated[str, Path(description="One of those in `GET /signals`")]


@router.get("")
@policy(Permission.OBSERVE)
async def list_signals(supervisor: SupervisorDep) -> SignalsJson:
    """List all signals: their values and errors."""
    clock, now = supervisor.clock, supervisor.clock.now()
    views = supervisor.core.signals().values()
    return SignalsJson(items=[SignalJson.at(view, clock, now) for view in views])


@router.get("/{signal}")
@policy(Permission.OBSERVE)
async def get_signal(signal: SignalPath, supervisor: SupervisorDep) -> SignalJson:
    """Show one signal: its value and errors."""
    clock = supervisor.clock
    return SignalJson.at(supervisor.core.signal(signal), clock, clock.now())


@router.post("")
@policy(Permission.REPORT)
async def post_readings(
    body: Annotated[
        dict[str, SentSignalValue],
        Body(min_length=1, description="Values by the names of their signals"),
    ],
    supervisor: SupervisorDep,
    actor: ActorDep,
) -> SystemStateJson:
    """Submit readings of several signals; all or none are accepted.

    They are evaluated on arrival; the answer is the resulting system state. A text named `source`
    is the source of the readings, unless there is a signal of that name. The default source is
    `api`, or the mock if it is running.
    """
    values, source = dict(body), None
    if "source" not in supervisor.core.signals() and isinstance(values.get("source"), str):
        source = str(values.pop("source"))
        if not 0 < len(source) <= MAX_SOURCE:
            error = InvalidValueError(f"a source has 1 to {MAX_SOURCE} characters")
            raise InvalidBodyError.at("source", error)
    readings = [Reading(signal, value) for signal, value in values.items()]
    try:
        supervisor.readings.submit(readings, source, actor)
    except UnknownSignalError as error:
        raise InvalidBodyError.at(error.name, error) from error
    return current_system_state(supervisor)


@router.post("/{signal}")
@policy(Permission.REPORT)
async def post_reading(
    signal: SignalPath, body: ReadingBody, supervisor: SupervisorDep, actor: ActorDep
) -> SystemStateJson:
    """Submit a reading; it is evaluated on arrival, and the answer is the resulting system state.

    `stamp` is only shown; it does not change the age of a reading. A reading older than the current
    one is rejected, unless it is worse. The default `source` is `api`, or the mock if it is
    running.
    """
    reading = body.reading(signal, supervisor.clock)
    try:
        supervisor.readings.submit([reading], body.source, actor)
    except InvalidValueError as error:
        raise InvalidBodyError.at("value", error) from error
    return current_system_state(supervisor)
