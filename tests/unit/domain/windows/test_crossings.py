"""Instants at which time alone crosses a threshold."""

import pytest

from domain.timebase import seconds, to_seconds
from domain.windows.crossings import earliest, falls_across_at, rises_across_at
from domain.windows.settings import Threshold
from tests.support.windows import above, below


def test_the_earliest_of_instants_ignores_those_that_never_come() -> None:
    assert earliest(None, 5, 3) == 3
    assert earliest(None, None) is None


@pytest.mark.parametrize("limit_s", [0.0, 0.1, 0.3, 2.0, 1e6 / 3])
def test_a_growing_time_is_above_a_limit_one_nanosecond_after_it(limit_s: float) -> None:
    at = rises_across_at(10, above(limit_s), value=0.0)

    assert at is not None
    assert to_seconds(at - 10) > limit_s
    assert to_seconds(at - 11) <= limit_s


def test_a_growing_time_is_no_longer_below_a_limit_at_it() -> None:
    assert rises_across_at(0, below(2.0), value=1.0) == seconds(2.0)


@pytest.mark.parametrize("threshold", [above(2.0), below(2.0)])
def test_what_has_been_crossed_is_not_crossed_again(threshold: Threshold) -> None:
    assert rises_across_at(0, threshold, value=3.0) is None
    assert falls_across_at(0, threshold, value=1.0) is None


def test_a_time_left_is_below_a_limit_one_nanosecond_after_it() -> None:
    assert falls_across_at(seconds(10.0), below(2.0), value=5.0) == seconds(8.0) + 1
    assert falls_across_at(seconds(10.0), above(2.0), value=5.0) == seconds(8.0)


def test_a_time_left_ends_at_zero() -> None:
    assert falls_across_at(seconds(10.0), above(0.0), value=5.0) == seconds(10.0)
    assert falls_across_at(seconds(10.0), below(0.0), value=5.0) is None
    assert falls_across_at(seconds(10.0), above(-1.0), value=5.0) is None


@pytest.mark.parametrize("limit_s", [1e10, 1e308])
def test_decades_are_not_waited_for(limit_s: float) -> None:
    assert rises_across_at(0, above(limit_s), value=1.0) is None
    assert falls_across_at(10**20, above(limit_s), value=2.0 * 8e307) is None


def test_seconds_that_cannot_tell_nanoseconds_apart_are_crossed_all_the_same() -> None:
    limit_s = 5e8
    at = rises_across_at(0, above(limit_s), value=1.0)

    assert at is not None
    assert to_seconds(at) > limit_s
