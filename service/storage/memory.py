"""A journal in memory, for `--data :memory:` and for tests: nothing outlives its store."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Final

from domain.errors import StorageDegradedError
from domain.inputs import Restored
from domain.kept import Kept
from domain.timebase import Instant
from service.clock import Clock, since_epoch, to_datetime
from service.storage.event_rows import EventRow, event_row, stored_event
from service.storage.id_blocks import BOOT, CHANGE, EVENT, TASK, IdBlocks, IdKind
from service.storage.journal import (
    ANNOUNCED,
    Boot,
    EventQuery,
    Found,
    LogStatus,
    Plain,
    Step,
    StorageStatus,
    StoredEvent,
)
from service.storage.kind_pattern import KindPattern

PATH: Final = ":memory:"
DEFAULT_CAPACITY: Final = 10_000
"""How many events are kept; the oldest are dropped."""


@dataclass(slots=True)
class MemoryStore:
    """What a journal leaves to the next one, as a folder does."""

    kept: dict[tuple[type[Kept], str], Kept] = field(default_factory=dict)
    own: dict[str, Plain] = field(default_factory=dict)
    ids: dict[IdKind, int] = field(default_factory=dict)
    runs: dict[int, Boot] = field(default_factory=dict)
    events: deque[tuple[int, EventRow]] = field(
        default_factory=lambda: deque(maxlen=DEFAULT_CAPACITY)
    )
    """With the number of the run of each."""
    last_at: datetime | None = None


class MemoryJournal:
    """A `Journal` that keeps events and values; inputs and checkpoints are not kept.

    Args:
        boot: This run.
        clock: Of the service.
        store: What an earlier run left; None: nothing.
    """

    def __init__(self, boot: Boot, clock: Clock, store: MemoryStore | None = None) -> None:
        self._boot = boot
        self._clock = clock
        self._store = store = store or MemoryStore()
        self._number = store.ids.get(BOOT, 1)
        self._ids = IdBlocks(store.ids)
        self._found = self._find()
        store.ids |= {BOOT: self._number + 1}
        store.runs[self._number] = boot
        self._is_closed = False

    @property
    def found(self) -> Found:
        """Return what was there when the journal was opened."""
        return self._found

    @property
    def boot(self) -> Boot:
        """Return this run."""
        return self._boot

    @property
    def wants_checkpoint(self) -> bool:
        """Return False: nothing is replayed from here."""
        return False

    @property
    def is_durable(self) -> bool:
        """Return False."""
        return False

    @property
    def fault(self) -> str | None:
        """Return None: memory does not fail."""
        return None

    def note(self, step: Step) -> None:
        """Keep the events of a step, and what changed of what is kept."""
        if self._is_closed:
            return
        store, outputs = self._store, step.outputs
        store.last_at = self._clock.wall_time(step.at)
        for event in outputs.events:
            wall_ns = since_epoch(self._clock.wall_time(event.at))
            store.events.append((self._number, event_row(event, wall_ns)))
        for change in outputs.kept:
            if change.value is None:
                store.kept.pop((change.kind, change.name), None)
            else:
                store.kept[change.kind, change.name] = change.value
        self._ids.see(outputs)
        store.ids |= self._ids.exact()

    def keep(self, name: str, value: Plain) -> None:
        """Keep a value of the service itself."""
        if not self._is_closed:
            self._store.own[name] = value

    async def announce(self, what: Plain, patience_s: float) -> bool:
        """Return True: what is announced is there."""
        if self._is_closed:
            raise StorageDegradedError("storage is closed")
        self._store.own[ANNOUNCED] = [what]
        return True

    @property
    def last_step(self) -> int:
        """Return 0: steps are not kept."""
        return 0

    def checkpoint(self, step: int, at: Instant, state: bytes) -> None:
        """Do nothing: see `wants_checkpoint`."""

    async def commit(self, patience_s: float) -> bool:
        """Return True: what is noted is there."""
        if self._is_closed:
            raise StorageDegradedError("storage is closed")
        return True

    def status(self) -> StorageStatus:
        """Return how storage is doing; it always does well."""
        events = self._store.events
        size = sum(len(row.data) + len(row.words) for _, row in events)
        extent = (
            LogStatus(to_datetime(events[0][1].wall_ns), to_datetime(events[-1][1].wall_ns), size)
            if events
            else LogStatus(None, None, 0)
        )
        logs = {"inputs": LogStatus(None, None, 0), "events": extent}
        return StorageStatus(PATH, size, None, None, "", self._number, logs)

    async def events(self, query: EventQuery) -> Sequence[StoredEvent]:
        """Return events in the order of their ids, also those of earlier runs."""
        matches = _Matches(query)
        found = [entry for entry in self._store.events if matches.holds(entry[1])]
        is_forward = query.after is not None
        wanted = found[: query.limit] if is_forward else found[max(0, len(found) - query.limit) :]
        return [self._stored(number, row) for number, row in wanted]

    async def close(self) -> None:
        """Note nothing more."""
        self._is_closed = True

    def _find(self) -> Found:
        store, ids = self._store, self._ids.exact()
        epochs: dict[str, int] = {}
        for number, row in store.events:
            epochs[store.runs[number].epoch] = row.id
        first = Restored(
            tuple(store.kept.values()),
            self._number,
            ids[EVENT],
            ids[CHANGE],
            ids[TASK],
            run=self.boot.epoch,
        )
        return Found(first, not store.runs, store.last_at, epochs, dict(store.own))

    def _stored(self, number: int, row: EventRow) -> StoredEvent:
        return stored_event(row, number, self._store.runs[number].epoch)


class _Matches:
    """Tells which events a query asks for."""

    def __init__(self, query: EventQuery) -> None:
        self._query = query
        self._kind = None if query.kind is None else KindPattern(query.kind)

    def holds(self, row: EventRow) -> bool:
        query = self._query
        return (
            (query.after is None or row.id > query.after)
            and (query.before is None or row.id < query.before)
            and (query.from_at is None or row.wall_ns >= since_epoch(query.from_at))
            and (query.to_at is None or row.wall_ns <= since_epoch(query.to_at))
            and (self._kind is None or self._kind.matches(row.kind))
            and (query.part is None or query.part in row.parts)
            and (query.actor is None or row.actor == query.actor)
        )
