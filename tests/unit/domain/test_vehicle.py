from math import cos, radians, sin, tan

import pytest

from domain.vehicle import VehicleLimits


def test_the_tightest_bend_is_that_of_the_turned_front_wheels() -> None:
    """Rear axle, front axle and the centre of the bend form a right triangle."""
    limits = VehicleLimits(wheelbase_m=2.0, max_steering_angle_rad=radians(30))

    assert limits.min_radius_m == pytest.approx(2.0 * cos(radians(30)) / sin(radians(30)))
    assert VehicleLimits().min_radius_m == pytest.approx(1.75 / tan(0.61))


def test_the_size_of_a_vehicle_is_that_of_its_wheelbase() -> None:
    assert VehicleLimits().scale == 1.0
    assert VehicleLimits(wheelbase_m=0.175).scale == pytest.approx(0.1)
