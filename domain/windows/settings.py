"""What a window holds, and which statistic is computed over it."""

from dataclasses import dataclass
from enum import StrEnum

from domain.errors import InvalidValueError
from domain.timebase import Duration

MAX_READINGS = 100_000
"""Readings that a window holds at most; the statistic of a window with more is unknown."""
MAX_RANKED = 20_000
"""The same for percentiles, which keep their readings in order of value, too."""
LEAST_R2 = 0.5
"""Below this share of the variance that a line explains, there is no time to a limit."""


class Statistic(StrEnum):
    """What is computed over the readings of a window."""

    MEAN = "mean"
    MIN = "min"
    MAX = "max"
    STD = "std"
    """Standard deviation of the population: divided by n."""
    RANGE = "range"
    """Largest minus smallest."""
    SLOPE = "slope"
    """Of the line of least squares, per second."""
    COUNT = "count"
    RATE = "rate"
    """Readings per second of the window."""
    GAP = "gap"
    """Longest time between two readings, and from the newest until now; seconds."""
    AGE = "age"
    """Time since the newest reading; seconds."""
    PERCENTILE = "percentile"
    """Interpolated linearly between the two readings beside it."""
    STUCK_FOR = "stuck_for"
    """Time since the value last changed; seconds."""
    TIME_TO_LIMIT = "time_to_limit"
    """Until the line of least squares reaches a limit; seconds."""


OF_ARRIVALS = frozenset({Statistic.COUNT, Statistic.RATE, Statistic.GAP, Statistic.AGE})
"""Statistics of when readings arrive, not of their values; silence says something about them."""


@dataclass(frozen=True, slots=True)
class Threshold:
    """One side of a number."""

    limit: float
    above: bool
    """The side: above the limit, or below it; strictly."""

    def is_passed_by(self, value: float) -> bool:
        """Tell whether a value is on this side."""
        return value > self.limit if self.above else value < self.limit

    def can_be_crossed_rising(self, value: float) -> bool:
        """Tell whether a value that only rises can change sides."""
        return self.above is not self.is_passed_by(value)

    def can_be_crossed_falling(self, value: float) -> bool:
        """Tell whether a value that only falls can change sides."""
        return self.above is self.is_passed_by(value)


@dataclass(frozen=True, slots=True, kw_only=True)
class WindowSettings:
    """A statistic and its window: the readings of a time, or a number of them.

    Raises:
        InvalidValueError: The settings do not fit together; `pointer` is the one to change.
    """

    statistic: Statistic
    length: Duration | None = None
    """The window holds the readings with now - length < arrival <= now."""
    size: int | None = None
    """Or this many of the newest readings."""
    min_n: int = 2
    """With fewer readings in the window the statistic is unknown. Not for those `OF_ARRIVALS`."""
    q: float | None = None
    """Percentile from 0 to 100."""
    limit: Threshold | None = None
    """What `time_to_limit` runs to."""
    min_r2: float = LEAST_R2

    def __post_init__(self) -> None:
        if (self.length is None) is (self.size is None):
            raise InvalidValueError("a window has either window_s or window_n", "window_s")
        if self.length is not None and self.length <= 0:
            raise InvalidValueError("window_s must be greater than 0", "window_s")
        if self.size is not None and not 1 <= self.size <= self.most:
            words = f"window_n must be from 1 to {self.most:,} for {self.statistic}"
            raise InvalidValueError(words, "window_n")
        if not 1 <= self.min_n <= (self.most if self.size is None else self.size):
            raise InvalidValueError("min_n must be from 1 to what the window holds", "min_n")
        self._check_of_one("q", self.q, Statistic.PERCENTILE)
        self._check_of_one("limit", self.limit, Statistic.TIME_TO_LIMIT)
        if self.q is not None and not 0.0 <= self.q <= 100.0:
            raise InvalidValueError("q must be from 0 to 100", "q")
        if not 0.0 <= self.min_r2 <= 1.0:
            raise InvalidValueError("min_r2 must be from 0 to 1", "min_r2")

    @property
    def most(self) -> int:
        """Return how many readings the window holds at most."""
        return MAX_RANKED if self.statistic is Statistic.PERCENTILE else MAX_READINGS

    def _check_of_one(self, key: str, value: object, statistic: Statistic) -> None:
        if self.statistic is statistic and value is None:
            raise InvalidValueError(f"{statistic} needs {key}", key)
        if self.statistic is not statistic and value is not None:
            raise InvalidValueError(f"{key} is for {statistic} only", key)
