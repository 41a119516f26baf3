import math

import pytest

from domain.timebase import seconds
from domain.tracking.leg import Leg
from domain.tracking.line_watch import GivenUpError
from domain.tracking.slow_down import SlowDown, is_slow
from domain.tracking.stanley import Stanley
from domain.vehicle import Pose, VehicleLimits, VehicleState
from tests.support.paths import straight

PATIENCE = seconds(20.0)


def rolls(
    speed_mps: float, x_m: float = 0.0, y_m: float = 1.0, yaw_rad: float = 0.0
) -> VehicleState:
    return VehicleState(Pose(x_m, y_m, yaw_rad), speed_mps, 0.0)


@pytest.fixture
def slow_down() -> SlowDown:
    leg = Leg(straight(100.0), "the path", "stanley", Stanley(VehicleLimits()), 0, 0)
    return SlowDown(leg, 1.0, rolls(5.0), 0)


def test_it_is_over_as_soon_as_the_way_can_be_driven(slow_down: SlowDown) -> None:
    assert not slow_down.is_over(rolls(1.4))
    assert slow_down.is_over(rolls(1.3))
    assert is_slow(rolls(-0.3), 0.3)


def test_who_heads_along_the_path_is_steered_onto_it_meanwhile(slow_down: SlowDown) -> None:
    step, steering_rad = slow_down.follow(rolls(5.0, yaw_rad=0.4))

    assert steering_rad == step.steering_angle_rad < 0


def test_who_is_turned_away_rolls_straight_on(slow_down: SlowDown) -> None:
    step, steering_rad = slow_down.follow(rolls(5.0, yaw_rad=math.pi))

    assert step.steering_angle_rad != 0.0
    assert steering_rad == 0.0


def test_how_far_it_rolled_is_known(slow_down: SlowDown) -> None:
    assert slow_down.rolled_m(rolls(1.0, x_m=3.0, y_m=5.0)) == 5.0


def test_a_vehicle_that_does_not_brake_is_given_up(slow_down: SlowDown) -> None:
    slow_down.judge(rolls(4.0), PATIENCE, seconds(10.0))
    slow_down.judge(rolls(3.99), PATIENCE, seconds(29.9))
    with pytest.raises(GivenUpError, match="m/s, and no slower for 20 s"):
        slow_down.judge(rolls(3.99), PATIENCE, seconds(30.0))
