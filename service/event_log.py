"""What was decided, in order: the newest events, for readers that hold nothing but a cursor."""

import secrets
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

from domain.events.event import RecordedEvent
from service.watching import Watched

DEFAULT_CAPACITY = 10_000


@dataclass(frozen=True, slots=True)
class Gap:
    """Events that a reader asked for and that are not there any more."""

    first: int
    """Id of the first one that is missing."""
    last: int | None
    """Id of the last one; None: nobody knows how many followed before the service was restarted."""
    epoch: str
    """Epoch that the ids belong to."""


class EventLog(Watched):
    """The newest events in memory; ids count from 1, and the oldest are forgotten.

    A cursor is an id together with the epoch in which it was given out, since ids begin again when
    the service is restarted.
    """

    def __init__(
        self, capacity: int = DEFAULT_CAPACITY, epoch: str | None = None, before: int = 0
    ) -> None:
        """Make an empty log.

        Args:
            capacity: How many events are kept.
            epoch: Name of this run of the service; None: one that no other run has.
            before: Id of the last event that was before this log, as for the copy of a robot.
        """
        super().__init__()
        self.epoch = epoch or secrets.token_hex(8)
        self._capacity = capacity
        self._ring: list[RecordedEvent] = []
        self._before = before
        self._newest = before

    @property
    def newest(self) -> int:
        """Id of the newest event; before the first, that of the last one before this log."""
        return self._newest

    @property
    def oldest(self) -> int:
        """Id of the oldest event that is kept, or that will be the first."""
        return max(self._before + 1, self._newest - self._capacity + 1)

    def append(self, event: RecordedEvent) -> None:
        """Keep an event, forget the oldest when there are too many, and wake the readers.

        Raises:
            ValueError: Its id does not follow that of the event before.
        """
        if event.id != self._newest + 1:
            raise ValueError(f"event {event.id} does not follow event {self._newest}")
        if len(self._ring) < self._capacity:
            self._ring.append(event)
        else:
            self._ring[self._slot(event.id)] = event
        self._newest = event.id
        self._wake_watchers()

    def oldest_first(self, after: int = 0) -> Iterator[RecordedEvent]:
        """Yield the events with ids above `after`, as far as they are kept."""
        return self._events(range(max(after + 1, self.oldest), self._newest + 1))

    def newest_first(self) -> Iterator[RecordedEvent]:
        """Yield the events that are kept, the other way round."""
        return self._events(range(self._newest, self.oldest - 1, -1))

    def is_foreign(self, after: int, epoch: str | None) -> bool:
        """Tell whether a cursor is of another epoch; one that is ahead of the log must be."""
        return after > self._newest or (epoch is not None and epoch != self.epoch)

    def _slot(self, number: int) -> int:
        return (number - self._before - 1) % self._capacity

    def _events(self, numbers: range) -> Iterator[RecordedEvent]:
        return (self._ring[self._slot(number)] for number in numbers)


class EventReader:
    """The position of one reader in a log: it gets every event, or is told which ones it missed."""

    def __init__(self, log: EventLog, after: int | None = None, epoch: str | None = None) -> None:
        """Begin behind a cursor.

        Args:
            log: Where to read.
            after: Id of the last event known, at least 0; None: only what comes from now on.
            epoch: Epoch of that id; None: the one of the log. To a reader from another epoch all
                events are new, and it is told of a gap, since more may have happened in its own.
        """
        self._log = log
        self._lost: Gap | None = None
        self._at = log.newest if after is None else after
        if after is not None and log.is_foreign(after, epoch):
            self._lost = Gap(after + 1, None, epoch or log.epoch)
            self._at = 0

    @property
    def position(self) -> tuple[int, Gap | None]:
        """Return what tells this place from others in the same log."""
        return self._at, self._lost

    @property
    def is_behind(self) -> bool:
        """Tell whether there is something to take."""
        return self._at != self._log.newest or self._lost is not None

    def take(self, limit: int) -> list[RecordedEvent | Gap]:
        """Return what follows: at most `limit` events, and the gap before them."""
        found: list[RecordedEvent | Gap] = []
        if self._lost is not None:
            found.append(self._lost)
            self._lost = None
        if self._at + 1 < self._log.oldest:
            found.append(Gap(self._at + 1, self._log.oldest - 1, self._log.epoch))
            self._at = self._log.oldest - 1
        events = list(islice(self._log.oldest_first(self._at), limit))
        self._at += len(events)
        return [*found, *events]
