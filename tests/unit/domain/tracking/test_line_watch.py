"""A line is given up when its vehicle leaves it, or does not get on."""

import re

import pytest

from domain.timebase import seconds
from domain.tracking.line_watch import GivenUpError, LegLimits, LineWatch

LIMITS = LegLimits(
    max_cross_track_m=3.0,
    max_cross_track_for=seconds(1),
    no_progress_for=seconds(20),
    least_progress_m=0.05,
)


def test_a_large_error_is_given_up_only_if_it_lasts() -> None:
    watch = LineWatch("the path", seconds(0))
    watch.judge(-3.1, 1.0, LIMITS, seconds(1))
    watch.judge(2.9, 2.0, LIMITS, seconds(1.5))
    watch.judge(3.1, 3.0, LIMITS, seconds(2))
    watch.judge(3.1, 4.0, LIMITS, seconds(2.9))
    with pytest.raises(GivenUpError, match=re.escape("3.5 m from the path for 1 s")):
        watch.judge(-3.5, 5.0, LIMITS, seconds(3))


def test_small_steps_are_no_progress() -> None:
    watch = LineWatch("the path", seconds(0))
    watch.judge(0.0, 1.0, LIMITS, seconds(0))
    watch.judge(0.0, 1.04, LIMITS, seconds(19.9))
    with pytest.raises(GivenUpError, match="no progress for 20 s"):
        watch.judge(0.0, 1.04, LIMITS, seconds(20))


def test_slow_progress_is_progress() -> None:
    watch = LineWatch("the path", seconds(0))
    for second in range(0, 100, 10):
        watch.judge(0.0, second / 100, LIMITS, seconds(second))
