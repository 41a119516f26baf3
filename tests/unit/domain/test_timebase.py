"""Time in whole nanoseconds."""

import hypothesis.strategies as st
import pytest
from hypothesis import given

from domain.timebase import seconds, to_seconds

TEN_DAYS = 10 * 24 * 3600 * 1_000_000_000


@pytest.mark.parametrize(
    ("given_s", "nanoseconds"),
    [
        (0, 0),
        (15, 15_000_000_000),
        (0.1, 100_000_000),
        (1e-9, 1),
        (0.6e-9, 1),
        (0.4e-9, 0),
        (-2.5, -2_500_000_000),
    ],
)
def test_seconds_become_the_nearest_nanosecond(given_s: float, nanoseconds: int) -> None:
    assert seconds(given_s) == nanoseconds
    assert isinstance(seconds(given_s), int)


def test_a_hundred_ticks_of_50_ms_are_exactly_5_s() -> None:
    """With floating-point seconds the sum is 4.999999999999998."""
    assert sum(seconds(0.05) for _ in range(100)) == seconds(5)


@given(st.integers(-TEN_DAYS, TEN_DAYS))
def test_every_nanosecond_of_ten_days_survives_the_way_there_and_back(nanoseconds: int) -> None:
    assert seconds(to_seconds(nanoseconds)) == nanoseconds
