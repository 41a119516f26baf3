import math

import pytest

from domain.paths.path import Path
from domain.timebase import Instant, seconds
from domain.tracking.leg import Leg
from domain.tracking.line_watch import GivenUpError, LegLimits
from domain.tracking.tracker import ControlStep
from domain.vehicle import Point, Pose, VehicleState
from tests.support.paths import straight

LIMITS = LegLimits(3.0, seconds(1.0), seconds(20.0), 0.05)
STATE = VehicleState(Pose(0.0, 0.0, 0.0), 0.0, 0.0)


def step(distance_m: float = 0.0, error_m: float = 0.0, wheels_rad: float = 0.0) -> ControlStep:
    return ControlStep(wheels_rad, 1, distance_m, error_m, Point(0.0, 0.0))


class Says:
    """A tracker that says what a test wants."""

    def __init__(self, said: ControlStep | Exception) -> None:
        self.said = said

    def control_step(self, state: VehicleState, path: Path, start_index: int) -> ControlStep:
        if isinstance(self.said, Exception):
            raise self.said
        return self.said


def leg(said: ControlStep | Exception | None = None, now: Instant = 0) -> Leg:
    return Leg(straight(), "the way", "odd", Says(said or step()), 0, now)


def test_a_tracker_that_fails_is_given_up_with_its_reason() -> None:
    with pytest.raises(GivenUpError, match="odd failed: ValueError: no idea"):
        leg(ValueError("no idea")).follow(STATE)


def test_a_steering_angle_that_is_no_number_is_given_up() -> None:
    with pytest.raises(GivenUpError, match="not finite"):
        leg(step(wheels_rad=math.nan)).follow(STATE)


def test_it_knows_how_far_the_vehicle_came() -> None:
    line = leg(step(distance_m=4.5))
    line.follow(STATE)

    assert line.distance_m == 4.5


def test_too_large_an_error_is_given_up_once_it_lasts() -> None:
    line = leg()
    line.judge(step(error_m=-3.1), LIMITS, 0)
    line.judge(step(1.0, error_m=-3.1), LIMITS, seconds(0.9))

    with pytest.raises(GivenUpError, match=r"3\.1 m from the way for 1 s"):
        line.judge(step(2.0, error_m=-3.1), LIMITS, seconds(1.0))


def test_no_progress_is_given_up_once_it_lasts() -> None:
    line = leg()
    line.judge(step(1.0), LIMITS, 0)
    line.judge(step(1.04), LIMITS, seconds(19.9))

    with pytest.raises(GivenUpError, match="no progress for 20 s"):
        line.judge(step(1.04), LIMITS, seconds(20.0))
