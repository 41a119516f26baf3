"""All events that are kept: the newest in memory, earlier ones and those of earlier runs on disk.

Memory has an event at once, the journal some time later. A query takes from memory what is there
when it begins, and asks the journal for what is older than that: so nothing is told twice, and
nothing falls between.
"""

import asyncio
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import islice
from typing import TypeAlias

from domain.errors import StorageDegradedError, UnknownEventError
from domain.events.event import RecordedEvent
from service.clock import Clock
from service.event_log import EventLog, Gap
from service.history.event_filter import EventFilter
from service.history.event_gaps import KnownGaps, with_gaps
from service.storage.journal import EventQuery, Journal, StoredEvent

ToldEvent: TypeAlias = RecordedEvent | StoredEvent

READ_PATIENCE_S = 5.0
"""A disk that takes longer for one read counts as broken."""
_SLOW = f"the disk takes more than {READ_PATIENCE_S:g} s"
_GLANCE_S = 0.2
"""The id of the oldest event is not worth a longer wait."""
MAX_CAUSES = 100
"""Events of one chain of causes; whoever wants more asks on with the last `cause`."""
_FILTERED_AT_ONCE = 1_000
"""Events looked at before other tasks of the event loop run: 2 ms."""


@dataclass(frozen=True, slots=True)
class FoundEvents:
    """The answer to a query."""

    items: Sequence[ToldEvent]
    """In order."""
    gaps: Sequence[Gap]
    """What was asked for and is not there."""
    oldest: int
    """Id of the oldest event that is kept."""
    newest: int
    """Id of the newest one."""


