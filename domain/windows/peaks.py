"""Smallest, largest and range of the readings: one or two of them decide."""

from collections import deque
from collections.abc import Iterable, Sequence
from operator import neg

from domain.timebase import Instant
from domain.windows.contents import Contents
from domain.windows.measure import Measure
from domain.windows.settings import Threshold


class Peak:
    """The largest number of a queue.

    It keeps only those after which no larger one has come: they decrease, and the first is the
    largest. Each is appended once and removed once, so that the cost does not depend on how many
    there are.
    """

    def __init__(self) -> None:
        self._candidates: deque[tuple[float, int]] = deque()
        """Numbers with their places in all that ever entered."""
        self._entered = 0
        self._left = 0

    def __bool__(self) -> bool:
        """Tell whether there is a number."""
        return bool(self._candidates)

    @property
    def largest(self) -> float:
        """Return the largest number; there is one."""
        return self._candidates[0][0]

    @property
    def place(self) -> int:
        """Return the place of the largest in the queue; 0: it leaves next."""
        return self._candidates[0][1] - self._left

    def enter(self, numbers: Iterable[float]) -> None:
        """Append numbers."""
        candidates, place = self._candidates, self._entered
        for number in numbers:
            while candidates and candidates[-1][0] <= number:
                candidates.pop()
            candidates.append((number, place))
            place += 1
        self._entered = place

    def leave(self, count: int) -> int:
        """Remove so many numbers from the front, or all; return how many there were to remove."""
        candidates = self._candidates
        there = min(count, self._entered - self._left)
        left = self._left = self._left + there
        while candidates and candidates[0][1] < left:
            candidates.popleft()
        return there


class Largest(Measure):
    """The largest reading; by time alone it only falls."""

    def __init__(self) -> None:
        self._peak = Peak()

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings."""
        self._peak.enter(values)

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out readings."""
        self._peak.leave(len(values))

    def value(self, contents: Contents, now: Instant) -> float:
        """Return the largest reading."""
        return self._peak.largest

    def crosses_at(
        self, contents: Contents, now: Instant, threshold: Threshold, value: float
    ) -> Instant | None:
        """Return when the largest reading leaves, if a smaller one might cross the threshold."""
        can_cross = threshold.can_be_crossed_falling(value)
        return contents.leaves_at(self._peak.place) if can_cross else None

    def changes_at(self, contents: Contents, now: Instant) -> Instant | None:
        """Return when the largest reading leaves."""
        return contents.leaves_at(self._peak.place) if self._peak else None


class Smallest(Measure):
    """The smallest reading; by time alone it only rises."""

    def __init__(self) -> None:
        self._peak = Peak()
        """Of the readings with the opposite sign."""

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings."""
        self._peak.enter(map(neg, values))

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out readings."""
        self._peak.leave(len(values))

    def value(self, contents: Contents, now: Instant) -> float:
        """Return the smallest reading."""
        return -self._peak.largest

    def crosses_at(
        self, contents: Contents, now: Instant, threshold: Threshold, value: float
    ) -> Instant | None:
        """Return when the smallest reading leaves, if a larger one might cross the threshold."""
        can_cross = threshold.can_be_crossed_rising(value)
        return contents.leaves_at(self._peak.place) if can_cross else None

    def changes_at(self, contents: Contents, now: Instant) -> Instant | None:
        """Return when the smallest reading leaves."""
        return contents.leaves_at(self._peak.place) if self._peak else None


class Range(Measure):
    """The largest minus the smallest reading; by time alone it only falls."""

    def __init__(self) -> None:
        self._high = Peak()
        self._low = Peak()
        """Of the readings with the opposite sign."""

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings."""
        self._high.enter(values)
        self._low.enter(map(neg, values))

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out readings."""
        self._high.leave(len(values))
        self._low.leave(len(values))

    def value(self, contents: Contents, now: Instant) -> float:
        """Return the difference; infinite if it is beyond any float."""
        return self._high.largest + self._low.largest

    def crosses_at(
        self, contents: Contents, now: Instant, threshold: Threshold, value: float
    ) -> Instant | None:
        """Return when one of the two leaves, if a smaller range might cross the threshold."""
        can_cross = threshold.can_be_crossed_falling(value)
        return self.changes_at(contents, now) if can_cross else None

    def changes_at(self, contents: Contents, now: Instant) -> Instant | None:
        """Return when one of the two leaves."""
        if not self._high:
            return None
        return contents.leaves_at(min(self._high.place, self._low.place))
