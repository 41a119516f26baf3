"""Mean, standard deviation, slope and time to a limit: statistics of exact sums."""

import math
from collections.abc import Sequence

from domain.timebase import Instant, to_seconds
from domain.windows.contents import Contents
from domain.windows.crossings import earliest, falls_across_at
from domain.windows.exact_sums import ExactLine, ExactSpread, ExactSum
from domain.windows.measure import Measure
from domain.windows.settings import Threshold

_CHANCE = -math.log(1e-6)
"""How unlikely it has to be that readings without a trend lie so near to a line."""


class Mean(Measure):
    """The mean of the readings."""

    def __init__(self) -> None:
        self._sum = ExactSum()

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings."""
        self._sum.enter(values)

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out readings."""
        self._sum.leave(values)

    def value(self, contents: Contents, now: Instant) -> float:
        """Return the mean."""
        return self._sum.mean()


class Deviation(Measure):
    """The standard deviation of the population."""

    def __init__(self) -> None:
        self._sum = ExactSpread()

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings."""
        self._sum.enter(values)

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out readings."""
        self._sum.leave(values)

    def value(self, contents: Contents, now: Instant) -> float:
        """Return the standard deviation."""
        return self._sum.deviation()


class Slope(Measure):
    """The slope of the line of least squares, per second."""

    def __init__(self, start: Instant) -> None:
        self._line = ExactLine(start)

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings."""
        self._line.enter(times, values)

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out readings."""
        self._line.leave(times, values)

    def value(self, contents: Contents, now: Instant) -> float | None:
        """Return the slope; None: all readings came at once."""
        return self._line.slope()


class TimeToLimit(Slope):
    """The time until the line of least squares passes a limit, 0 if it has.

    It is unknown if the line leads away from the limit, explains less than `min_r2` of the
    variance, or is so short that noise alone could look like it. Of n readings of independent noise
    a line leaves the share u of the variance or less with a probability of about
    u ** ((n - 2) / 2); a straight line is known from three readings on.
    """

    def __init__(self, start: Instant, limit: Threshold, min_r2: float) -> None:
        super().__init__(start)
        self._limit = limit
        self._min_r2 = min_r2

    def value(self, contents: Contents, now: Instant) -> float | None:
        """Return the time in seconds; None: there is no clear trend to the limit."""
        at = self._reached_at(contents)
        return None if at is None else to_seconds(max(0, at - now))

    def crosses_at(
        self, contents: Contents, now: Instant, threshold: Threshold, value: float
    ) -> Instant | None:
        """Return when the time left crosses a threshold, or the line changes."""
        reached_at = self._reached_at(contents)
        if reached_at is None:
            return contents.leaves_at(0)
        return earliest(contents.leaves_at(0), falls_across_at(reached_at, threshold, value))

    def changes_at(self, contents: Contents, now: Instant) -> Instant | None:
        """Return `now` while the limit comes nearer."""
        at = self._reached_at(contents) if len(contents) else None
        return now if at is not None and at > now else super().changes_at(contents, now)

    def _reached_at(self, contents: Contents) -> Instant | None:
        unexplained, n = self._line.unexplained(), len(contents)
        if 1.0 - unexplained < self._min_r2 or self._line.is_rising() is not self._limit.above:
            return None
        if n < 3 or (unexplained and (n - 2) / 2 * -math.log(unexplained) < _CHANCE):
            return None
        return self._line.reaches_at(self._limit.limit)