class EventHistory:
    """The event log of one robot over all runs that are kept."""

    def __init__(self, log: EventLog, journal: Journal | None, clock: Clock) -> None:
        """Prepare; nothing is read yet.

        Args:
            log: The newest events of this run.
            journal: Has earlier ones; None: there are none.
            clock: Of the events.
        """
        self.log = log
        self._journal = journal
        self._clock = clock
        self._gaps = KnownGaps(log, self.stored)
        self._asked = asyncio.Semaphore()
        """One query reads the journal at a time."""
        self._written_to = 0
        """Highest id up to which the journal is known to have everything."""

    @property
    def reaches_back(self) -> bool:
        """Tell whether there may be more than memory has."""
        return self._journal is not None

    async def find(self, query: EventQuery, epoch: str | None = None) -> FoundEvents:
        """Return the events that a query wants, and what is missing among them.

        Args:
            query: What is wanted.
            epoch: Run that the id `after` belongs to; None: this one.

        Raises:
            StorageDegradedError: The journal is needed, and cannot be read.
        """
        lost = []
        if query.after is not None and self.log.is_foreign(query.after, epoch):
            lost = [Gap(query.after + 1, None, epoch or self.log.epoch)]
            query, epoch = replace(query, after=self.log.before), None
        newest = self.log.newest
        items, has_read = await self._items(query)
        oldest = await self._oldest(fresh=has_read)
        first, last = _range_of(query, items, oldest, newest)
        if _wants_all(query):
            start = self.log.epoch_of(first - 1)
            if query.after is not None and epoch is not None:
                start = epoch
            told = with_gaps(items, first, last, start, self.log.epoch)
            gaps = [item for item in told if isinstance(item, Gap)]
        else:
            gaps = await self._gaps.within(first, last, oldest, query)
        return FoundEvents(items, [*lost, *gaps], oldest, newest)

    async def causes(self, number: int) -> Sequence[ToldEvent]:
        """Return an event, its cause, the cause of that and so on; at most `MAX_CAUSES`.

        The `cause` of the last one is None, unless there are more or it is no longer kept.

        Raises:
            UnknownEventError: There is no such event.
            StorageDegradedError: The journal is needed, and cannot be read.
        """
        chain: list[ToldEvent] = []
        wanted: int | None = number
        async with self._asked:
            while wanted is not None and len(chain) < MAX_CAUSES:
                event = await self._event(wanted)
                if event is None:
                    break
                chain.append(event)
                wanted = event.cause
        if not chain:
            raise UnknownEventError("event", str(number), ())
        return chain

    async def stored(self, query: EventQuery) -> Sequence[StoredEvent]:
        """Return events from the journal.

        Raises:
            StorageDegradedError: It cannot be read, or not soon.
        """
        if self._journal is None:
            return ()
        try:
            async with asyncio.timeout(READ_PATIENCE_S):
                return await self._journal.events(query)
        except StorageDegradedError as error:
            raise _unreadable(error.reason) from error
        except TimeoutError as error:
            raise _unreadable(_SLOW) from error

    async def stored_before(self, query: EventQuery, end: int) -> Sequence[StoredEvent]:
        """Return events with ids below `end` from the journal, once it has them.

        Raises:
            StorageDegradedError: It cannot be read, or not soon.
        """
        await self._wait_until_written(end - 1)
        before = end if query.before is None else min(query.before, end)
        return await self.stored(replace(query, before=before))

    async def _items(self, query: EventQuery) -> tuple[Sequence[ToldEvent], bool]:
        """Return the events, and whether the journal was read for them."""
        edge = self.log.oldest
        wanted = EventFilter(query, self._clock)
        if query.after is None:
            latest = reversed(self.log.between(0, query.before))
            recent = (await _accepted(latest, wanted, query.limit))[::-1]
            missing = query.limit - len(recent)
            if not missing or edge == 1 or not self.reaches_back:
                return recent, False
            return [*await self._earlier(replace(query, limit=missing), edge), *recent], True
        following = self.log.between(query.after, query.before)
        earlier: Sequence[StoredEvent] = ()
        needs_journal = self.reaches_back and query.after + 1 < edge
        if needs_journal:
            earlier = await self._earlier(query, edge)
        recent = await _accepted(following, wanted, query.limit - len(earlier))
        return [*earlier, *recent], needs_journal

    async def _earlier(self, query: EventQuery, end: int) -> Sequence[StoredEvent]:
        async with self._asked:
            return await self.stored_before(query, end)

    async def _event(self, number: int) -> ToldEvent | None:
        kept = self.log.between(number - 1, number + 1)
        if kept or number >= self.log.oldest:
            return kept[0] if kept else None
        query = EventQuery(after=number - 1, limit=1)
        found = await self.stored_before(query, number + 1)
        return found[0] if found else None

    async def _oldest(self, *, fresh: bool) -> int:
        """Return the id of the oldest event; what was read before may do, if not `fresh`."""
        if not self.reaches_back:
            return self.log.oldest
        with suppress(StorageDegradedError, TimeoutError):
            async with asyncio.timeout(_GLANCE_S):
                return await self._gaps.oldest(fresh=fresh)
        return self.log.oldest

    async def _wait_until_written(self, number: int) -> None:
        """Wait until the journal has an event that memory has no longer.

        Raises:
            StorageDegradedError: It takes long.
        """
        if self._journal is None or number <= max(self.log.before, self._written_to):
            return
        newest = self.log.newest
        try:
            is_written = await self._journal.commit(READ_PATIENCE_S)
        except StorageDegradedError:
            # What a broken disk could not take is not there, and is told as a gap.
            return
        if not is_written:
            raise _unreadable(_SLOW)
        self._written_to = newest


def _unreadable(reason: str) -> StorageDegradedError:
    return StorageDegradedError.while_reading("earlier events", reason)


async def _accepted(
    events: Iterable[RecordedEvent], wanted: EventFilter, limit: int
) -> list[RecordedEvent]:
    """Return the first events that are wanted; other tasks of the event loop run in between."""
    found: list[RecordedEvent] = []
    waiting = iter(events)
    while len(found) < limit and (portion := list(islice(waiting, _FILTERED_AT_ONCE))):
        found += filter(wanted.accepts, portion)
        if len(portion) == _FILTERED_AT_ONCE:
            await asyncio.sleep(0)
    return found[:limit]


def _wants_all(query: EventQuery) -> bool:
    """Tell whether a query wants every event between two ids."""
    chosen = (query.from_at, query.to_at, query.kind, query.part, query.actor)
    return all(choice is None for choice in chosen)


def _range_of(
    query: EventQuery, items: Sequence[ToldEvent], oldest: int, newest: int
) -> tuple[int, int]:
    """Return the first and the last id that an answer covers."""
    last = newest if query.before is None else min(query.before - 1, newest)
    is_full = len(items) == query.limit
    if query.after is not None:
        return query.after + 1, items[-1].id if is_full else last
    if is_full:
        return items[0].id, last
    # The newest are asked for, however many there are; only who names an id goes back from there.
    return oldest if query.before is None else 1, last
