"""Numbers that meet no bound."""

import math

import pytest

from domain.health.good_range import GoodRange, good_in_all, good_range
from domain.health.signals import Bound, Comparison
from tests.support.watched_robot import above, below

ALL = GoodRange(-math.inf, math.inf)


def test_without_bounds_every_number_is_good() -> None:
    assert good_range(()) == ALL


@pytest.mark.parametrize("value", [-1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0])
def test_a_number_is_good_if_it_meets_no_bound(value: float) -> None:
    bounds = (below(0.0), above(2.0, "HIGHER"), above(1.0), below(-0.5, "LOWER"))
    lowest, highest = good_range(bounds)

    assert (lowest <= value <= highest) is not any(bound.is_met_by(value) for bound in bounds)


def test_where_an_error_clears_does_not_matter_before_it_is_on() -> None:
    assert good_range([Bound("HIGH", Comparison.ABOVE, 2.0, clear_threshold=1.0)]).highest == 2.0


def test_what_is_no_number_is_in_no_range() -> None:
    lowest, highest = good_range([Bound("LOST", Comparison.EQUAL, "NOT_CONNECTED")])

    assert lowest > highest


def test_what_is_good_in_all_is_good_in_each() -> None:
    assert good_in_all([]) == ALL
    assert good_in_all([GoodRange(0.0, 2.0), GoodRange(-1.0, 1.0)]) == GoodRange(0.0, 1.0)
