"""Events as the log keeps them: readable without the classes that they were made from."""

from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import NamedTuple, get_type_hints

from pydantic_core import from_json, to_json

from domain.events.event import Event, RecordedEvent
from domain.state_and_mode import PartName
from domain.timebase import Instant
from service.clock import to_datetime
from service.storage.journal import StoredEvent


class EventRow(NamedTuple):
    """An event as a row of the log."""

    id: int
    at: Instant
    wall_ns: int
    """Nanoseconds since 1970 UTC, by the system clock when it was noted; whole microseconds."""
    kind: str
    cause: int | None
    actor: str
    """Label of the actor."""
    parts: tuple[PartName, ...]
    """Parts that its data name."""
    data: str
    """JSON."""
    words: str
    notable: bool


def event_row(recorded: RecordedEvent, wall_ns: int) -> EventRow:
    """Return an event as a row; `wall_ns` is its wall time."""
    event = recorded.event
    return EventRow(
        recorded.id,
        recorded.at,
        wall_ns,
        event.kind,
        recorded.cause,
        recorded.actor.label,
        named_parts(event),
        to_json(event.data(), inf_nan_mode="null", fallback=plain).decode(),
        event.words,
        event.notable,
    )


def plain(value: object) -> object:
    """Convert a value in the data of an event that JSON has not, such as a read-only mapping."""
    return dict(value) if isinstance(value, Mapping) else str(value)


def stored_event(row: EventRow, boot: int, epoch: str) -> StoredEvent:
    """Return a row as readers of the log get it."""
    return StoredEvent(
        row.id,
        boot,
        epoch,
        row.at,
        to_datetime(row.wall_ns),
        row.kind,
        row.cause,
        row.actor,
        from_json(row.data),
        row.words,
        row.notable,
    )


def named_parts(event: Event) -> tuple[PartName, ...]:
    """Return the parts that the data of an event name, each once."""
    names = (getattr(event, name) for name in _part_fields(type(event)))
    return tuple(dict.fromkeys(name for name in names if name))


_PART_FIELDS: dict[type[Event], tuple[str, ...]] = {}


def _part_fields(kind: type[Event]) -> tuple[str, ...]:
    """Return the fields of a class of events that name a part, looked up once per class."""
    known = _PART_FIELDS.get(kind)
    if known is None:
        known = _PART_FIELDS[kind] = tuple(_fields_of(kind))
    return known


def _fields_of(kind: type[Event]) -> Iterator[str]:
    hints = get_type_hints(kind)
    for item in fields(kind):  # type: ignore[arg-type]
        if hints[item.name] in (PartName, PartName | None):
            yield item.name
