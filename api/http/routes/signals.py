"""Signals and their readings."""

from collections.abc import Mapping
from datetime import datetime
from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Body, Depends, Path, Query, Request, Response

from api.http.body_parsing import INVALID_QUERY, InvalidBodyError
from api.http.dependencies import ActorDep, SupervisorDep
from api.http.list_answers import joined
from api.http.path_methods import require_allowed
from api.http.problems import HttpError
from api.http.route_policy import Permission, policy
from api.http.routes.system_state import current_system_state
from api.http.schemas.health import (
    MAX_SOURCE,
    ReadingBody,
    SignalJson,
    SignalsJson,
    TakenReadingsJson,
)
from api.http.schemas.history import HistoryPointJson, SignalHistoryJson
from api.http.schemas.problem import BodyFault
from api.http.schemas.sent_values import SentMoment, SentSignalName, SentSignalValue
from api.http.stop_route import IgnoredDep, StopRoute
from domain.errors import InvalidValueError, UnknownSignalError
from domain.health.signals import signal_name
from domain.inputs import Reading, SignalValue
from domain.timebase import Duration, Instant, seconds, to_seconds
from service.supervisor import Supervisor

router = APIRouter(prefix="/signals", tags=["health"], route_class=StopRoute)

SignalPath = Annotated[SentSignalName, Path(description="One of those in `GET /signals`")]

_MAX_POINTS = 10_000
_DEFAULT_POINTS = 1_000
_DEFAULT_SPAN: Duration = seconds(3_600.0)
_FAR: Instant = 2**62
"""Nothing is recorded so long before or after 1970; calendars go on beyond what 64 bits hold."""
_MOMENT = "RFC 3339 with an offset, such as `2026-05-04T12:00:00Z`. Default: "


@router.get("")
@policy(Permission.OBSERVE)
async def list_signals(supervisor: SupervisorDep) -> SignalsJson:
    """List all signals: their values and errors."""
    clock, now = supervisor.clock, supervisor.clock.now()
    views = supervisor.core.signals().values()
    return SignalsJson(items=[SignalJson.at(view, clock, now) for view in views])


@router.get("/{signal:path}/history", response_model=SignalHistoryJson)
@policy(Permission.OBSERVE)
async def get_history(
    signal: SignalPath,
    supervisor: SupervisorDep,
    from_at: Annotated[
        SentMoment | None, Query(description=f"{_MOMENT}one hour before `to_at`")
    ] = None,
    to_at: Annotated[SentMoment | None, Query(description=f"{_MOMENT}now")] = None,
    points: Annotated[
        int, Query(ge=2, le=_MAX_POINTS, description="At most so many")
    ] = _DEFAULT_POINTS,
) -> Response:
    """Show the history of a signal, for a chart.

    The older, the coarser: single readings are kept for minutes, buckets of 10 min for a year. A
    bucket has the least and the greatest of all its readings, so that no spike is lost. One that
    begins before `from_at` counts as a whole.
    """
    if supervisor.trends is None:
        detail = "a simulation keeps no history of its signals"
        raise HttpError(HTTPStatus.NOT_FOUND, "NO_HISTORY", detail)
    name = supervisor.core.signal(signal).signal
    begin, end = _span(supervisor, from_at, to_at)
    trend = await supervisor.trends.history(name, begin, end, points)
    clock = supervisor.clock
    texts = (HistoryPointJson.of(point, clock).model_dump_json() for point in trend.points)
    text = f'{{"items":[{await joined(texts)}],"tier_s":{to_seconds(trend.width)}}}'
    return Response(text, media_type="application/json")


@router.get("/{signal:path}")
@policy(Permission.OBSERVE)
async def get_signal(signal: SignalPath, supervisor: SupervisorDep) -> SignalJson:
    """Show one signal: its value and errors."""
    clock = supervisor.clock
    return SignalJson.at(supervisor.core.signal(signal), clock, clock.now())


@router.post("", response_model_exclude_unset=True)
@policy(Permission.REPORT)
async def post_readings(
    body: Annotated[
        dict[str, SentSignalValue],
        Body(min_length=1, description="Values by the names of their signals"),
    ],
    supervisor: SupervisorDep,
    actor: ActorDep,
    ignored: IgnoredDep,
) -> TakenReadingsJson:
    """Submit readings of several signals; all or none are accepted.

    If `estop` asks for a stop, it is taken even if the rest is rejected; then `ignored` tells why.

    They are evaluated on arrival; the answer is the resulting system state. A text named `source`
    is the source of the readings, unless there is a signal of that name. The default source is
    `api`, or the mock if it is running. A signal that a device reads is posted at that device; at
    the supervisor it is 409 `ACTS_ELSEWHERE`, except an `estop` that asks for a stop.
    """
    values, source = _named(body), None
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
    return _taken(supervisor, ignored)


async def _no_history(request: Request) -> None:
    """Check that a path is not that of a history, which has the form of a signal's as well."""
    if request.scope["path"].endswith("/history"):
        require_allowed(request)


@router.post(
    "/{signal:path}",
    response_model_exclude_unset=True,
    dependencies=[Depends(_no_history)],
)
@policy(Permission.REPORT)
async def post_reading(
    signal: SignalPath,
    body: ReadingBody,
    supervisor: SupervisorDep,
    actor: ActorDep,
    ignored: IgnoredDep,
) -> TakenReadingsJson:
    """Submit a reading; it is evaluated on arrival, and the answer is the resulting system state.

    `stamp` is only shown; it does not change the age of a reading. A reading older than the current
    one is rejected, unless it is worse. The default `source` is `api`, or the mock if it is
    running. What asks for a stop of `estop` is taken whatever else is in the body; `ignored` tells
    what was not. A signal that a device reads is posted at that device; at the supervisor it is 409
    `ACTS_ELSEWHERE`, except an `estop` that asks for a stop.
    """
    reading = body.reading(signal, supervisor.clock)
    try:
        supervisor.readings.submit([reading], body.source, actor)
    except InvalidValueError as error:
        raise InvalidBodyError.at("value", error) from error
    return _taken(supervisor, ignored)


def _named(body: Mapping[str, SignalValue]) -> dict[str, SignalValue]:
    """Return values by the names of their signals, without leading slashes.

    Raises:
        InvalidBodyError: A signal is named both with and without one.
    """
    values: dict[str, SignalValue] = {}
    for name, value in body.items():
        signal = signal_name(name)
        if signal in values:
            error = InvalidValueError(f"{signal!r} is named twice, with and without a slash")
            raise InvalidBodyError.at(signal, error)
        values[signal] = value
    return values


def _span(
    supervisor: Supervisor, from_at: datetime | None, to_at: datetime | None
) -> tuple[Instant, Instant]:
    """Return begin and end of a history.

    Raises:
        InvalidBodyError: It does not begin before it ends.
    """
    clock = supervisor.clock
    end = clock.now() if to_at is None else clock.from_wall(to_at)
    begin = end - _DEFAULT_SPAN if from_at is None else clock.from_wall(from_at)
    if begin >= end:
        message = "query from_at: must be before to_at, which is now unless it is given"
        fault = BodyFault(pointer="", code=InvalidValueError.code, message=message)
        raise InvalidBodyError([fault], INVALID_QUERY)
    return _within(begin), _within(end)


def _within(at: Instant) -> Instant:
    return max(-_FAR, min(_FAR, at))


def _taken(supervisor: Supervisor, ignored: Mapping[str, object]) -> TakenReadingsJson:
    answer = TakenReadingsJson(**dict(current_system_state(supervisor)))
    return answer.model_copy(update=ignored)
