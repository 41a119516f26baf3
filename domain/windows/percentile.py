"""A percentile of the readings of a window."""

import heapq
import math
from collections.abc import Sequence

from domain.timebase import Instant
from domain.windows.contents import Contents
from domain.windows.measure import Measure


class _Half:
    """The numbers on one side of a percentile, with that next to it on top.

    Numbers that have left stay below the top until there are more of them than others: a heap
    cannot be searched.
    """

    def __init__(self, sign: int) -> None:
        self.n = 0
        """Numbers that have not left."""
        self._sign = sign
        self._heap: list[tuple[float, int]] = []

    def __len__(self) -> int:
        """Return how many numbers are kept, including those that have left."""
        return len(self._heap)

    def push(self, number: float, place: int) -> None:
        """Add a number."""
        heapq.heappush(self._heap, (self._sign * number, self._sign * place))
        self.n += 1

    def top(self, left: int) -> tuple[float, int]:
        """Return the number next to the percentile; there is one.

        Args:
            left: Numbers with smaller places have left.
        """
        while self._sign * self._heap[0][1] < left:
            heapq.heappop(self._heap)
        number, place = self._heap[0]
        return self._sign * number, self._sign * place

    def pop(self, left: int) -> tuple[float, int]:
        """Remove the number next to the percentile and return it; there is one."""
        top = self.top(left)
        heapq.heappop(self._heap)
        self.n -= 1
        return top

    def forget(self, left: int) -> None:
        """Count one less, which has left; clear up if most have."""
        self.n -= 1
        if len(self._heap) > 2 * self.n + 8:
            self._heap = [entry for entry in self._heap if self._sign * entry[1] >= left]
            heapq.heapify(self._heap)


class Percentile(Measure):
    """The value below which a share of the readings lies, interpolated linearly.

    Two heaps meet there, so that a reading costs the logarithm of how many there are. Numbers are
    ordered by value and, if equal, by arrival.
    """

    def __init__(self, q: float) -> None:
        """Begin empty.

        Args:
            q: From 0 to 100.
        """
        self._share = q / 100.0
        self._low = _Half(-1)
        self._high = _Half(1)
        self._entered = 0
        self._left = 0

    @property
    def entries(self) -> int:
        """Return how many numbers are kept, a bounded multiple of the readings of the window."""
        return len(self._low) + len(self._high)

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings."""
        for value in values:
            entry = (value, self._entered)
            is_low = self._low.n and entry < self._low.top(self._left)
            (self._low if is_low else self._high).push(*entry)
            self._entered += 1
            self._balance()

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out readings."""
        for value in values:
            entry = (value, self._left)
            is_low = self._low.n and entry <= self._low.top(self._left)
            self._left += 1
            (self._low if is_low else self._high).forget(self._left)
            self._balance()

    def value(self, contents: Contents, now: Instant) -> float:
        """Return the percentile."""
        rank = self._rank()
        low = self._low.top(self._left)[0]
        above = rank - math.floor(rank)
        if not above:
            return low
        return low * (1.0 - above) + self._high.top(self._left)[0] * above

    def _rank(self) -> float:
        """Return the place of the percentile among the readings in order of value, from 0."""
        return (self._low.n + self._high.n - 1) * self._share

    def _balance(self) -> None:
        """Let the reading at or below the percentile be the top of the low half."""
        wanted = math.floor(self._rank()) + 1 if self._low.n + self._high.n else 0
        while self._low.n < wanted:
            self._low.push(*self._high.pop(self._left))
        while self._low.n > wanted:
            self._high.push(*self._low.pop(self._left))
