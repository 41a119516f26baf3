"""The units of what is computed, and keys that make a monitor."""

import pytest

from domain.errors import InvalidValueError
from domain.windows.settings import Statistic
from service.files.monitor_block import MonitorKeys, ReachedLimit, unit_of


@pytest.mark.parametrize(
    ("statistic", "unit"),
    [
        (Statistic.MEAN, "A"),
        (Statistic.SLOPE, "A/s"),
        (Statistic.RATE, "Hz"),
        (Statistic.COUNT, ""),
        (Statistic.TIME_TO_LIMIT, "s"),
    ],
)
def test_a_statistic_has_a_unit(statistic: Statistic, unit: str) -> None:
    assert unit_of(statistic, "A") == unit


def test_the_slope_of_what_has_no_unit_is_per_second() -> None:
    assert unit_of(Statistic.SLOPE, "") == "1/s"


def test_without_of_it_is_no_monitor() -> None:
    assert MonitorKeys().monitor() is None


@pytest.mark.parametrize("limit", [ReachedLimit(), ReachedLimit(above=1.0, below=0.0)])
def test_a_limit_has_one_side(limit: ReachedLimit) -> None:
    keys = MonitorKeys(of="load", statistic="time_to_limit", window_s=5.0, limit=limit)
    with pytest.raises(InvalidValueError, match="either above or below") as caught:
        keys.monitor()
    assert caught.value.pointer == "limit"
