"""Limits by mode as a robot file writes them."""

import pytest
from pydantic import ValidationError

from domain.health.signals import ModeLimit
from service.files.mode_limits_block import (
    LimitKeys,
    ModeLimitKeys,
    mode_limits,
    part_and_mode,
)
from tests.support.watched_robot import above


@pytest.mark.parametrize(
    ("key", "part", "mode"),
    [
        ("drive_base.FAST", "drive_base", "FAST"),
        ("/left/arm.FAST", "left/arm", "FAST"),
        ("drive_base", "drive_base", ""),
    ],
)
def test_a_key_names_a_part_and_a_mode(key: str, part: str, mode: str) -> None:
    assert part_and_mode(key) == (part, mode)


def test_a_limit_may_have_a_time_of_its_own() -> None:
    keys = {"default": ModeLimitKeys(above=1.0), "arm.FAST": ModeLimitKeys(above=2.0, for_s=3.0)}
    default, fast = mode_limits(keys, "HIGH", 5.0)
    assert default == ModeLimit(above(1.0, for_s=5))
    assert fast.bound == above(2.0, for_s=3)
    assert (default.name, fast.name) == ("default", "arm.FAST")


def test_a_mode_may_have_no_limit() -> None:
    (limit,) = mode_limits({"arm.FAST": ModeLimitKeys()}, "HIGH", 0.0)
    assert limit.bound is None


@pytest.mark.parametrize("keys", [{"above": 1.0, "below": 0.0}, {"clear_threshold": 1.0}])
def test_a_limit_has_one_side(keys: dict[str, float]) -> None:
    with pytest.raises(ValidationError):
        LimitKeys(**keys)
