from math import pi

import numpy as np
import pytest

from domain.paths.approach import (
    APPROACH_MPS,
    MAY_MISS_SHARE,
    Approach,
    FarFromPathError,
    plan_approach,
)
from domain.paths.path import Path
from domain.vehicle import Pose, VehicleLimits
from tests.support.approach_limits import approach_limits
from tests.support.paths import straight

VEHICLE = VehicleLimits()


def plan(
    pose: Pose, path: Path | None = None, vehicle: VehicleLimits = VEHICLE, cruise: float = 2.8
) -> Approach | None:
    line = (path or straight(100.0)).for_vehicle(vehicle)
    may_miss_m = MAY_MISS_SHARE * line.length_m
    return plan_approach(line, pose, 0, 0.0, cruise, may_miss_m, approach_limits(vehicle))


def planned(pose: Pose, path: Path | None = None, vehicle: VehicleLimits = VEHICLE) -> Approach:
    found = plan(pose, path, vehicle)
    assert found is not None
    return found


@pytest.mark.parametrize("pose", [Pose(0, 0, 0), Pose(0, 0.5, 0.3), Pose(2, -0.5, -0.3)])
def test_who_is_on_the_path_approaches_nothing(pose: Pose) -> None:
    assert plan(pose) is None


def test_beside_the_path_it_changes_over_like_a_lane() -> None:
    way = planned(Pose(0.0, -3.5, 0.0))

    assert way.distance_m == pytest.approx(3.5)
    assert way.turn_rad == pytest.approx(0.0)
    assert way.length_m < 12.0
    assert way.speed_mps == pytest.approx(APPROACH_MPS)


def test_turned_away_it_drives_a_loop() -> None:
    way = planned(Pose(0.0, 0.0, pi))

    assert abs(way.turn_rad) == pytest.approx(pi)
    assert way.length_m > pi * VEHICLE.min_radius_m


def test_a_short_path_is_met_at_its_start_so_that_nothing_is_missing() -> None:
    way = planned(Pose(0.0, -4.5, 0.0), straight(8.0))

    # Up to 3 m before it count as passed.
    assert way.meets_m < 4.0


def test_the_way_meets_the_path_in_its_direction_and_goes_on_along_it() -> None:
    way = planned(Pose(-2.0, 4.0, 2.0))
    met = way.way.point_at(way.length_m)
    end = way.way.point_at(way.way.length_m)

    assert (met.x_m, met.y_m) == pytest.approx((way.meets_m, 0.0), abs=0.05)
    assert end.y_m == pytest.approx(0.0, abs=1e-6)
    assert end.x_m - met.x_m == pytest.approx(9.0, abs=0.2)


def test_slow_wheels_approach_slower() -> None:
    slow = VehicleLimits(steering_rate_radps=0.11, steering_delay_s=0.2)

    assert 0.1 <= planned(Pose(0.0, 0.0, pi), vehicle=slow).speed_mps < 0.7


def test_no_approach_is_faster_than_the_task() -> None:
    found = plan(Pose(0.0, -3.5, 0.0), cruise=0.4)
    assert found is not None

    assert found.speed_mps == pytest.approx(0.4)


def test_who_stands_too_far_ahead_of_a_short_path_drives_back_to_its_start() -> None:
    assert plan(Pose(5.0, 0.0, 0.0), straight(100.0)) is None
    assert planned(Pose(5.0, 0.0, 0.0), straight(10.0)).meets_m < 4.0


@pytest.mark.parametrize("yaw_rad", np.linspace(-pi, pi, 9).tolist())
def test_every_bend_of_a_way_can_be_steered(yaw_rad: float) -> None:
    way = planned(Pose(1.0, 4.5, yaw_rad))
    at = np.linspace(0.0, way.way.length_m, 300)

    assert np.abs(way.way.curvatures_at(at)).max() <= 1 / VEHICLE.min_radius_m


@pytest.mark.parametrize("pose", [Pose(0.0, 5.1, 0.0), Pose(1e7, 1e7, 0.0), Pose(40.0, 1.0, 0.0)])
def test_who_is_too_far_from_where_the_path_begins_approaches_nothing(pose: Pose) -> None:
    with pytest.raises(FarFromPathError, match="m from where the path goes on"):
        plan(pose, straight(100.0, 100.0))


@pytest.mark.parametrize("wheelbase_m", [0.1, 20.0])
@pytest.mark.parametrize("most_rad", [0.01, 1.5])
def test_a_way_from_any_distance_that_can_be_set_has_a_bounded_number_of_waypoints(
    wheelbase_m: float, most_rad: float
) -> None:
    vehicle = VehicleLimits(wheelbase_m=wheelbase_m, max_steering_angle_rad=most_rad)
    line = straight(2_000.0, 1_000.0).for_vehicle(vehicle)
    limits = approach_limits(vehicle, from_m=1_000.0)
    found = plan_approach(line, Pose(700.0, 700.0, 2.0), 0, 0.0, 2.8, 60.0, limits)

    assert found is not None
    assert found.way.count < 10_000
