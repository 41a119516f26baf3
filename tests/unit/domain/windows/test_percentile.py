"""Percentiles."""

import random

import numpy as np
import pytest

from domain.windows.percentile import Percentile
from domain.windows.settings import Statistic
from tests.support.windows import after, fill, window


@pytest.mark.parametrize(("q", "expected"), [(0.0, 1.0), (50.0, 2.5), (90.0, 3.7), (100.0, 4.0)])
def test_it_is_interpolated_between_readings(q: float, expected: float) -> None:
    filled = fill(
        window(Statistic.PERCENTILE, window_n=4, q=q),
        [(1.0, 99.0), (2.0, 3.0), (3.0, 1.0), (4.0, 4.0), (5.0, 2.0)],
    )

    assert filled.value(after(5.0)) == pytest.approx(expected)


@pytest.mark.parametrize("q", [0.0, 50.0, 100.0])
def test_a_window_that_ran_empty_begins_anew(q: float) -> None:
    filled = fill(window(Statistic.PERCENTILE, window_s=1.0, q=q, min_n=1), [(1.0, 5.0)])
    assert filled.value(after(2.0)) is None

    filled.add(after(3.0), 7.0)

    assert filled.value(after(3.0)) == 7.0


def test_equal_readings_are_told_apart_by_their_arrival() -> None:
    filled = window(Statistic.PERCENTILE, window_n=3, q=50.0)
    for number in range(50):
        filled.add(after(number), float(number % 2))

    assert filled.value(after(50.0)) == 1.0


@pytest.mark.parametrize("direction", [1, -1])
def test_memory_is_bounded_when_readings_only_rise_or_fall(direction: int) -> None:
    """Those that left lie at the bottom of a heap then, where nothing finds them."""
    percentile = Percentile(50.0)
    for number in range(20):
        percentile.enter([number], [float(direction * number)])
    for number in range(20, 5000):
        percentile.leave([number], [float(direction * (number - 20))])
        percentile.enter([number], [float(direction * number)])

    assert percentile.entries < 100


def test_it_equals_numpy_on_a_random_walk() -> None:
    rng = random.Random(5)
    values = [0.0]
    filled = window(Statistic.PERCENTILE, window_n=50, q=95.0)
    for number in range(500):
        values.append(values[-1] + rng.choice([-1.0, 0.0, 1.0]))
        filled.add(after(number), values[-1])
        if number:
            expected = np.percentile(values[1:][-50:], 95.0)
            assert filled.value(after(number)) == pytest.approx(expected, abs=1e-12)
