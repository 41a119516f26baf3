"""Which events a query wants, for events in memory; a journal chooses its own in the same way."""

from domain.events.event import RecordedEvent
from domain.timebase import Instant
from service.clock import Clock
from service.storage.event_rows import named_parts
from service.storage.journal import EventQuery
from service.storage.kind_pattern import KindPattern

_MICROSECOND: Instant = 1_000


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
