"""When a value that time alone changes passes a threshold."""

from bisect import bisect_left
from collections.abc import Callable

from domain.timebase import Instant, seconds, to_seconds
from domain.windows.settings import Threshold

NEVER_S = 1e9
"""Seconds, 30 years, that no window waits for."""
_ROUNDING = 200
"""Nanoseconds that a float of so many seconds cannot tell apart."""


def earliest(*instants: Instant | None) -> Instant | None:
    """Return the earliest of instants; None: there is none."""
    first = None
    for at in instants:
        if at is not None and (first is None or at < first):
            first = at
    return first


def rises_across_at(since: Instant, threshold: Threshold, value: float) -> Instant | None:
    """Return when the seconds since an instant cross a threshold; None: they never will."""
    if not threshold.can_be_crossed_rising(value) or threshold.limit > NEVER_S:
        return None
    at = since + seconds(threshold.limit)
    return first_across(at, threshold, value, lambda then: to_seconds(then - since))


def falls_across_at(until: Instant, threshold: Threshold, value: float) -> Instant | None:
    """Return when the seconds until an instant cross a threshold; None: they never will.

    They end at 0.
    """
    if not threshold.can_be_crossed_falling(value) or not 0.0 <= threshold.limit <= NEVER_S:
        return None
    at = until - seconds(threshold.limit)
    return first_across(at, threshold, value, lambda then: to_seconds(max(0, until - then)))


def first_across(
    near: Instant, threshold: Threshold, value: float, value_at: Callable[[Instant], float]
) -> Instant | None:
    """Return the first instant on the other side of a threshold; None: there is none.

    Args:
        near: When that is, but for the rounding of seconds to floats.
        threshold: What is crossed, in one direction.
        value: A value before.
        value_at: The value at an instant.
    """
    is_passed = threshold.is_passed_by(value)
    instants = range(near - 1, near + _ROUNDING)

    def is_across(at: Instant) -> bool:
        return threshold.is_passed_by(value_at(at)) is not is_passed

    place = bisect_left(instants, True, key=is_across)
    return instants[place] if place < len(instants) else None
