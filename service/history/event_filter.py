"""Which events a query wants, for events in memory; a journal chooses its own in the same way."""

from collections.abc import Iterator, Sequence
from dataclasses import fields
from typing import get_type_hints

from domain.events.event import Event, RecordedEvent
from domain.state_and_mode import PartName
from domain.timebase import Instant
from service.clock import Clock
from service.storage.journal import EventQuery

_MICROSECOND: Instant = 1_000


class KindPattern:
    """The kinds that a text means: `change.failed`, all of `change`, or `*.failed`.

    A `*` stands for any characters, also none. Without one, a text means the kind itself and the
    kinds below it: `change` means `change.failed`, and `chang` means nothing.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self._below = f"{text}."
        self._first, *self._more = text.split("*")

    def matches(self, kind: str) -> bool:
        """Tell whether a kind is meant, in time that is linear in its length for each `*`."""
        if not self._more:
            return kind == self._text or kind.startswith(self._below)
        if not kind.startswith(self._first):
            return False
        *between, last = self._more
        at = len(self._first)
        for piece in between:
            # The earliest place of each piece leaves the most for those after it.
            found = kind.find(piece, at)
            if found < 0:
                return False
            at = found + len(piece)
        return kind.endswith(last) and at + len(last) <= len(kind)


def named_parts(event: Event) -> tuple[PartName, ...]:
    """Return the parts that the data of an event name, each once."""
    names = (getattr(event, name) for name in _part_fields(type(event)))
    return tuple(dict.fromkeys(name for name in names if name))


class EventFilter:
    """Chooses events by all that a query says, but for their number."""

    def __init__(self, query: EventQuery, clock: Clock) -> None:
        """Prepare.

        Args:
            query: What is wanted.
            clock: Of the events.
        """
        self._query = query
        self._kind = None if query.kind is None else KindPattern(query.kind)
        self._from = None if query.from_at is None else clock.from_wall(query.from_at)
        # A moment has whole microseconds; the last of them counts in full.
        self._to = None if query.to_at is None else clock.from_wall(query.to_at) + _MICROSECOND - 1

    def accepts(self, recorded: RecordedEvent) -> bool:
        """Tell whether an event is wanted."""
        query = self._query
        return (
            (query.after is None or recorded.id > query.after)
            and (query.before is None or recorded.id < query.before)
            and (self._from is None or recorded.at >= self._from)
            and (self._to is None or recorded.at <= self._to)
            and (self._kind is None or self._kind.matches(recorded.kind))
            and (query.actor is None or recorded.actor.label == query.actor)
            and (query.part is None or query.part in named_parts(recorded.event))
        )


_PART_FIELDS: dict[type[Event], Sequence[str]] = {}


def _part_fields(kind: type[Event]) -> Sequence[str]:
    """Return the names of the fields that name a part, looked up once per class."""
    known = _PART_FIELDS.get(kind)
    if known is None:
        known = _PART_FIELDS[kind] = tuple(_fields_with_parts(kind))
    return known


def _fields_with_parts(kind: type[Event]) -> Iterator[str]:
    hints = get_type_hints(kind)
    for item in fields(kind):  # type: ignore[arg-type]
        if hints[item.name] in (PartName, PartName | None):
            yield item.name
