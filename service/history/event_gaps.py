"""Ids without an event: too old to be kept, or published and lost when the service was killed."""

from collections.abc import Awaitable, Callable, Iterator, Sequence
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
        self._oldest: int | None = None
        self._tails: list[Gap] | None = None

    async def oldest(self, *, fresh: bool) -> int:
        """Return the id of the oldest event that is kept.

        Args:
            fresh: Whether to look again, since the oldest events are dropped now and then.
        """
        if self._oldest is None or fresh:
            found = await self._read(EventQuery(after=0, limit=1))
            self._oldest = found[0].id if found else self._log.oldest
        return min(self._oldest, self._log.oldest)

    async def within(self, first: int, last: int, oldest: int) -> list[Gap]:
        """Return the gaps in a range of ids.

        Args:
            first: First id of the range.
            last: Last id of the range.
            oldest: Id of the oldest event that is kept.
        """
        known = [Gap(1, oldest - 1, self._log.epoch_of(oldest))]
        if first <= self._log.before:
            known += (gap for gap in await self._lost_tails() if gap.first > oldest)
        cut = ((gap, max(gap.first, first, 1), min(_last(gap), last)) for gap in known)
        return [Gap(begin, end, gap.epoch) for gap, begin, end in cut if begin <= end]

    async def _lost_tails(self) -> list[Gap]:
        """Return what runs told and lost when they were killed; that never changes."""
        if self._tails is None:
            ends = sorted((last, epoch) for epoch, last in self._log.earlier.items() if last)
            tails = [Gap(last + 1, await self._next(last) - 1, epoch) for last, epoch in ends]
            self._tails = [gap for gap in tails if gap.first <= _last(gap)]
        return self._tails

    async def _next(self, number: int) -> int:
        """Return the id of the first event after another one."""
        after_all = self._log.before + 1
        found = await self._read(EventQuery(after=number, before=after_all, limit=1))
        return found[0].id if found else after_all


def _last(gap: Gap) -> int:
    return gap.first - 1 if gap.last is None else gap.last
