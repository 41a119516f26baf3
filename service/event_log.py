"""The newest events in order, for readers that keep nothing but a cursor."""

import secrets
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice

from domain.events.event import RecordedEvent
from service.watching import Watched

DEFAULT_CAPACITY = 10_000


@dataclass(frozen=True, slots=True)
class Gap:
    """Events that a reader asked for and that are no longer in the log."""

    first: int
    """Id of the first one that is missing."""
    last: int | None
    """Id of the last one; None: unknown, since the service was restarted."""
    epoch: str
    """Epoch that the ids belong to."""


class EventLog(Watched):
    """Keeps the newest events of this run in memory; the oldest events are dropped.

    A cursor is an id together with its epoch, the name of its run. Ids go on over restarts if runs
    are kept, and start at 1 again if they are not.
    """

    def __init__(
        self,
        capacity: int = DEFAULT_CAPACITY,
        epoch: str | None = None,
        before: int = 0,
        earlier: Mapping[str, int] | None = None,
    ) -> None:
        """Make an empty log.

        Args:
            capacity: How many events are kept.
            epoch: Name of this run of the service; None: a new, unique one.
            before: Last id before this log; not 0 if ids go on after those of earlier runs, and for
                the copy of a live robot.
            earlier: Epochs of runs whose ids this log continues, each with its last known id.
        """
        super().__init__()
        self.epoch = epoch or secrets.token_hex(8)
        self.before = before
        """Last id before this log."""
        self.earlier = dict(earlier or {})
        """Epochs of earlier runs, each with its last known id; 0: it has none."""
        self._capacity = capacity
        self._ring: list[RecordedEvent] = []
        self._newest = before

    @property
    def newest(self) -> int:
        """Id of the newest event; while the log is empty, of the last event before it."""
        return self._newest

    @property
    def oldest(self) -> int:
        """Id of the oldest event that is kept; while the log is empty, of its first event."""
        return max(self.before + 1, self._newest - self._capacity + 1)

    def append(self, *events: RecordedEvent) -> None:
        """Add events, drop the oldest ones if the log is full, and wake the readers.

        Raises:
            ValueError: An id does not follow the id of the newest event.
        """
        ring, capacity = self._ring, self._capacity
        for event in events:
            if event.id != self._newest + 1:
                raise ValueError(f"event {event.id} does not follow event {self._newest}")
            if len(ring) < capacity:
                ring.append(event)
            else:
                ring[(event.id - self.before - 1) % capacity] = event
            self._newest = event.id
        if events:
            self._wake_watchers()

    def oldest_first(self, after: int = 0) -> Iterator[RecordedEvent]:
        """Yield the kept events with ids above `after`."""
        return self._events(range(max(after + 1, self.oldest), self._newest + 1))

    def newest_first(self) -> Iterator[RecordedEvent]:
        """Yield the kept events, newest first."""
        return self._events(range(self._newest, self.oldest - 1, -1))

    def between(self, after: int, before: int | None = None) -> list[RecordedEvent]:
        """Return the kept events with ids above `after` and below `before`, oldest first."""
        end = self._newest + 1 if before is None else min(before, self._newest + 1)
        return list(self._events(range(max(after + 1, self.oldest), end)))

    def is_foreign(self, after: int, epoch: str | None) -> bool:
        """Tell whether this log does not go on after a cursor, as after any that is ahead of it."""
        if epoch is None or epoch == self.epoch:
            return after > self._newest
        return epoch not in self.earlier or after > self.before

    def epoch_of(self, number: int) -> str:
        """Return the epoch of an event; of an id that no run is known to have, of the next run."""
        later = [(last, epoch) for epoch, last in self.earlier.items() if last >= max(number, 1)]
        return min(later)[1] if later else self.epoch

    def _slot(self, number: int) -> int:
        return (number - self.before - 1) % self._capacity

    def _events(self, numbers: range) -> Iterator[RecordedEvent]:
        return (self._ring[self._slot(number)] for number in numbers)


class EventReader:
    """The position of one reader in a log: it gets every event, or a `Gap` for those it missed."""

    def __init__(self, log: EventLog, after: int | None = None, epoch: str | None = None) -> None:
        """Start after a cursor.

        Args:
            log: The log to read.
            after: Id of the last known event, at least 0; None: only new events.
            epoch: Epoch of that id; None: the epoch of the log. A reader from another epoch gets
                all events of this run, after a gap for those that it may have missed in its own.
        """
        self._log = log
        self._lost: Gap | None = None
        self._at = log.newest if after is None else after
        if after is not None and log.is_foreign(after, epoch):
            self._lost = Gap(after + 1, None, epoch or log.epoch)
            self._at = log.before

    @property
    def position(self) -> tuple[int, Gap | None]:
        """Return a value that is equal for readers at the same position in the same log."""
        return self._at, self._lost

    @property
    def at(self) -> int:
        """Return the id of the last event that was taken, or told as missing."""
        return self._at

    @property
    def is_cut_off(self) -> bool:
        """Tell whether the log no longer has the next event."""
        return self._at + 1 < self._log.oldest

    def move_to(self, number: int) -> None:
        """Go on after an event that was read elsewhere."""
        self._at = number

    @property
    def has_lost(self) -> bool:
        """Tell whether the gap after the cursor of another run was not taken yet."""
        return self._lost is not None

    def take_lost(self) -> Gap | None:
        """Return the gap after the cursor of another run, once."""
        lost, self._lost = self._lost, None
        return lost

    @property
    def is_behind(self) -> bool:
        """Tell whether there are events, or a gap, to take."""
        return self._at != self._log.newest or self._lost is not None

    def take(self, limit: int) -> list[RecordedEvent | Gap]:
        """Return the next events, at most `limit`, after the gap before them if there is one."""
        lost = self.take_lost()
        found: list[RecordedEvent | Gap] = [] if lost is None else [lost]
        if self.is_cut_off:
            found.append(Gap(self._at + 1, self._log.oldest - 1, self._log.epoch))
            self._at = self._log.oldest - 1
        events = list(islice(self._log.oldest_first(self._at), limit))
        self._at += len(events)
        return [*found, *events]
