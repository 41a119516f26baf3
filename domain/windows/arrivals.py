"""Count, rate, longest gap and age, which tell of when readings arrive, and how long one is stuck.

Silence counts as well: before the first reading, gap and age are the time since the start.
"""

from bisect import bisect_left
from collections.abc import Sequence
from itertools import islice
from operator import sub

from domain.timebase import Duration, Instant, seconds, to_seconds
from domain.windows.contents import Contents
from domain.windows.crossings import NEVER_S, earliest, first_across, rises_across_at
from domain.windows.measure import Measure
from domain.windows.peaks import Peak
from domain.windows.settings import Threshold


class Count(Measure):
    """How many readings the window holds."""

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings: the window counts."""

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out readings: the window counts."""

    def value(self, contents: Contents, now: Instant) -> float | None:
        """Return the number of readings."""
        return self._of(len(contents), contents)

    def crosses_at(
        self, contents: Contents, now: Instant, threshold: Threshold, value: float
    ) -> Instant | None:
        """Return when so many have left that the threshold is crossed."""
        if not threshold.can_be_crossed_falling(value):
            return None
        is_passed = threshold.is_passed_by(value)

        def is_as_now(left: int) -> bool:
            return threshold.is_passed_by(self._of(left, contents)) is is_passed

        left = bisect_left(range(len(contents)), True, key=is_as_now)
        return contents.leaves_at(len(contents) - left) if left else None

    def _of(self, readings: int, contents: Contents) -> float:
        """Return the statistic of a window with so many readings."""
        return float(readings)


class Rate(Count):
    """Readings per second of a window that has a length."""

    def _of(self, readings: int, contents: Contents) -> float:
        return readings / to_seconds(contents.length or 1)


class RateOfNewest(Count):
    """Readings per second of the time since the oldest of a number of readings, which has passed.

    As a window of that length does not hold the reading with which it begins, that is not counted.
    """

    def value(self, contents: Contents, now: Instant) -> float | None:
        """Return the rate; None: all readings came at this instant."""
        elapsed = now - contents.oldest_at
        return (len(contents) - 1) / to_seconds(elapsed) if elapsed else None

    def crosses_at(
        self, contents: Contents, now: Instant, threshold: Threshold, value: float
    ) -> Instant | None:
        """Return when silence lets the rate fall across the threshold."""
        if not threshold.can_be_crossed_falling(value) or threshold.limit <= 0.0:
            return None
        intervals, oldest_at = len(contents) - 1, contents.oldest_at
        elapsed = min(NEVER_S, intervals / threshold.limit)

        def rate_at(then: Instant) -> float:
            return intervals / to_seconds(then - oldest_at)

        return first_across(oldest_at + seconds(elapsed), threshold, value, rate_at)

    def changes_at(self, contents: Contents, now: Instant) -> Instant | None:
        """Return `now`: the rate falls all the time."""
        return now


class Gap(Measure):
    """The longest time between two readings of the window, or from the newest one until now."""

    def __init__(self) -> None:
        self._gaps = Peak()
        """Between the readings of the window, in nanoseconds."""
        self._last_at: Instant | None = None
        """The newest reading of the window."""

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings."""
        first = () if self._last_at is None else (times[0] - self._last_at,)
        self._gaps.enter([*first, *map(sub, islice(times, 1, None), times)])
        self._last_at = times[-1]

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out readings, and the gaps that began with them."""
        if self._gaps.leave(len(times)) < len(times):
            self._last_at = None

    def value(self, contents: Contents, now: Instant) -> float:
        """Return the gap in seconds."""
        silence = now - contents.heard_at
        return to_seconds(max(silence, self._longest))

    def crosses_at(
        self, contents: Contents, now: Instant, threshold: Threshold, value: float
    ) -> Instant | None:
        """Return when the silence or the end of the longest gap crosses the threshold."""
        heard_at = contents.heard_at
        if threshold.can_be_crossed_falling(value):
            # The silence alone never ends.
            return contents.leaves_at(self._gaps.place) if now - heard_at < self._longest else None
        return rises_across_at(heard_at, threshold, value)

    def changes_at(self, contents: Contents, now: Instant) -> Instant | None:
        """Return when the longest gap leaves or is outlasted; `now` while the silence is longer."""
        if now - contents.heard_at >= self._longest:
            return now
        outlasted_at = contents.heard_at + self._longest
        return earliest(contents.leaves_at(self._gaps.place), outlasted_at)

    @property
    def _longest(self) -> Duration:
        return int(self._gaps.largest) if self._gaps else 0


class Age(Measure):
    """The time since the newest reading, whether it is in the window or not."""

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings: the window knows when it arrived."""

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out readings: only the newest counts."""

    def value(self, contents: Contents, now: Instant) -> float:
        """Return the age in seconds."""
        return to_seconds(now - contents.heard_at)

    def crosses_at(
        self, contents: Contents, now: Instant, threshold: Threshold, value: float
    ) -> Instant | None:
        """Return when the age crosses the threshold."""
        return rises_across_at(contents.heard_at, threshold, value)

    def changes_at(self, contents: Contents, now: Instant) -> Instant | None:
        """Return `now`: the age changes all the time."""
        return now


class StuckFor(Measure):
    """The time since the value last changed, even if that was before the window."""

    def __init__(self) -> None:
        self._value: float | None = None
        self._since: Instant = 0

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take in readings."""
        for at, value in zip(times, values, strict=True):
            if value != self._value:
                self._value = value
                self._since = at

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Leave out readings: one may still be the one that changed last."""

    def value(self, contents: Contents, now: Instant) -> float:
        """Return the time in seconds."""
        return to_seconds(now - self._since)

    def crosses_at(
        self, contents: Contents, now: Instant, threshold: Threshold, value: float
    ) -> Instant | None:
        """Return when the time crosses the threshold."""
        return rises_across_at(self._since, threshold, value)

    def changes_at(self, contents: Contents, now: Instant) -> Instant | None:
        """Return `now`: the time changes all the time."""
        return now
