"""What is noted and not yet on disk: bounded in bytes, in batches of which none is written twice.

When it is full, steps are lost and counted until a hole in the log is written that says so; kept
values are never lost, since a later one replaces an earlier one.
"""

from collections.abc import Sequence

from domain.timebase import Instant
from service.storage.event_rows import EventRow
from service.storage.sqlite.batch import Batch, Checkpoint, Flight, Hole, Key

_BYTES_PER_EVENT = 200
"""Of an event, besides its texts."""


class Backlog:
    """Gathers batches, and keeps them until they are written.

    Args:
        limit_bytes: How much may wait for the disk.
        next_batch: Number of the first batch.
        next_step: Number of the first step.
    """

    def __init__(self, limit_bytes: int, next_batch: int, next_step: int) -> None:
        self._limit = limit_bytes
        self._next_batch = next_batch
        self._next_step = next_step
        self._open = Batch()
        self._bytes = 0
        self._open_bytes = 0
        self._flight: tuple[Batch, ...] = ()
        self._hole: Hole | None = None
        self.lost_steps = 0
        self.lost_events = 0

    @property
    def is_empty(self) -> bool:
        """Tell whether nothing was noted since the last flight."""
        return self._open.is_empty and self._hole is None

    @property
    def size(self) -> int:
        """Size of what waits, in bytes."""
        return self._bytes + self._open_bytes

    @property
    def last_step(self) -> int:
        """Number of the last step."""
        return self._next_step - 1

    def add_step(
        self, text: bytes, at: Instant, wall_ns: int, rows: Sequence[EventRow] = ()
    ) -> None:
        """Add a step, or lose it if there is no room."""
        number = self._next_step
        self._next_step += 1
        added = len(text)
        for row in rows:
            added += _BYTES_PER_EVENT + len(row.data) + len(row.words)
        if self._hole is not None or self.size + added > self._limit:
            self.lose(at, len(rows), "the queue is full")
            return
        batch = self._open
        if not batch.steps:
            batch.first_step, batch.first_at = number, at
        batch.steps.append(text)
        batch.last_at, batch.wall_ns = at, wall_ns
        batch.events.extend(rows)
        self._open_bytes += added

    def lose(self, at: Instant, events: int, reason: str) -> None:
        """Count a step that is not written down."""
        self.lost_steps += 1
        self.lost_events += events
        hole = self._hole
        if hole is None:
            self._hole = Hole(1, events, at, at, reason)
        else:
            self._hole = Hole(hole.steps + 1, hole.events + events, hole.from_at, at, hole.reason)

    def change(self, key: Key, value: bytes | None) -> None:
        """Keep a value, or keep it no longer (None)."""
        self._open.changes[key] = value

    def add_checkpoint(self, step: int, at: Instant, state: bytes) -> bool:
        """Add the state after a step; return whether there was room."""
        if self._hole is not None or self.size + len(state) > self._limit:
            return False
        self._open.checkpoints.append(Checkpoint(step, at, state))
        self._open_bytes += len(state)
        return True

    def end_run(self) -> None:
        """Note that the run ends after what was added."""
        self._open.ends_run = True

    def take(self, must_last: bool) -> Flight:
        """Return all that waits, for one transaction; it stays here until `written`."""
        batch = self._open
        if self._flight and not batch.steps and not batch.checkpoints and not batch.ends_run:
            # While storage fails nothing but values may come: they need no batch of their own, as
            # all values are written anew when it works again.
            self._flight[-1].changes.update(batch.changes)
        else:
            batch.number = self._next_batch
            batch.first_step = batch.first_step or self._next_step
            self._next_batch += 1
            self._flight = (*self._flight, batch)
        self._bytes += self._open_bytes
        self._open, self._open_bytes = Batch(), 0
        return Flight(self._flight, self._hole, must_last)

    def written(self, flight: Flight) -> None:
        """Forget what was written."""
        self._flight, self._bytes = (), 0
        # Steps that were lost during the flight follow the hole: it goes on.
        if flight.hole is not None and self._hole is not None:
            lost = self._hole.steps - flight.hole.steps
            events = self._hole.events - flight.hole.events
            self._hole = (
                Hole(lost, events, flight.hole.to_at, self._hole.to_at, self._hole.reason)
                if lost
                else None
            )

    def discard(self, flight: Flight, reason: str) -> None:
        """Lose the steps of a flight that nothing is wrong with but itself; its values stay."""
        changes = {key: v for batch in flight.batches for key, v in batch.changes.items()}
        self._open.changes = changes | self._open.changes
        self.written(flight)
        for batch in flight.batches:
            for _ in batch.steps:
                self.lose(batch.last_at, 0, reason)
            self.lost_events += len(batch.events)
