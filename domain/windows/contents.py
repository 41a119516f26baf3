"""Which readings a window holds, and since when it holds all that it should."""

from collections import deque

from domain.timebase import Duration, Instant

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

    def append(self, at: Instant, value: float) -> None:
        """Take in a reading; there is room for it."""
        if not self._times and self.length is not None:
            self.next_leaves_at = at + self.length
        self._times.append(at)
        self._values.append(value)
        self.heard_at = at

    def pop(self) -> tuple[Instant, float]:
        """Remove the oldest reading, whose time is over; return when it arrived and its value."""
        at = self._times.popleft()
        if self.length is not None:
            self.next_leaves_at = self._times[0] + self.length if self._times else NEVER
        return at, self._values.popleft()

    def make_room(self) -> tuple[Instant, float]:
        """Remove the oldest reading for the next one, as `pop` does."""
        if self.length is not None:
            self._lost_at = self._times[0]
        return self.pop()

    def is_complete(self, now: Instant) -> bool:
        """Tell whether no reading is missing that belongs into the window."""
        lost_until = self.complete_at()
        return lost_until is None or now >= lost_until

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
