"""Ids without an event: too old to be kept, or published and lost when the service was killed."""

from collections.abc import Awaitable, Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import TypeAlias, TypeVar

from domain.events.event import RecordedEvent
from service.event_log import EventLog, Gap
from service.storage.journal import EventQuery, StoredEvent

Event = TypeVar("Event", bound=RecordedEvent | StoredEvent)
Read: TypeAlias = Callable[[EventQuery], Awaitable[Sequence[StoredEvent]]]


def with_gaps(
    events: Sequence[Event], first: int, last: int, epoch: str, current: str
) -> Iterator[Event | Gap]:
    """Yield the events of a range of ids, and what is missing between them.

    Ids that are lost belong to the run of the event before them.

    Args:
        events: The events that are there, in order.
        first: First id of the range.
        last: Last id of the range.
        epoch: Run of the id before the range.
        current: Epoch of this run.
    """
    expected = first
    for event in events:
        if event.id > expected:
            yield Gap(expected, event.id - 1, epoch)
        yield event
        expected = event.id + 1
        epoch = event.epoch if isinstance(event, StoredEvent) else current
    if expected <= last:
        yield Gap(expected, last, epoch)


@dataclass(frozen=True, slots=True)
class _Missing:
    """A gap, and the time in which what is missing happened."""

    gap: Gap
    since: datetime | None = None
    """Of the event before; None: there is none."""
    until: datetime | None = None
    """Of the event after; None: there is none yet."""

    def may_concern(self, query: EventQuery) -> bool:
        """Tell whether something that a query wants may be missing."""
        is_before = self.until and query.from_at and self.until < query.from_at
        is_after = self.since and query.to_at and self.since > query.to_at
        return not is_before and not is_after


class KnownGaps:
    """The gaps of a log, for answers whose ids do not follow each other."""

    def __init__(self, log: EventLog, read: Read) -> None:
        """Prepare.

        Args:
            log: Of this run.
            read: Reads events of the journal.
        """
        self._log = log
        self._read = read
        self._oldest: StoredEvent | None = None
        self._tails: list[_Missing] | None = None

    async def oldest(self, *, fresh: bool) -> int:
        """Return the id of the oldest event that is kept.

        Args:
            fresh: Whether to look again, since the oldest events are dropped now and then.
        """
        if self._oldest is None or fresh:
            self._oldest = await self._next(0)
        in_memory = self._log.oldest
        return in_memory if self._oldest is None else min(self._oldest.id, in_memory)

    async def within(self, first: int, last: int, oldest: int, query: EventQuery) -> list[Gap]:
        """Return the gaps in a range of ids in which something that a query wants may be missing.

        Args:
            first: First id of the range.
            last: Last id of the range.
            oldest: Id of the oldest event that is kept.
            query: What is wanted.
        """
        dropped = Gap(1, oldest - 1, self._log.epoch_of(oldest))
        known = [_Missing(dropped, until=None if self._oldest is None else self._oldest.wall_at)]
        if first <= self._log.before:
            known += (tail for tail in await self._lost_tails() if tail.gap.first > oldest)
        gaps = [missing.gap for missing in known if missing.may_concern(query)]
        cut = ((gap, max(gap.first, first, 1), min(_last(gap), last)) for gap in gaps)
        return [Gap(begin, end, gap.epoch) for gap, begin, end in cut if begin <= end]

    async def _lost_tails(self) -> list[_Missing]:
        """Return what runs told and lost when they were killed; that never changes."""
        if self._tails is not None:
            return self._tails
        ends = sorted(last for last in self._log.earlier.values() if last)
        tails = [await self._tail_after(last) for last in ends]
        found = [tail for tail in tails if tail.gap.first <= _last(tail.gap)]
        # Soon after the start the first event of this run is not written down yet.
        if all(tail.until is not None for tail in found):
            self._tails = found
        return found

    async def _tail_after(self, last: int) -> _Missing:
        before, after = await self._next(last - 1), await self._next(last)
        end = self._log.before if after is None else min(after.id - 1, self._log.before)
        return _Missing(
            Gap(last + 1, end, self._log.epoch_of(last)),
            None if before is None else before.wall_at,
            None if after is None else after.wall_at,
        )

    async def _next(self, number: int) -> StoredEvent | None:
        """Return the first event after an id that the journal has."""
        found = await self._read(EventQuery(after=number, limit=1))
        return found[0] if found else None


def _last(gap: Gap) -> int:
    return gap.first - 1 if gap.last is None else gap.last
