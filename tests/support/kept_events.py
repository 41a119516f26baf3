"""Events that are kept over runs of a service, without a disk: a journal as far as events go."""

import asyncio
from collections.abc import Callable, Sequence
from datetime import datetime

from domain.errors import StorageDegradedError
from domain.events.event import RecordedEvent
from domain.inputs import Restored
from service.clock import Clock
from service.event_log import EventLog
from service.history.event_history import EventHistory
from service.storage.event_rows import named_parts
from service.storage.journal import (
    Boot,
    EventQuery,
    Found,
    Plain,
    Step,
    StorageStatus,
    StoredEvent,
)
from service.storage.kind_pattern import KindPattern
from service.supervisor import Supervisor
from tests.support.frames import Happened
from tests.support.frames import event as made
from tests.support.manual_clock import ManualClock

_RESERVED = 20
"""Ids that a run takes in advance."""


class Disk:
    """What is written down, by all runs."""

    def __init__(self) -> None:
        self.events: list[StoredEvent] = []
        self.parts: dict[int, tuple[str, ...]] = {}
        self.boots = 0
        self.reads = 0
        self.failure: StorageDegradedError | None = None
        """Why nothing can be read."""
        self.on_read: Callable[[], None] = lambda: None
        """Is called while somebody waits for events."""

    @property
    def ids(self) -> list[int]:
        """Return the ids of all events."""
        return [event.id for event in self.events]

    def forget(self, before: int) -> None:
        """Drop the oldest events, as for their age."""
        self.events = [event for event in self.events if event.id >= before]


class Run:
    """A run of a service as far as its events go: some in memory, all on a disk if it keeps up."""

    def __init__(self, disk: Disk, clock: Clock | None = None, capacity: int = 10) -> None:
        clock = clock or ManualClock()
        self.journal = EventJournal(disk, clock)
        self.log = self.journal.log(capacity)
        self.history = EventHistory(self.log, self.journal, clock)

    def tell(self, count: int, happened: type[Happened] = Happened) -> list[int]:
        """Let events happen that nobody has written down yet; return their ids."""
        first = self.log.newest + 1
        for number in range(first, first + count):
            told = made(number, happened)
            self.log.append(told)
            self.journal.note_events(told)
        return list(range(first, first + count))


class EventJournal:
    """A run that writes to a disk; what was noted is written down by `commit`, or is lost."""

    def __init__(self, disk: Disk, clock: Clock) -> None:
        epochs = {f"run{number}": 0 for number in range(1, disk.boots + 1)}
        disk.boots += 1
        for event in disk.events:
            epochs[event.epoch] = event.id
        last = max(disk.ids, default=0)
        next_event = last + _RESERVED + 1 if last else 1
        self.disk = disk
        self.found = Found(
            Restored(boot=disk.boots, next_event=next_event),
            is_new=disk.boots == 1,
            epochs=epochs,
        )
        now = clock.now()
        self.boot = Boot(f"run{disk.boots}", "1", now, clock.wall_time(now), "", "")
        self.writes = True
        self._clock = clock
        self._noted: list[RecordedEvent] = []

    def log(self, capacity: int) -> EventLog:
        """Return the log in memory of this run."""
        before = self.found.restored.next_event - 1
        return EventLog(capacity, self.boot.epoch, before, self.found.epochs)

    def note(self, step: Step) -> None:
        """Take the events of a step; they are lost if the run is killed before `commit`."""
        self._noted += step.outputs.events

    def note_events(self, *events: RecordedEvent) -> None:
        """Take events without their step."""
        self._noted += events

    def write_down(self) -> None:
        """Write down what was noted."""
        for event in self._noted:
            self.disk.parts[event.id] = named_parts(event.event)
            self.disk.events.append(self._stored(event))
        self._noted.clear()

    def lose(self) -> None:
        """Forget what was noted, as a full queue does."""
        self._noted.clear()

    async def announce(self, what: Plain, patience_s: float) -> bool:
        """Return whether it can be written down."""
        return await self.commit(patience_s)

    async def commit(self, patience_s: float) -> bool:
        """Write down what was noted."""
        del patience_s
        await asyncio.sleep(0)
        if not self.writes:
            raise StorageDegradedError("the disk is full")
        self.write_down()
        return True

    async def events(self, query: EventQuery) -> Sequence[StoredEvent]:
        """Return the events that a query wants."""
        self.disk.reads += 1
        await asyncio.sleep(0)
        self.disk.on_read()
        if self.disk.failure is not None:
            raise self.disk.failure
        found = [event for event in self.disk.events if self._is_wanted(event, query)]
        return found[-query.limit :] if query.after is None else found[: query.limit]

    def keep(self, name: str, value: Plain) -> None:
        """Keep nothing."""

    is_durable = False
    fault = None

    @property
    def wants_checkpoint(self) -> bool:
        """Return False: steps are not kept."""
        return False

    @property
    def last_step(self) -> int:
        """Return 0: steps are not kept."""
        return 0

    def checkpoint(self, step: int, at: int, state: bytes) -> None:
        """Keep nothing."""

    def status(self) -> StorageStatus:
        """Return that all is well."""
        return StorageStatus("memory", 0, None, None, "", self.disk.boots, {})

    async def close(self) -> None:
        """Write down what was noted."""
        self.write_down()

    def _is_wanted(self, event: StoredEvent, query: EventQuery) -> bool:
        checks = (
            query.after is None or event.id > query.after,
            query.before is None or event.id < query.before,
            query.from_at is None or event.wall_at >= query.from_at,
            query.to_at is None or event.wall_at <= query.to_at,
            query.kind is None or KindPattern(query.kind).matches(event.kind),
            query.part is None or query.part in self.disk.parts[event.id],
            query.actor is None or event.actor == query.actor,
        )
        return all(checks)

    def _stored(self, event: RecordedEvent) -> StoredEvent:
        return StoredEvent(
            id=event.id,
            boot=self.found.restored.boot,
            epoch=self.boot.epoch,
            at=event.at,
            wall_at=self._wall(event),
            kind=event.kind,
            cause=event.cause,
            actor=event.actor.label,
            data=dict(event.data),  # type: ignore[arg-type]
            words=event.event.words,
            notable=event.event.notable,
        )

    def _wall(self, event: RecordedEvent) -> datetime:
        return self._clock.wall_time(event.at)


def history_of(supervisor: Supervisor) -> EventHistory:
    """Return all events of a robot."""
    return EventHistory(supervisor.events, supervisor.journal, supervisor.clock)
