"""Sums without rounding."""

import math
import sys

import numpy as np
import pytest

from domain.timebase import seconds
from domain.windows.exact_sums import ExactLine, ExactSpread


def _sum_of(*values: float) -> ExactSpread:
    total = ExactSpread()
    total.enter(values)
    return total


def _line_through(*points: tuple[float, float]) -> ExactLine:
    line = ExactLine(start=0)
    for at_s, value in points:
        line.enter([seconds(at_s)], [value])
    return line


def test_a_small_reading_is_not_lost_beside_a_large_one() -> None:
    total = _sum_of(1e16, 1.0, 1e-300)
    total.leave([1e16, 1.0])

    assert (total.n, total.mean(), total.deviation()) == (1, 1e-300, 0.0)


def test_values_near_a_million_keep_the_digits_of_their_spread() -> None:
    values = [1e6 + math.sin(number) for number in range(1000)]
    total = _sum_of(*([3.7] * 1000), *values)
    total.leave([3.7] * 1000)

    assert total.deviation() == pytest.approx(np.std(values), rel=1e-12)
    assert total.mean() == math.fsum(values) / 1000


def test_the_order_of_readings_does_not_matter() -> None:
    values = [0.1, 1e9, -7.25, 1e-9]

    assert _sum_of(*values).mean() == _sum_of(*reversed(values)).mean()


@pytest.mark.parametrize("scale", [sys.float_info.max, 1e200, 1.0, 1e-200, 5e-324])
def test_squares_that_no_float_holds_do_no_harm(scale: float) -> None:
    total = _sum_of(scale, -scale)

    assert total.mean() == 0.0
    assert total.deviation() == scale


def test_equal_readings_have_no_deviation() -> None:
    assert _sum_of(0.1, 0.1, 0.1).deviation() == 0.0


def test_a_line_has_its_slope_per_second() -> None:
    line = _line_through((1.0, 10.0), (2.0, 8.0), (3.0, 6.0))

    assert line.slope() == -2.0
    assert line.unexplained() == 0.0
    assert not line.is_rising()


def test_a_point_that_left_has_no_weight() -> None:
    line = _line_through((0.5, 1e12), (1.0, 0.1), (2.0, 0.2), (3.0, 0.3))
    line.leave([seconds(0.5)], [1e12])

    assert line.slope() == pytest.approx(0.1, rel=1e-15)


def test_a_finer_reading_changes_nothing_of_those_before() -> None:
    line = _line_through((1.0, 1.0), (2.0, 2.0), (3.0, 3.0 + 2.0**-40))

    assert line.slope() == pytest.approx(1.0, abs=2.0**-40)


def test_points_at_one_instant_have_no_slope() -> None:
    line = _line_through((1.0, 1.0), (1.0, 2.0))

    assert line.slope() is None
    assert line.unexplained() == 1.0


def test_a_line_reaches_a_limit_after_now_or_before() -> None:
    line = _line_through((1.0, 10.0), (2.0, 8.0), (3.0, 6.0))

    assert line.reaches_at(1.0) == seconds(5.5)
    assert line.reaches_at(9.0) == seconds(1.5)


def test_a_level_line_reaches_nothing() -> None:
    assert _line_through((1.0, 1.0), (2.0, 1.0)).reaches_at(1.0) is None


def test_a_bent_line_leaves_a_share_of_the_variance() -> None:
    times, values = [1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 2.0, 1.5]

    left = _line_through(*zip(times, values, strict=True)).unexplained()

    assert left == pytest.approx(1.0 - np.corrcoef(times, values)[0, 1] ** 2)


def test_a_unit_that_no_float_holds_is_none_the_less_exact() -> None:
    total = _sum_of(5e-324, 1.0, 2.0**60)
    total.leave([1.0, 2.0**60])

    assert (total.n, total.mean()) == (1, 5e-324)
