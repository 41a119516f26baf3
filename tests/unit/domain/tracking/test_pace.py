from math import tan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.paths.speed_profile import SpeedLimits
from domain.tracking.pace import CREEP_MPS, PERIOD, Pace
from domain.vehicle import Pose, VehicleLimits, VehicleState

VEHICLE = VehicleLimits()
SLOW = VehicleLimits(steering_rate_radps=0.2)


def state(speed_mps: float, steering_rad: float = 0.0) -> VehicleState:
    return VehicleState(Pose(0.0, 0.0, 0.0), speed_mps, steering_rad)


def pace(speed_mps: float, vehicle: VehicleLimits = VEHICLE) -> Pace:
    return Pace(SpeedLimits(), vehicle, speed_mps)


def lateral(speed_mps: float, steering_rad: float) -> float:
    return speed_mps**2 * abs(tan(steering_rad)) / VEHICLE.wheelbase_m


def test_the_speed_rises_by_the_acceleration() -> None:
    command = pace(1.0).command(2.8, 0.0, 0.0, state(1.0), 0)

    assert command.speed_mps == pytest.approx(1.05)


def test_it_falls_at_once_where_the_path_demands_it() -> None:
    assert pace(2.0).command(0.5, 0.0, 0.0, state(2.0), 0).speed_mps == 0.5


def test_too_tight_a_bend_is_braked_for_and_steered_as_far_as_possible() -> None:
    command = pace(6.0).command(6.0, 0.6, 0.0, state(6.0), 0)

    assert command.speed_mps == pytest.approx(5.95)
    assert 0 < command.steering_angle_rad < 0.1
    assert lateral(6.0, command.steering_angle_rad) <= 2.0 + 1e-9


def test_wheels_that_are_turned_already_limit_the_speed_too() -> None:
    command = pace(4.0).command(4.0, 0.0, 0.0, state(4.0, 0.3), 0)

    assert lateral(command.speed_mps, 0.3) == pytest.approx(2.0)


def test_an_angle_that_is_still_under_way_limits_the_speed() -> None:
    late = Pace(SpeedLimits(), VehicleLimits(steering_delay_s=0.2), 3.0)
    late.command(3.0, 0.2, 0.0, state(3.0), 0)
    command = late.command(5.0, 0.0, 0.0, state(3.0), PERIOD)

    assert lateral(command.speed_mps, 0.2) <= 2.0 + 1e-9


def test_while_the_error_grows_the_speed_does_not() -> None:
    driving = pace(1.0)
    driving.command(2.8, 0.0, 0.4, state(1.0), 0)

    assert driving.command(2.8, 0.0, -0.5, state(1.0), PERIOD).speed_mps == pytest.approx(1.05)
    assert driving.command(2.8, 0.0, -0.45, state(1.0), 2 * PERIOD).speed_mps > 1.05


def test_from_standstill_it_creeps_also_while_the_error_grows() -> None:
    driving = pace(0.0)
    for number in range(20):
        command = driving.command(2.8, 0.0, 0.4 + number / 100, state(0.0), number * PERIOD)

    assert command.speed_mps == pytest.approx(CREEP_MPS)


def test_while_slow_wheels_trail_the_speed_does_not_grow() -> None:
    assert pace(1.0, SLOW).command(2.8, 0.3, 0.0, state(1.0, 0.0), 0).speed_mps == 1.0
    assert pace(1.0, SLOW).command(2.8, 0.3, 0.0, state(1.0, 0.2), 0).speed_mps > 1.0


def test_a_stop_steers_no_tighter_than_its_speed_allows() -> None:
    command = pace(5.0).stop(0.6, state(5.0))

    assert command.speed_mps == 0.0
    assert lateral(5.0, command.steering_angle_rad) == pytest.approx(2.0)


@given(
    st.lists(
        st.tuples(
            st.floats(0, 11),
            st.floats(-2, 2),
            st.floats(-4, 4),
            st.floats(0, 11),
            st.floats(-0.61, 0.61),
        ),
        min_size=1,
        max_size=20,
    ),
    st.sampled_from([None, 0.1]),
    st.sampled_from([0.0, 0.3]),
    st.floats(0, 11),
)
def test_whatever_happens_the_lateral_acceleration_is_kept(
    steps: list[tuple[float, float, float, float, float]],
    rate: float | None,
    delay_s: float,
    speed: float,
) -> None:
    vehicle = VehicleLimits(steering_rate_radps=rate, steering_delay_s=delay_s)
    driving = pace(speed, vehicle)
    for number, (limit, wanted, error, actual, wheels) in enumerate(steps):
        now = number * PERIOD
        command = driving.command(limit, wanted, error, state(actual, wheels), now)
        assert 0.0 <= command.speed_mps <= limit
        assert abs(command.steering_angle_rad) <= vehicle.max_steering_angle_rad
        assert lateral(command.speed_mps, command.steering_angle_rad) <= 2.0 + 1e-9
        assert lateral(command.speed_mps, wheels) <= 2.0 + 1e-9
