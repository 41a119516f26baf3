"""Which readings a window holds, and since when it holds all that it should."""

from collections import deque
from collections.abc import Sequence
from typing import TypeAlias

from domain.timebase import Duration, Instant

Popped: TypeAlias = tuple[list[Instant], list[float]]
"""When readings arrived that are held no longer, and their values."""

NEVER: Instant = 1 << 63
"""Later than any clock tells."""


class Contents:
    """The readings of a window, oldest first; at most so many that memory is bounded.

    Time goes forward: each call names an instant that is not before those of earlier calls.
    """

    def __init__(self, length: Duration | None, size: int, start: Instant) -> None:
        """Begin empty.

        Args:
            length: How long a reading stays; None: until `size` newer ones have come.
            size: How many readings are held at most.
            start: Since when somebody listens.
        """
        self.length = length
        self.start = start
        self.heard_at = start
        """Arrival of the newest reading, whether it is still held or not; the start before one."""
        self.next_leaves_at: Instant = NEVER
        """When the oldest reading leaves by time alone."""
        self._size = size
        self._times: deque[Instant] = deque()
        self._values: deque[float] = deque()
        self._lost_at: Instant | None = None
        """Arrival of the newest reading that had to go before its time."""

    def __len__(self) -> int:
        """Return how many readings are held."""
        return len(self._times)

    @property
    def oldest_at(self) -> Instant:
        """Return the arrival of the oldest reading; there is one."""
        return self._times[0]

    @property
    def is_full(self) -> bool:
        """Tell whether there is no room for another reading."""
        return len(self._times) >= self._size

    @property
    def surplus(self) -> int:
        """Return how many readings have to leave, since newer ones take their place."""
        return len(self._times) - self._size

    def is_exceeded_by(self, readings: int) -> bool:
        """Tell whether with so many more some may have to go before their time."""
        return self.length is not None and len(self._times) + readings > self._size

    def extend(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings; there is at least one."""
        if not self._times and self.length is not None:
            self.next_leaves_at = times[0] + self.length
        self._times.extend(times)
        self._values.extend(values)
        self.heard_at = times[-1]

    def pop_until(self, now: Instant) -> Popped:
        """Remove the readings whose time is over; return when they arrived and their values."""
        if self.length is None:
            return [], []
        last, times = now - self.length, self._times
        left = []
        while times and times[0] <= last:
            left.append(times.popleft())
        self.next_leaves_at = times[0] + self.length if times else NEVER
        values = self._values
        return left, [values.popleft() for _ in left]

    def pop_first(self, count: int) -> Popped:
        """Remove so many of the oldest readings, as `pop_until` does."""
        times, values = self._times, self._values
        popped = [times.popleft() for _ in range(count)], [values.popleft() for _ in range(count)]
        if self.length is not None:
            self.next_leaves_at = times[0] + self.length if times else NEVER
        return popped

    def make_room(self) -> Popped:
        """Remove the oldest reading for the next one, before its time."""
        if self.length is not None:
            self._lost_at = self._times[0]
        return self.pop_first(1)

    def is_complete(self, now: Instant) -> bool:
        """Tell whether no reading is missing that belongs into the window."""
        return self._lost_at is None or self.length is None or now >= self._lost_at + self.length

    def complete_at(self) -> Instant | None:
        """Return when nothing is missing any more; None: nothing ever was."""
        if self._lost_at is None or self.length is None:
            return None
        return self._lost_at + self.length

    def has_passed(self, now: Instant) -> bool:
        """Tell whether the window has passed once, since the start or in number of readings."""
        if self.length is None:
            return len(self._times) >= self._size
        return now >= self.start + self.length

    def passes_at(self) -> Instant | None:
        """Return when the window has passed once; None: readings decide that, not time."""
        return None if self.length is None else self.start + self.length

    def filled(self, now: Instant) -> float:
        """Return how much of the window has passed since the start, from 0 to 1."""
        if self.length is None:
            return len(self._times) / self._size
        return min(1.0, (now - self.start) / self.length)

    def leaves_at(self, place: int) -> Instant | None:
        """Return when the reading at a place leaves by time alone; None: it does not.

        Args:
            place: From 0, the oldest; there is such a reading.
        """
        return None if self.length is None else self._times[place] + self.length
