"""Smallest, largest and range."""

import pytest

from domain.windows.peaks import Peak
from domain.windows.settings import Statistic, Threshold
from tests.support.windows import above, after, below, fill, window

READINGS = [(1.0, 5.0), (2.0, 9.0), (3.0, 2.0), (4.0, 6.0)]


def test_a_peak_keeps_only_what_can_still_become_the_largest() -> None:
    """Each number is appended and removed once: the work does not grow with the window."""
    peak = Peak()
    for number in range(1000):
        peak.enter([number])
        assert (peak.largest, peak.place) == (number, number)


def test_the_first_of_equal_numbers_may_leave() -> None:
    peak = Peak()
    for number in (3, 1, 3):
        peak.enter([number])
    peak.leave(1)

    assert (peak.largest, peak.place) == (3, 1)


@pytest.mark.parametrize(
    ("statistic", "values"),
    [
        (Statistic.MAX, [9.0, 9.0, 6.0, 6.0]),
        (Statistic.MIN, [2.0, 2.0, 2.0, 6.0]),
        (Statistic.RANGE, [7.0, 7.0, 4.0, 0.0]),
    ],
)
def test_readings_leave_one_by_one(statistic: Statistic, values: list[float]) -> None:
    filled = fill(window(statistic, window_s=4.0, min_n=1), READINGS)

    assert [filled.value(after(at_s)) for at_s in (4.0, 5.0, 6.0, 7.0)] == values
    assert filled.value(after(8.0)) is None


@pytest.mark.parametrize(
    ("statistic", "threshold", "at_s"),
    [
        (Statistic.MAX, above(8.0), 6.0),
        (Statistic.MAX, below(8.0), 6.0),
        (Statistic.MAX, above(9.5), 8.0),
        (Statistic.MIN, below(3.0), 7.0),
        (Statistic.MIN, above(3.0), 7.0),
        (Statistic.MIN, below(1.0), 8.0),
        (Statistic.RANGE, above(5.0), 6.0),
        (Statistic.RANGE, below(5.0), 6.0),
        (Statistic.RANGE, above(7.5), 8.0),
    ],
)
def test_time_alone_crosses_a_threshold_only_where_a_peak_leaves(
    statistic: Statistic, threshold: Threshold, at_s: float
) -> None:
    """Where it is not crossed, the instant is that at which the last reading leaves."""
    filled = fill(window(statistic, window_s=4.0, min_n=1), READINGS)

    assert filled.crosses_at(threshold, after(4.0)) == after(at_s)


@pytest.mark.parametrize(
    ("statistic", "at_s"), [(Statistic.MAX, 6.0), (Statistic.MIN, 7.0), (Statistic.RANGE, 6.0)]
)
def test_the_value_changes_where_a_peak_leaves(statistic: Statistic, at_s: float) -> None:
    filled = fill(window(statistic, window_s=4.0, min_n=1), READINGS)

    assert filled.changes_at(after(4.0)) == after(at_s)


def test_a_range_beyond_any_float_is_unknown_while_both_readings_are_there() -> None:
    filled = fill(window(Statistic.RANGE, window_s=4.0), [(1.0, 1.7e308), (2.0, -1.7e308)])
    filled.add(after(3.0), -1e308)

    assert filled.value(after(3.0)) is None
    assert filled.crosses_at(above(1.0), after(3.0)) == after(5.0)
    assert filled.value(after(5.0)) == pytest.approx(0.7e308)


def test_no_more_numbers_leave_than_there_are() -> None:
    peak = Peak()
    peak.enter([3, 1, 2])

    assert peak.leave(2) == 2
    assert (peak.largest, peak.place) == (2, 0)
    assert peak.leave(2) == 1
    assert not peak
