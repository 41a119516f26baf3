"""Count, rate, gap, age and how long a value is stuck."""

import pytest

from domain.windows.settings import Statistic, Threshold
from domain.windows.window import Window
from tests.support.windows import above, after, below, fill, window

COUNT, RATE, GAP, AGE = Statistic.COUNT, Statistic.RATE, Statistic.GAP, Statistic.AGE
STUCK_FOR = Statistic.STUCK_FOR


def _ten_hertz(filled: Window, seconds: int) -> Window:
    return fill(filled, ((number / 10, float(number)) for number in range(10 * seconds + 1)))


@pytest.mark.parametrize("statistic", [COUNT, RATE, GAP, AGE])
def test_they_are_known_once_the_window_has_passed(statistic: Statistic) -> None:
    """A rate over the first moments would be far too low, and raise its error at each start."""
    filled = _ten_hertz(window(statistic, window_s=5.0), 4)

    assert filled.value(after(5.0) - 1) is None
    assert filled.changes_at(after(4.0)) == after(5.0)
    assert filled.crosses_at(above(0.0), after(4.0)) == after(5.0)
    assert filled.value(after(5.0)) is not None


@pytest.mark.parametrize(
    ("statistic", "value"), [(COUNT, 0.0), (RATE, 0.0), (GAP, 7.0), (AGE, 7.0)]
)
def test_of_a_topic_that_never_came_silence_counts_from_the_start(
    statistic: Statistic, value: float
) -> None:
    assert window(statistic, window_s=5.0).value(after(7.0)) == value


@pytest.mark.parametrize(
    ("statistic", "value"), [(COUNT, 5.0), (RATE, 8.0), (GAP, 0.1), (AGE, 0.1)]
)
def test_a_window_of_a_number_is_known_when_it_is_full(statistic: Statistic, value: float) -> None:
    filled = fill(window(statistic, window_n=5), [(n / 10, 0.0) for n in range(4)])
    assert filled.value(after(60.0)) is None
    assert filled.changes_at(after(60.0)) is None
    filled = _ten_hertz(window(statistic, window_n=5), 1)
    # Four intervals in 0.5 s: 0.1 s after the newest of five.
    assert filled.value(after(1.1)) == pytest.approx(value)


def test_a_reading_leaves_exactly_when_the_window_is_over_it() -> None:
    filled = _ten_hertz(window(COUNT, window_s=1.0), 2)

    assert filled.value(after(2.0)) == 10.0
    assert filled.value(after(2.1) - 1) == 10.0
    assert filled.value(after(2.1)) == 9.0


def test_the_rate_is_per_second_of_the_window() -> None:
    filled = _ten_hertz(window(RATE, window_s=2.0), 2)

    assert filled.value(after(2.0)) == 10.0
    assert filled.value(after(3.0)) == 5.0


@pytest.mark.parametrize(
    ("threshold", "at_s"),
    [
        (below(8.0), 2.5),
        (above(8.0), 2.4),
        (below(0.4), 4.0),
        (above(0.0), 4.0),
    ],
)
def test_silence_lets_the_rate_fall_at_a_known_instant(threshold: Threshold, at_s: float) -> None:
    filled = _ten_hertz(window(RATE, window_s=2.0), 2)

    assert filled.crosses_at(threshold, after(2.0)) == after(at_s)


@pytest.mark.parametrize("threshold", [above(10.0), below(10.5), below(0.0), above(-1.0)])
def test_a_rate_that_only_falls_does_not_cross_other_thresholds(threshold: Threshold) -> None:
    filled = _ten_hertz(window(RATE, window_s=2.0), 2)

    assert filled.crosses_at(threshold, after(2.0)) is None


def test_the_rate_of_a_number_of_readings_falls_all_the_time() -> None:
    filled = _ten_hertz(window(RATE, window_n=5), 1)

    assert filled.changes_at(after(1.0)) == after(1.0)
    at = filled.crosses_at(below(2.0), after(1.0))
    assert at == after(2.6) + 1
    assert filled.value(after(2.6)) == 2.0
    assert filled.crosses_at(below(0.0), after(2.6)) is None


def test_readings_at_one_instant_have_no_rate_until_time_passes() -> None:
    filled = fill(window(RATE, window_n=2), [(1.0, 0.0), (1.0, 0.0)])

    assert filled.value(after(1.0)) is None
    assert filled.crosses_at(below(1.0), after(1.0)) == after(1.0) + 1
    assert filled.value(after(2.0)) == 1.0


def test_the_longest_gap_leaves_with_the_reading_with_which_it_began() -> None:
    filled = fill(window(GAP, window_s=5.0), [(3.0, 0), (6.0, 0), (6.0, 0), (7.0, 0)])

    assert filled.value(after(7.5)) == 3.0
    assert filled.changes_at(after(7.5)) == after(8.0)
    assert filled.crosses_at(above(2.0), after(7.5)) == after(8.0)
    assert filled.value(after(8.0)) == 1.0


def test_the_gap_to_now_grows() -> None:
    filled = fill(window(GAP, window_s=5.0), [(5.0, 0), (6.0, 0), (6.2, 0)])

    assert filled.changes_at(after(6.2)) == after(7.2)
    assert filled.changes_at(after(7.2)) == after(7.2)
    assert filled.crosses_at(above(2.0), after(7.0)) == after(8.2) + 1
    assert filled.value(after(8.2)) == 2.0
    # Nothing is in the window any more, and it is still silent.
    assert filled.value(after(20.2)) == 14.0
    assert filled.crosses_at(above(2.0), after(20.2)) is None


def test_a_gap_needs_two_readings_in_the_window() -> None:
    filled = fill(window(GAP, window_s=5.0), [(1.0, 0), (8.0, 0), (9.0, 0)])

    assert filled.value(after(9.0)) == 1.0


def test_the_age_is_that_of_the_newest_reading_even_outside_of_the_window() -> None:
    filled = fill(window(AGE, window_s=2.0), [(1.0, 0), (3.0, 0)])

    assert filled.value(after(3.5)) == 0.5
    assert filled.value(after(30.0)) == 27.0
    assert filled.changes_at(after(30.0)) == after(30.0)
    assert filled.crosses_at(above(30.0), after(30.0)) == after(33.0) + 1
    assert filled.crosses_at(above(1.0), after(30.0)) is None


def test_the_age_needs_no_memory() -> None:
    """It is known for a signal that is faster than any window."""
    filled = fill(window(AGE, window_s=2.0), [(number / 1e5, 0.0) for number in range(300_000)])

    assert filled.value(after(3.0)) == pytest.approx(1e-5)


def test_a_value_is_stuck_since_it_changed_also_before_the_window() -> None:
    readings = [(1.0, 5.0), (2.0, 6.0), *((float(second), 6.0) for second in range(3, 20))]
    filled = fill(window(STUCK_FOR, window_s=5.0), readings)

    assert filled.value(after(19.5)) == 17.5
    assert filled.changes_at(after(19.5)) == after(19.5)
    assert filled.crosses_at(above(20.0), after(19.5)) == after(22.0) + 1
    filled.add(after(20.0), 6.1)
    assert filled.value(after(20.0)) == 0.0


def test_a_value_of_which_nothing_is_heard_is_not_known_to_be_stuck() -> None:
    filled = fill(window(STUCK_FOR, window_s=5.0), [(1.0, 6.0), (2.0, 6.0), (3.0, 6.0)])

    assert filled.crosses_at(above(60.0), after(3.0)) == after(7.0)
    assert filled.value(after(7.0) - 1) == pytest.approx(6.0)
    assert filled.value(after(7.0)) is None
