"""Which windows make sense."""

from typing import Any

import pytest

from domain.errors import InvalidValueError
from domain.timebase import seconds
from domain.windows.settings import MAX_RANKED, MAX_READINGS, Statistic, Threshold, WindowSettings
from tests.support.windows import above, below

MEAN, PERCENTILE = Statistic.MEAN, Statistic.PERCENTILE


@pytest.mark.parametrize(
    ("settings", "pointer"),
    [
        ({"statistic": MEAN}, "window_s"),
        ({"statistic": MEAN, "length": 1, "size": 2}, "window_s"),
        ({"statistic": MEAN, "length": 0}, "window_s"),
        ({"statistic": MEAN, "size": 0}, "window_n"),
        ({"statistic": MEAN, "size": MAX_READINGS + 1}, "window_n"),
        ({"statistic": PERCENTILE, "q": 50.0, "size": MAX_RANKED + 1}, "window_n"),
        ({"statistic": MEAN, "size": 5, "min_n": 6}, "min_n"),
        ({"statistic": MEAN, "length": 1, "min_n": 0}, "min_n"),
        ({"statistic": PERCENTILE, "length": 1}, "q"),
        ({"statistic": PERCENTILE, "length": 1, "q": 100.1}, "q"),
        ({"statistic": PERCENTILE, "length": 1, "q": float("nan")}, "q"),
        ({"statistic": MEAN, "length": 1, "q": 50.0}, "q"),
        ({"statistic": Statistic.TIME_TO_LIMIT, "length": 1}, "limit"),
        ({"statistic": MEAN, "length": 1, "limit": below(0.2)}, "limit"),
        ({"statistic": Statistic.SLOPE, "length": 1, "min_r2": 1.5}, "min_r2"),
    ],
)
def test_settings_that_do_not_fit_together_are_rejected(
    settings: dict[str, Any], pointer: str
) -> None:
    with pytest.raises(InvalidValueError) as raised:
        WindowSettings(**settings)

    assert raised.value.pointer == pointer


def test_one_reading_is_enough_for_a_window_of_one_if_min_n_says_so() -> None:
    assert WindowSettings(statistic=MEAN, size=1, min_n=1).most == MAX_READINGS


def test_a_percentile_holds_fewer_readings() -> None:
    settings = WindowSettings(statistic=PERCENTILE, length=seconds(1.0), q=95.0)

    assert settings.most == MAX_RANKED


@pytest.mark.parametrize(
    ("threshold", "value", "rising", "falling"),
    [
        (above(5.0), 4.0, True, False),
        (above(5.0), 5.0, True, False),
        (above(5.0), 6.0, False, True),
        (below(5.0), 4.0, True, False),
        (below(5.0), 5.0, False, True),
        (below(5.0), 6.0, False, True),
    ],
)
def test_a_threshold_is_crossed_in_one_direction_only(
    threshold: Threshold, value: float, rising: bool, falling: bool
) -> None:
    assert threshold.can_be_crossed_rising(value) is rising
    assert threshold.can_be_crossed_falling(value) is falling
