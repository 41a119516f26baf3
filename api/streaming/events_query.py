"""The query of `GET /events`."""

from datetime import datetime, timedelta
from typing import Annotated

from fastapi import Depends, Query

from domain.errors import InvalidValueError
from domain.state_and_mode import PartName
from service.clock import since_epoch, to_datetime
from service.storage.journal import EventQuery

MAX_EVENTS = 1_000
_DEFAULT_EVENTS = 100
_MAX_TIME = 64
_PER_MILLISECOND = 1_000
_Time = Annotated[
    str | None,
    Query(
        max_length=_MAX_TIME,
        description="RFC 3339, such as `2026-05-04T12:00:00.250Z`",
        json_schema_extra={"format": "date-time"},
    ),
]


async def _events_query(
    after: Annotated[
        int | None, Query(ge=0, lt=2**63, description="Only events after this id, the oldest first")
    ] = None,
    before: Annotated[
        int | None, Query(ge=0, lt=2**63, description="Only events before this id")
    ] = None,
    from_at: _Time = None,
    to_at: _Time = None,
    kind: Annotated[
        str | None,
        Query(
            max_length=100,
            description=(
                "A kind as `change.failed`, all of an area as `change`, or with `*` for any"
                " characters, as `*.failed`"
            ),
        ),
    ] = None,
    part: Annotated[
        str | None, Query(max_length=256, description="Only events whose `data` name this part")
    ] = None,
    actor: Annotated[
        str | None,
        Query(max_length=512, description="Only events of this `actor`; empty: of nobody"),
    ] = None,
    limit: Annotated[
        int, Query(ge=1, le=MAX_EVENTS, description="Most events to return")
    ] = _DEFAULT_EVENTS,
) -> EventQuery:
    """Return what is wanted.

    Raises:
        InvalidValueError: A time is not one, or a range ends before it begins.
    """
    begin, end = _moment(from_at, "from_at"), _moment(to_at, "to_at")
    if begin is not None and end is not None and begin > end:
        raise InvalidValueError(f"query from_at: {from_at} is later than to_at {to_at}")
    if after is not None and before is not None and after > before:
        raise InvalidValueError(f"query after: {after} is above before {before}")
    return EventQuery(
        after=after,
        before=before,
        from_at=begin,
        to_at=None if end is None else _end_of_millisecond(end),
        kind=kind,
        part=None if part is None else PartName(part),
        actor=actor,
        limit=limit,
    )


EventQueryDep = Annotated[EventQuery, Depends(_events_query)]


def _moment(text: str | None, name: str) -> datetime | None:
    """Return a time in UTC.

    Raises:
        InvalidValueError: It is not a time with an offset.
    """
    if text is None:
        return None
    try:
        return to_datetime(since_epoch(datetime.fromisoformat(text)))
    except ValueError as error:
        message = f"query {name}: no time {text!r}; expected such as 2026-05-04T12:00:00.250Z"
        raise InvalidValueError(f"{message}, with + as %2B in a URL") from error
    except InvalidValueError as error:
        raise InvalidValueError(f"query {name}: {error.message}") from error


def _end_of_millisecond(moment: datetime) -> datetime:
    """Return the last moment that is shown as this one: events show whole milliseconds."""
    if moment.microsecond % _PER_MILLISECOND:
        return moment
    return moment + timedelta(microseconds=_PER_MILLISECOND - 1)
