"""Mean, standard deviation, slope and time to a limit."""

import random
from collections.abc import Iterator

import pytest

from domain.windows.settings import Statistic
from domain.windows.window import Window
from tests.support.windows import above, after, below, fill, window

FULL = 0.9
LIMIT = 0.2
PER_SECOND = 0.0005
NOISE = 0.002


def _discharge(seed: int, until_s: int) -> Iterator[tuple[float, float]]:
    """Yield a battery that empties evenly, read once per second with noise."""
    rng = random.Random(seed)
    for second in range(until_s + 1):
        yield float(second), FULL - PER_SECOND * second + rng.gauss(0.0, NOISE)


def _time_to_limit(window_s: float = 60.0) -> Window:
    return window(Statistic.TIME_TO_LIMIT, window_s, limit=below(LIMIT))


def test_the_mean_follows_what_leaves() -> None:
    filled = fill(window(Statistic.MEAN, window_s=2.0), [(1.0, 1.0), (2.0, 2.0), (2.5, 6.0)])

    assert filled.value(after(2.5)) == 3.0
    assert filled.changes_at(after(2.5)) == after(3.0)
    assert filled.crosses_at(above(3.5), after(2.5)) == after(3.0)
    assert filled.value(after(3.0)) == 4.0
    # One reading is fewer than `min_n`.
    assert filled.value(after(4.0)) is None
    assert filled.changes_at(after(4.0)) is None


def test_the_deviation_is_that_of_the_population() -> None:
    filled = fill(window(Statistic.STD, window_n=2), [(1.0, 9.0), (2.0, 2.0), (3.0, 4.0)])

    assert filled.value(after(3.0)) == 1.0
    assert filled.changes_at(after(3.0)) is None


def test_the_slope_is_per_second() -> None:
    filled = fill(window(Statistic.SLOPE, window_s=10.0), [(1.0, 20.0), (1.5, 20.5), (2.0, 21.0)])

    assert filled.value(after(2.0)) == 1.0


def test_readings_at_one_instant_have_no_slope() -> None:
    filled = fill(window(Statistic.SLOPE, window_n=2), [(1.0, 20.0), (1.0, 20.5)])

    assert filled.value(after(1.0)) is None


@pytest.mark.parametrize("seed", range(20))
def test_the_time_to_a_limit_is_right_within_5_percent(seed: int) -> None:
    filled = fill(_time_to_limit(120.0), _discharge(seed, 300))

    left_s = (FULL - LIMIT) / PER_SECOND - 300.0
    assert filled.value(after(300.0)) == pytest.approx(left_s, rel=0.05)


@pytest.mark.parametrize("window_s", [3.0, 10.0, 60.0])
@pytest.mark.parametrize("seed", range(5))
def test_noise_alone_leads_to_no_limit(seed: int, window_s: float) -> None:
    rng = random.Random(seed)
    filled = _time_to_limit(window_s)
    known = []
    for second in range(2000):
        filled.add(after(second), 0.21 + rng.gauss(0.0, NOISE))
        known.append(filled.value(after(second)) is not None)

    assert not any(known)


def test_a_straight_line_is_known_from_the_third_reading_on() -> None:
    """Through two readings there is always a line."""
    filled = fill(_time_to_limit(), [(1.0, 0.5), (2.0, 0.4)])
    assert filled.value(after(2.0)) is None

    filled.add(after(3.0), 0.3)

    assert filled.value(after(3.0)) == pytest.approx(1.0)


def test_between_readings_the_limit_comes_nearer() -> None:
    filled = fill(_time_to_limit(), [(1.0, 0.9), (2.0, 0.8), (3.0, 0.7)])

    assert filled.changes_at(after(3.0)) == after(3.0)
    crossed = filled.crosses_at(below(2.0), after(3.0))
    assert crossed == pytest.approx(after(6.0), abs=10)
    assert filled.value(after(4.0)) == pytest.approx(4.0)
    assert filled.value(after(9.0)) == 0.0
    assert filled.changes_at(after(9.0)) == after(61.0)


def test_a_line_that_leads_away_reaches_no_limit() -> None:
    filled = fill(_time_to_limit(), [(1.0, 0.5), (2.0, 0.6), (3.0, 0.7)])

    assert filled.value(after(3.0)) is None
    assert filled.crosses_at(below(60.0), after(3.0)) == after(61.0)


def test_a_limit_can_be_above() -> None:
    filled = fill(
        window(Statistic.TIME_TO_LIMIT, window_n=3, limit=above(80.0)),
        [(1.0, 50.0), (2.0, 60.0), (3.0, 70.0)],
    )

    assert filled.value(after(3.0)) == pytest.approx(1.0)


def test_a_line_that_explains_too_little_is_none() -> None:
    points = list(_discharge(1, 60))

    trusting = window(Statistic.TIME_TO_LIMIT, 60.0, limit=below(LIMIT), min_r2=0.9)
    strict = window(Statistic.TIME_TO_LIMIT, 60.0, limit=below(LIMIT), min_r2=0.999)

    assert fill(trusting, points).value(after(60.0)) is not None
    assert fill(strict, points).value(after(60.0)) is None


def test_a_value_that_does_not_move_leads_nowhere() -> None:
    filled = fill(_time_to_limit(), [(1.0, 0.5), (2.0, 0.5), (3.0, 0.5)])

    assert filled.value(after(3.0)) is None
