"""What is noted and not yet on disk: bounded in bytes, in batches of which none is written twice.

When it is full, steps are lost; a hole in the log says so, and where. Kept values are never lost,
since a later one replaces an earlier one.
"""

from collections.abc import Sequence
from dataclasses import replace

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
        self._size = 0
        self._open = Batch()
        self._sealed: list[Batch] = []
        """Batches before the open one that were in no flight yet."""
        self._flight: tuple[Batch, ...] = ()
        self.lost_steps = 0
        self.lost_events = 0

    @property
    def is_empty(self) -> bool:
        """Tell whether nothing was noted since the last flight."""
        return self._open.is_empty and not self._sealed

    @property
    def size(self) -> int:
        """Size of what waits, in bytes."""
        return self._size

    @property
    def last_step(self) -> int:
        """Number of the last step."""
        return self._next_step - 1

    def add_step(
        self, text: bytes, at: Instant, wall_ns: int, rows: Sequence[EventRow] = ()
    ) -> None:
        """Add a step, or lose it if there is no room."""
        added = len(text)
        for row in rows:
            added += _BYTES_PER_EVENT + len(row.data) + len(row.words)
        if self._size + added > self._limit:
            self.lose(at, len(rows), "the queue is full")
            return
        batch = self._open_after_hole()
        if not batch.steps:
            batch.first_step, batch.first_at = self._next_step, at
        self._next_step += 1
        batch.steps.append(text)
        batch.last_at, batch.wall_ns = at, wall_ns
        batch.events.extend(rows)
        self._grow(added)

    def lose(self, at: Instant, events: int, reason: str) -> None:
        """Count a step that is not written down.

        Args:
            at: When it was.
            events: How many events it had.
            reason: Why it is lost; of a hole the first one is told.
        """
        after = self._next_step - 1
        self._next_step += 1
        self.lost_steps += 1
        self.lost_events += events
        self._open.hole = joined(self._open.hole, Hole(after, 1, events, at, at, reason))

    def change(self, key: Key, value: bytes | None) -> None:
        """Keep a value, or keep it no longer (None)."""
        self._open.changes[key] = value

    def add_checkpoint(self, step: int, at: Instant, state: bytes) -> bool:
        """Add the state after a step; return whether there was room."""
        if self._size + len(state) > self._limit:
            return False
        batch = self._open_after_hole()
        batch.checkpoints.append(Checkpoint(step, at, state))
        self._grow(len(state))
        return True

    def end_run(self) -> None:
        """Note that the run ends after what was added."""
        self._open_after_hole().ends_run = True

    def take(self, must_last: bool) -> Flight:
        """Return all that waits, for one transaction; it stays here until `written`."""
        waiting = [*self._flight, *self._sealed]
        batch = self._open
        if waiting and not (batch.steps or batch.checkpoints or batch.ends_run):
            # While storage fails nothing but values and losses may come, for hours. They need no
            # batch of their own.
            waiting[-1].changes.update(batch.changes)
            waiting[-1].hole = joined(waiting[-1].hole, batch.hole)
        else:
            batch.first_step = batch.first_step or self._next_step
            waiting.append(batch)
        for batch in waiting:
            if not batch.number:
                batch.number = self._next_batch
                self._next_batch += 1
        self._open, self._sealed = Batch(), []
        self._flight = tuple(waiting)
        return Flight(self._flight, must_last)

    def written(self) -> None:
        """Forget what was in the last flight."""
        self._size -= sum(batch.size for batch in self._flight)
        self._flight = ()

    def discard(self, reason: str) -> None:
        """Lose the steps of the last flight, which are what is wrong; the values in it stay."""
        if not self._flight:
            return
        gap = Batch(first_step=self._flight[0].first_step)
        for batch in self._flight:
            steps, events = len(batch.steps), len(batch.events)
            self.lost_steps += steps
            self.lost_events += events
            lost = Hole(batch.first_step - 1, steps, events, batch.first_at, batch.last_at, reason)
            gap.hole = joined(joined(gap.hole, lost), batch.hole)
            gap.changes.update(batch.changes)
        self.written()
        self._sealed.insert(0, gap)

    def _open_after_hole(self) -> Batch:
        """Return the batch that the next step belongs to: a hole is the end of one."""
        if self._open.hole is not None:
            self._open.first_step = self._open.first_step or self._open.hole.after_step + 1
            self._sealed.append(self._open)
            self._open = Batch()
        return self._open

    def _grow(self, size: int) -> None:
        self._open.size += size
        self._size += size


def joined(hole: Hole | None, more: Hole | None) -> Hole | None:
    """Return one hole for two that follow each other."""
    if hole is None or more is None:
        return hole or more
    steps, events = hole.steps + more.steps, hole.events + more.events
    return replace(hole, steps=steps, events=events, to_at=more.to_at)
