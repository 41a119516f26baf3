"""A statistic over a sliding window of the readings of one signal."""

import math

from domain.timebase import Instant
from domain.windows.arrivals import Age, Count, Gap, Rate, RateOfNewest, StuckFor
from domain.windows.crossings import earliest
from domain.windows.measure import Measure
from domain.windows.peaks import Largest, Range, Smallest
from domain.windows.percentile import Percentile
from domain.windows.settings import OF_ARRIVALS, Statistic, Threshold, WindowSettings
from domain.windows.span import Span
from domain.windows.values import Deviation, Mean, Slope, TimeToLimit


class Window:
    """What the readings of a window say at a moment.

    The answers follow from the readings and from the time alone, not from when they were asked for
    before. Time goes forward: no call may name an instant before that of an earlier one.
    """

    def __init__(self, settings: WindowSettings, start: Instant, span: Span | None = None) -> None:
        """Begin empty.

        Args:
            settings: The window and its statistic.
            start: Since when readings would have been heard; silence counts from here.
            span: Holds the readings, for other windows as well; None: for this one only.
        """
        self.settings = settings
        self._span = span or Span(settings.length, size_of(settings), start)
        self._contents = self._span.contents
        what = (settings.statistic, settings.q, settings.limit, settings.min_r2)
        self._measure = self._span.measure(what, lambda: _measure(settings, start))
        self._is_of_arrivals = settings.statistic in OF_ARRIVALS
        self._needs_all = settings.statistic not in {Statistic.AGE, Statistic.STUCK_FOR}

    def add(self, at: Instant, value: float) -> None:
        """Take in a reading.

        Args:
            at: When it arrived.
            value: Finite.
        """
        self._span.add(at, value)

    def value(self, now: Instant) -> float | None:
        """Return the statistic; None: it is unknown.

        It is so with fewer than `min_n` readings, or if they do not have it. Count, rate, gap and
        age are known from when the window has passed once. With more readings than a window holds,
        all but age and `stuck_for` are unknown, and so is what is beyond any float.
        """
        if not self.has_enough(now):
            return None
        try:
            value = self._measure.value(self._contents, now)
        except OverflowError:
            return None
        return value if value is not None and math.isfinite(value) else None

    def crosses_at(self, threshold: Threshold, now: Instant) -> Instant | None:
        """Return when the value may cross a threshold, or become known or unknown, by time alone.

        It does not before; between this instant and then it need not be looked at for the sake of
        this threshold, unless a reading comes. It may turn out not to have been crossed then.

        Args:
            threshold: The one that decides now, which may be where an error clears.
            now: The current time.

        Returns:
            An instant after now; None: it never is.
        """
        value = self.value(now)
        if value is None:
            # Readings that leave may give it a value again.
            at = self.changes_at(now)
            return now + 1 if at == now else at
        at = self._measure.crosses_at(self._contents, now, threshold, value)
        return earliest(self._known_change_at(now), at)

    def changes_at(self, now: Instant) -> Instant | None:
        """Return when the value next changes by time alone.

        Returns:
            `now` if it changes all the time; None: it does not without a reading.
        """
        if not self.has_enough(now):
            return self._known_change_at(now)
        return earliest(self._known_change_at(now), self._measure.changes_at(self._contents, now))

    def has_enough(self, now: Instant) -> bool:
        """Tell whether the window holds the readings that the statistic needs.

        If it does and the statistic is unknown, the readings have none: there is no trend to a
        limit.
        """
        self._span.catch_up(now)
        if self._needs_all and not self._contents.is_complete(now):
            return False
        if self._is_of_arrivals:
            return self._contents.has_passed(now)
        return len(self._contents) >= self.settings.min_n

    def filled(self, now: Instant) -> float:
        """Return how much of the window has passed, from 0 to 1; to look changes nothing."""
        self._span.take_over()
        return self._contents.filled(now)

    def _known_change_at(self, now: Instant) -> Instant | None:
        """Return when the statistic becomes known or unknown by time alone; None: it does not."""
        contents = self._contents
        if self._needs_all and not contents.is_complete(now):
            return contents.complete_at()
        if self._is_of_arrivals:
            return None if contents.has_passed(now) else contents.passes_at()
        spare = len(contents) - self.settings.min_n
        return contents.leaves_at(spare) if spare >= 0 else None


def size_of(settings: WindowSettings) -> int:
    """Return how many readings a window holds at most."""
    if settings.size is not None:
        return settings.size
    return 1 if settings.statistic is Statistic.AGE else settings.most


def _measure(settings: WindowSettings, start: Instant) -> Measure:
    match settings.statistic:
        case Statistic.MEAN:
            return Mean()
        case Statistic.MIN:
            return Smallest()
        case Statistic.MAX:
            return Largest()
        case Statistic.STD:
            return Deviation()
        case Statistic.RANGE:
            return Range()
        case Statistic.SLOPE:
            return Slope(start)
        case Statistic.COUNT:
            return Count()
        case Statistic.RATE:
            return Rate() if settings.size is None else RateOfNewest()
        case Statistic.GAP:
            return Gap()
        case Statistic.AGE:
            return Age()
        case Statistic.PERCENTILE:
            return Percentile(settings.q or 0.0)
        case Statistic.STUCK_FOR:
            return StuckFor()
        case Statistic.TIME_TO_LIMIT:
            assert settings.limit is not None
            return TimeToLimit(start, settings.limit, settings.min_r2)
