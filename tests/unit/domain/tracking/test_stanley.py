from math import atan, cos, pi, sin

import numpy as np
import pytest

from domain.paths.path import Path
from domain.tracking.stanley import MAX_APPROACH_RAD, Stanley
from domain.tracking.tracker import ControlStep
from domain.vehicle import Point, Pose, VehicleLimits, VehicleState

LIMITS = VehicleLimits()
LINE = Path(np.array([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0], [40.0, 0.0, 0.0]]))


def step(
    x: float,
    y: float,
    yaw: float,
    speed: float = 2.8,
    path: Path = LINE,
    index: int = 1,
    steering: float = 0.0,
) -> ControlStep:
    state = VehicleState(Pose(x, y, yaw), speed, steering)
    return Stanley(LIMITS).control_step(state, path, index)


def test_on_the_path_it_steers_straight() -> None:
    said = step(5, 0, 0)

    assert said.steering_angle_rad == 0.0
    assert (said.distance_m, said.cross_track_error_m, said.target_index) == (5.0, 0.0, 1)


def test_it_steers_back_to_the_path() -> None:
    assert step(5, 0.1, 0).steering_angle_rad < 0 < step(5, -0.1, 0).steering_angle_rad


def test_what_it_says_of_the_vehicle_is_about_the_rear_axle() -> None:
    said = step(5, 1, -0.2)

    assert (said.distance_m, said.cross_track_error_m) == (5.0, 1.0)


def test_it_aims_at_where_the_front_axle_is_on_the_path() -> None:
    assert step(5, 1, -0.2).lookahead == Point(5 + LIMITS.wheelbase_m, 0.0)


def test_in_a_bend_the_rear_axle_is_what_stays_on_the_path() -> None:
    along = np.linspace(0, pi, 2000)
    bend = np.column_stack((5 * np.sin(along), 5 - 5 * np.cos(along), along))
    x, y, yaw = bend[1000]
    needed = atan(LIMITS.wheelbase_m / 5)

    said = step(x, y, yaw, path=Path(bend), index=1001, steering=needed)

    assert said.steering_angle_rad == pytest.approx(needed, rel=0.01)


def test_far_from_the_path_it_approaches_no_steeper_than_slow_steering_can_end() -> None:
    assert step(5, 3, -MAX_APPROACH_RAD).steering_angle_rad == pytest.approx(0)
    assert step(5, 3, -MAX_APPROACH_RAD - 0.1).steering_angle_rad > 0


def test_the_same_heading_is_corrected_more_gently_off_the_path_and_at_speed() -> None:
    near, far = step(5, 0, 0.1), step(5, 3, 0.1 - MAX_APPROACH_RAD)
    fast = step(5, 0, 0.1, 11.0)

    assert near.steering_angle_rad < far.steering_angle_rad < 0
    assert near.steering_angle_rad < fast.steering_angle_rad < 0


def test_wheels_that_turn_to_the_path_already_are_turned_less() -> None:
    assert step(5, 1, 0).steering_angle_rad < step(5, 1, 0, steering=-0.2).steering_angle_rad


def test_at_standstill_the_approach_is_no_step() -> None:
    assert -0.2 < step(5, 0.05, 0, 0.0).steering_angle_rad < -0.1


def test_a_vehicle_that_faces_the_wrong_way_steers_within_its_limit() -> None:
    assert abs(step(5, 0, 3.0).steering_angle_rad) == LIMITS.max_steering_angle_rad


def test_on_the_last_segment_it_keeps_the_heading_of_the_path() -> None:
    north = Path(np.array([[0.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 10.0, 0.0]]))

    for y in (8.0, 9.0, 9.9, 10.5):
        assert step(0, y, pi / 2, path=north, index=2).steering_angle_rad == pytest.approx(0)


def test_the_target_never_falls() -> None:
    assert step(3, 0, 0, index=2).target_index == 2


def test_a_path_shorter_than_the_vehicle_is_steered_along() -> None:
    short = Path(np.array([[0.0, 0.0, 0.0], [0.6 * cos(1), 0.6 * sin(1), 0.0]]))

    assert step(0, 0, 1.0, 0.0, short).steering_angle_rad == pytest.approx(0)
    assert step(0, 0, 0.8, 0.0, short).steering_angle_rad > 0


def test_the_correction_is_damped_and_gentler_at_speed() -> None:
    """The law written out: the front axle is on the path, so that only the heading is wrong."""
    far = LIMITS.wheelbase_m * sin(0.2)
    said = step(5, far, -0.2, speed=7.0, steering=0.1)

    damped = 0.2 - 0.2 * 7.0 / 1.75 * 0.1
    gain = 2.0 * 1.75 / 7.0 / (1 + min(2.0 * far, 0.5 + 0.5 * far))
    assert said.steering_angle_rad == pytest.approx(gain * damped)


def test_at_standstill_the_whole_correction_is_steered() -> None:
    far = LIMITS.wheelbase_m * sin(0.2)
    said = step(5, far, -0.2, speed=0.0)

    assert said.steering_angle_rad == pytest.approx(0.2 / (1 + 0.5 + 0.5 * far))


@pytest.mark.parametrize("yaw", [pi - 0.05, -pi - 0.05, 3 * pi - 0.05])
def test_a_heading_is_turned_the_short_way_round(yaw: float) -> None:
    back = Path(np.array([[0.0, 0.0, 0.0], [-20.0, 0.0, 0.0], [-40.0, 0.0, 0.0]]))

    steering = step(-5, 0, yaw, speed=0.0, path=back).steering_angle_rad
    assert steering == pytest.approx(0.05 + MAX_APPROACH_RAD)


def test_a_bend_is_steered_for_a_little_before_it_begins() -> None:
    along = np.linspace(0, pi, 400)
    bend = np.column_stack((20 + 8 * np.sin(along), 8 - 8 * np.cos(along), along))
    straight = np.column_stack((np.arange(0, 20, 0.5), np.zeros(40), np.zeros(40)))
    path = Path(np.vstack((straight, bend)))

    slow = step(17.5, 0, 0, speed=2.0, path=path, index=36)
    fast = step(18.5, 0, 0, speed=11.0, path=path, index=38)

    assert slow.steering_angle_rad == pytest.approx(0, abs=1e-3)
    assert fast.steering_angle_rad > 0.01
