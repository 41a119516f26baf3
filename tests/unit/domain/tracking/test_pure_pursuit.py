from math import atan, atan2, hypot, inf, pi

import numpy as np
import pytest

from domain.paths.path import Path
from domain.tracking.pure_pursuit import PurePursuit
from domain.tracking.tracker import ControlStep
from domain.vehicle import Pose, VehicleLimits, VehicleState
from tests.support.tables import text_table

LIMITS = VehicleLimits()
LINE = Path(np.array([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0], [40.0, 0.0, 0.0]]))


def step(
    x: float, y: float, yaw: float, speed: float = 2.8, path: Path = LINE, index: int = 1
) -> ControlStep:
    state = VehicleState(Pose(x, y, yaw), speed, 0.0)
    return PurePursuit(LIMITS).control_step(state, path, index)


def test_on_the_path_it_steers_straight() -> None:
    said = step(5, 0, 0)

    assert said.steering_angle_rad == 0.0
    assert (said.distance_m, said.cross_track_error_m, said.target_index) == (5.0, 0.0, 1)


def test_it_steers_back_to_the_path() -> None:
    assert step(5, 1, 0).steering_angle_rad < 0 < step(5, -1, 0).steering_angle_rad


def test_in_a_bend_it_steers_as_the_bend_needs() -> None:
    along = np.linspace(0, pi, 400)
    bend = np.column_stack((20 * np.sin(along), 20 - 20 * np.cos(along), along))
    x, y, yaw = bend[100]
    said = step(x, y, yaw, path=Path(bend), index=101)

    assert said.steering_angle_rad == pytest.approx(atan(LIMITS.wheelbase_m / 20), rel=0.01)


@text_table("""
    speed_mps | beside_m | reach_m
    0.0       | 0.0      | 2.2
    5.0       | 0.0      | 3.75
    11.0      | 0.0      | 8.25
    1.0       | 0.3      | 2.85
    1.0       | 2.0      | 5.75
    5.0       | 3.0      | 9.0
""")
def test_it_looks_further_ahead_when_it_is_fast_or_off(
    speed_mps: str, beside_m: str, reach_m: str
) -> None:
    lookahead = step(5, float(beside_m), 0, float(speed_mps)).lookahead

    assert lookahead.x_m == pytest.approx(5 + float(reach_m))


def test_a_vehicle_that_rolls_back_looks_as_far_as_one_that_stands() -> None:
    assert step(5, 0, 0, -3.0).lookahead.x_m == pytest.approx(7.2)


@pytest.mark.parametrize("yaw", [0.9 * pi, pi / 2 + 0.01, -0.9 * pi])
def test_what_lies_behind_is_turned_to_with_all_that_the_wheels_have(yaw: float) -> None:
    assert step(5, 0, yaw).steering_angle_rad == (-1 if yaw > 0 else 1) * (
        LIMITS.max_steering_angle_rad
    )


def test_beyond_the_end_it_goes_straight_on() -> None:
    said = step(41, 0, 0, index=2)

    assert (said.steering_angle_rad, said.distance_m) == (0.0, LINE.length_m)


def test_the_target_never_falls() -> None:
    assert step(3, 0, 0, index=2).target_index == 2


def test_on_a_path_that_ends_where_it_is_looked_at_it_still_steers() -> None:
    # Out to 1.1 m and back: the point that is 2.2 m along the path is where the vehicle stands.
    back = Path(np.array([[0.0, 0.0, 0.0], [1.1, 0.0, 0.0], [0.0, 0.0, 0.0]]))

    assert abs(step(0, 0, 0, 0.0, back).steering_angle_rad) <= LIMITS.max_steering_angle_rad


def test_a_path_shorter_than_the_look_ahead_is_steered_along() -> None:
    short = Path(np.array([[0.0, 0.0, 0.0], [0.0, 0.5, 0.0]]))
    said = step(0.1, 0.0, pi / 2, 0.0, short)

    assert 0 < said.steering_angle_rad < inf
    assert hypot(said.lookahead.x_m, said.lookahead.y_m) == pytest.approx(2.2)


def test_what_lies_behind_is_turned_to_as_hard_as_what_lies_abeam() -> None:
    state = VehicleState(Pose(5.0, 0.0, pi - 0.1), 11.0, 0.0)
    said = PurePursuit(LIMITS).control_step(state, LINE, 1)

    assert said.steering_angle_rad == pytest.approx(-atan2(2 * 1.75, 0.75 * 11.0))
