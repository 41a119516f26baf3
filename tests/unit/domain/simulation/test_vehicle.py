import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from domain.inputs import VehicleReport
from domain.simulation.vehicle import SimulatedVehicle
from domain.simulation.vehicle_settings import Noise, Plant, VehicleFault, VehicleSettings
from domain.timebase import Instant, seconds, to_seconds
from domain.vehicle import COMMAND_VALID_FOR, DriveCommand, Pose, VehicleLimits

START = seconds(50.0) + 3
LIMITS = VehicleLimits()
SLOW = Plant(
    acceleration_mps2=1.0,
    braking_mps2=2.0,
    steering_rate_radps=0.5,
    steering_lag_s=0.15,
    speed_lag_s=0.2,
    delay=seconds(0.1),
    noise=Noise(0.02, 0.01, 0.05, seed=7),
)


def at(time_s: float) -> Instant:
    return START + seconds(time_s)


def vehicle(plant: Plant | None = None, pose: Pose | None = None) -> SimulatedVehicle:
    settings = VehicleSettings(pose or Pose(0.0, 0.0, 0.0), plant or Plant())
    return SimulatedVehicle(settings, START)


def driven(
    it: SimulatedVehicle, command: DriveCommand, from_s: float, until_s: float
) -> list[VehicleReport]:
    """Give a command each 50 ms and return what the vehicle reports until `until_s`."""
    reports: list[VehicleReport] = []
    for step in range(round((until_s - from_s) / 0.05)):
        it.drive(command, at(from_s + step * 0.05))
        reports += it.advance(at(from_s + step * 0.05))
    reports += it.advance(at(until_s))
    return reports


# --- reports -------------------------------------------------------------------------------------


def test_the_first_report_is_there_from_the_start_and_then_twenty_a_second() -> None:
    it = vehicle()
    times = []
    while it.wake_at() <= at(0.2):
        times.append(to_seconds(it.wake_at() - START))
        assert len(it.advance(it.wake_at())) == 1

    assert times == [0.0, 0.05, 0.1, 0.15, 0.2]


def test_reports_that_were_not_fetched_are_all_there_later() -> None:
    it = vehicle()

    assert len(it.advance(at(1.0))) == 21
    assert it.advance(at(1.0)) == ()
    assert it.wake_at() == at(1.05)


def test_a_vehicle_reports_where_it_was_put() -> None:
    (report,) = vehicle(pose=Pose(3.0, -2.0, 1.0)).advance(START)

    assert report.state.pose == Pose(3.0, -2.0, 1.0)
    assert report.state.speed_mps == 0.0


def test_a_lost_localization_says_nothing_and_comes_back_on_the_grid() -> None:
    it = vehicle()
    it.advance(START)
    it.set_reporting(False, at(0.01))

    assert it.advance(at(1.0)) == ()

    it.set_reporting(True, at(1.01))
    assert it.advance(at(1.01)) == ()
    assert it.wake_at() == at(1.05)
    assert len(it.advance(at(1.05))) == 1


def test_a_vehicle_whose_localization_is_lost_moves_all_the_same() -> None:
    it = vehicle()
    it.set_reporting(False, START)
    driven(it, DriveCommand(2.0, 0.0), 0.0, 1.0)

    assert it.state.pose.x_m == pytest.approx(2.0)


# --- faults --------------------------------------------------------------------------------------


def test_a_vehicle_with_a_fault_reports_nothing_until_it_recovers() -> None:
    it = vehicle()
    it.advance(START)
    it.set_fault(VehicleFault.SILENT, at(0.01))

    assert it.advance(at(1.0)) == ()

    it.set_fault(None, at(1.01))
    assert len(it.advance(at(1.05))) == 1


def test_weak_brakes_stop_it_late_and_accelerate_as_before() -> None:
    it = vehicle()
    it.set_fault(VehicleFault.WEAK_BRAKES, START)
    driven(it, DriveCommand(3.0, 0.0), 0.0, 0.1)
    assert it.state.speed_mps == 3.0

    driven(it, DriveCommand(0.0, 0.0), 0.1, 5.1)

    assert it.state.speed_mps == pytest.approx(3.0 - 5 * 0.3, abs=0.02)


def test_brakes_that_are_weaker_than_weak_stay_so() -> None:
    it = vehicle(Plant(braking_mps2=0.1))
    it.set_fault(VehicleFault.WEAK_BRAKES, START)
    driven(it, DriveCommand(3.0, 0.0), 0.0, 0.1)
    driven(it, DriveCommand(0.0, 0.0), 0.1, 5.1)

    assert it.state.speed_mps == pytest.approx(3.0 - 5 * 0.1, abs=0.02)


def test_brakes_that_recover_do_at_once_what_is_commanded() -> None:
    it = vehicle()
    it.set_fault(VehicleFault.WEAK_BRAKES, START)
    driven(it, DriveCommand(3.0, 0.0), 0.0, 0.1)
    driven(it, DriveCommand(0.0, 0.0), 0.1, 1.0)
    assert it.fault is VehicleFault.WEAK_BRAKES

    it.set_fault(None, at(1.0))

    assert it.state.speed_mps == 0.0
    assert it.fault is None


# --- an ideal vehicle ----------------------------------------------------------------------------


def test_an_ideal_vehicle_follows_at_once() -> None:
    it = vehicle()
    it.drive(DriveCommand(2.0, 0.3), START)

    assert it.state.speed_mps == 2.0
    assert it.state.steering_angle_rad == 0.3
    assert it.command == DriveCommand(2.0, 0.3)


def test_an_ideal_vehicle_drives_straight_along_its_heading() -> None:
    it = vehicle(pose=Pose(1.0, 2.0, math.pi / 6))
    driven(it, DriveCommand(2.0, 0.0), 0.0, 3.0)

    assert it.state.pose.x_m == pytest.approx(1.0 + 6.0 * math.cos(math.pi / 6))
    assert it.state.pose.y_m == pytest.approx(2.0 + 6.0 * math.sin(math.pi / 6))
    assert it.state.pose.yaw_rad == pytest.approx(math.pi / 6)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_ideal_vehicle_is_back_where_it_was_after_a_full_circle(side: float) -> None:
    it = vehicle()
    radius = LIMITS.wheelbase_m / math.tan(0.4)
    speed = 2 * math.pi * radius / 10.0
    driven(it, DriveCommand(speed, side * 0.4), 0.0, 5.0)

    # Half of it: opposite, on the side that is steered to, and turned around.
    assert it.state.pose.x_m == pytest.approx(0.0, abs=1e-9)
    assert it.state.pose.y_m == pytest.approx(side * 2 * radius)
    assert abs(it.state.pose.yaw_rad) == pytest.approx(math.pi)

    driven(it, DriveCommand(speed, side * 0.4), 5.0, 10.0)
    assert it.state.pose.x_m == pytest.approx(0.0, abs=1e-9)
    assert it.state.pose.y_m == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("steering_angle_rad", [0.61, -0.3, 0.01, 1e-6, -1e-9, 1e-12])
def test_an_ideal_vehicle_is_on_its_circle_in_each_report(steering_angle_rad: float) -> None:
    it = vehicle()
    curvature = math.tan(steering_angle_rad) / LIMITS.wheelbase_m
    reports = driven(it, DriveCommand(3.0, steering_angle_rad), 0.0, 60.0)

    assert len(reports) == 1201
    for number, report in enumerate(reports):
        turned = curvature * 3.0 * number * 0.05
        pose = report.state.pose
        # sin(t) / k and (1 - cos(t)) / k, written so that nothing is lost where k is next to 0.
        chord = 3.0 * number * 0.05 * math.sin(turned / 2) / (turned / 2) if turned else 0.0
        assert pose.x_m == pytest.approx(chord * math.cos(turned / 2), abs=1e-9)
        assert pose.y_m == pytest.approx(chord * math.sin(turned / 2), abs=1e-9)
        assert math.remainder(pose.yaw_rad - turned, math.tau) == pytest.approx(0.0, abs=1e-9)


def test_a_vehicle_drives_backwards_too() -> None:
    it = vehicle()
    driven(it, DriveCommand(-1.0, 0.2), 0.0, 1.0)

    assert it.state.pose.x_m < -0.9
    assert it.state.pose.yaw_rad == pytest.approx(-math.tan(0.2) / LIMITS.wheelbase_m)


def test_a_heading_of_more_than_half_a_turn_is_reported_within_it() -> None:
    (report,) = vehicle(pose=Pose(0.0, 0.0, 3.0 * math.pi + 0.1)).advance(START)

    assert report.state.pose.yaw_rad == pytest.approx(-math.pi + 0.1)


# --- commands ------------------------------------------------------------------------------------


def test_a_command_is_void_after_half_a_second_and_the_steering_stays() -> None:
    it = vehicle()
    it.drive(DriveCommand(2.0, 0.1), START)

    it.advance(START + COMMAND_VALID_FOR - 1)
    assert it.command == DriveCommand(2.0, 0.1)

    it.advance(START + COMMAND_VALID_FOR)
    assert it.command == DriveCommand(0.0, 0.1)

    it.advance(at(10.0))
    assert it.state.speed_mps == 0.0
    assert it.state.steering_angle_rad == 0.1
    assert math.hypot(it.state.pose.x_m, it.state.pose.y_m) == pytest.approx(1.0, abs=0.01)


def test_a_command_that_is_renewed_in_time_stays() -> None:
    it = vehicle()
    it.drive(DriveCommand(2.0, 0.0), START)
    it.drive(DriveCommand(2.0, 0.0), at(0.49))
    it.advance(at(0.95))

    assert it.command.speed_mps == 2.0


def test_a_command_takes_effect_after_the_delay_and_is_valid_from_then_on() -> None:
    it = vehicle(Plant(delay=seconds(0.123)))
    it.drive(DriveCommand(2.0, 0.0), START)

    it.advance(at(0.122))
    assert it.command.speed_mps == 0.0
    it.advance(at(0.123))
    assert it.command.speed_mps == 2.0
    it.advance(at(0.622))
    assert it.command.speed_mps == 2.0
    it.advance(at(0.623))
    assert it.command.speed_mps == 0.0
    assert it.state.pose.x_m == pytest.approx(1.0)


def test_commands_beyond_what_the_vehicle_can_do_are_cut() -> None:
    it = vehicle()
    it.drive(DriveCommand(99.0, -2.0), START)
    assert it.command == DriveCommand(LIMITS.max_speed_mps, -LIMITS.max_steering_angle_rad)

    it.drive(DriveCommand(-99.0, 2.0), START)
    assert it.command == DriveCommand(-LIMITS.max_speed_mps, LIMITS.max_steering_angle_rad)


@pytest.mark.parametrize(
    "command",
    [
        DriveCommand(math.nan, 0.0),
        DriveCommand(2.0, math.nan),
        DriveCommand(math.inf, 0.0),
        DriveCommand(2.0, -math.inf),
    ],
)
def test_a_command_that_is_no_number_stops_the_vehicle(command: DriveCommand) -> None:
    it = vehicle()
    it.drive(DriveCommand(2.0, 0.2), START)
    it.drive(command, at(0.1))

    assert it.command == DriveCommand(0.0, 0.2)


def test_a_command_that_is_no_number_keeps_the_steering_of_the_one_before_it() -> None:
    it = vehicle(Plant(delay=seconds(0.1)))
    it.drive(DriveCommand(2.0, 0.2), START)
    it.drive(DriveCommand(math.nan, math.nan), at(0.05))
    it.advance(at(0.2))

    assert it.command == DriveCommand(0.0, 0.2)


# --- how a vehicle responds ----------------------------------------------------------------------


def test_speed_rises_and_falls_no_faster_than_the_plant_can() -> None:
    it = vehicle(Plant(acceleration_mps2=1.0, braking_mps2=2.0))
    driven(it, DriveCommand(3.0, 0.0), 0.0, 2.0)
    assert it.state.speed_mps == pytest.approx(2.0)
    assert it.state.pose.x_m == pytest.approx(2.0, abs=0.01)

    driven(it, DriveCommand(0.0, 0.0), 2.0, 2.5)
    assert it.state.speed_mps == pytest.approx(1.0)


def test_a_vehicle_that_is_to_drive_backwards_brakes_first() -> None:
    it = vehicle(Plant(acceleration_mps2=1.0, braking_mps2=4.0))
    driven(it, DriveCommand(1.0, 0.0), 0.0, 1.0)
    driven(it, DriveCommand(-3.0, 0.0), 1.0, 1.25)
    assert it.state.speed_mps == pytest.approx(0.0, abs=1e-6)

    driven(it, DriveCommand(-3.0, 0.0), 1.25, 2.25)
    assert it.state.speed_mps == pytest.approx(-1.0)


def test_a_vehicle_brakes_as_hard_as_it_can_when_it_hears_nothing() -> None:
    it = vehicle(Plant(braking_mps2=2.0))
    driven(it, DriveCommand(4.0, 0.0), 0.0, 1.0)
    it.advance(at(10.0))

    # The last command was given 50 ms before; 0.45 s more at 4 m/s, then v^2 / 2a.
    assert it.state.speed_mps == 0.0
    assert it.state.pose.x_m == pytest.approx(4.0 + 4.0 * 0.45 + 4.0, abs=0.03)


def test_the_steering_turns_no_faster_than_the_plant_can() -> None:
    it = vehicle(Plant(steering_rate_radps=0.5))
    driven(it, DriveCommand(1.0, 0.4), 0.0, 0.4)
    assert it.state.steering_angle_rad == pytest.approx(0.2)

    driven(it, DriveCommand(1.0, 0.4), 0.4, 1.0)
    assert it.state.steering_angle_rad == pytest.approx(0.4)


def test_what_lags_has_come_63_percent_of_the_way_after_its_time_constant() -> None:
    it = vehicle(Plant(steering_lag_s=0.2, speed_lag_s=0.4))
    driven(it, DriveCommand(2.0, 0.5), 0.0, 0.2)
    assert it.state.steering_angle_rad == pytest.approx(0.5 * (1 - math.exp(-1)))

    driven(it, DriveCommand(2.0, 0.5), 0.2, 0.4)
    assert it.state.speed_mps == pytest.approx(2.0 * (1 - math.exp(-1)))


def test_a_vehicle_with_lag_stands_still_in_the_end() -> None:
    it = vehicle(SLOW)
    driven(it, DriveCommand(2.0, 0.3), 0.0, 2.0)
    it.advance(at(20.0))

    assert it.state.speed_mps == 0.0
    assert it.state.steering_angle_rad == 0.3


def reference(
    speed_mps: float, angle_rad: float, plant: Plant, until_s: float
) -> tuple[float, float, float]:
    """Return the pose that the equations of the bicycle lead to from rest at the origin.

    Runge-Kutta of 4th order over x, y, yaw, speed and steering angle, 0.1 ms a step.
    """
    acceleration, rate = plant.acceleration_mps2, plant.steering_rate_radps
    assert acceleration is not None
    assert rate is not None

    def slopes(state: NDArray[np.float64]) -> NDArray[np.float64]:
        _, _, yaw, speed, angle = state.tolist()
        return np.array(
            [
                speed * math.cos(yaw),
                speed * math.sin(yaw),
                speed * math.tan(angle) / LIMITS.wheelbase_m,
                min((speed_mps - speed) / plant.speed_lag_s, acceleration),
                min((angle_rad - angle) / plant.steering_lag_s, rate),
            ]
        )

    state, step = np.zeros(5), 1e-4
    for _ in range(round(until_s / step)):
        k1 = slopes(state)
        k2 = slopes(state + step / 2 * k1)
        k3 = slopes(state + step / 2 * k2)
        k4 = slopes(state + step * k3)
        state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    x_m, y_m, yaw_rad, _, _ = state.tolist()
    return x_m, y_m, yaw_rad


def test_a_slow_vehicle_drives_where_the_equations_of_the_bicycle_lead() -> None:
    plant = Plant(
        acceleration_mps2=2.0, steering_rate_radps=0.5, steering_lag_s=0.15, speed_lag_s=0.2
    )
    it = vehicle(plant)
    driven(it, DriveCommand(2.8, 0.3), 0.0, 3.0)
    x_m, y_m, yaw_rad = reference(2.8, 0.3, plant, 3.0)

    # Some 6 m of way and 1.1 rad; steps of 10 ms miss them by less than 0.2 mm and 0.2 mrad.
    assert it.state.pose.x_m == pytest.approx(x_m, abs=2e-4)
    assert it.state.pose.y_m == pytest.approx(y_m, abs=2e-4)
    assert it.state.pose.yaw_rad == pytest.approx(yaw_rad, abs=2e-4)


# --- noise ---------------------------------------------------------------------------------------


def test_noise_is_in_the_reports_and_not_in_how_the_vehicle_moves() -> None:
    it = vehicle(Plant(noise=Noise(position_m=0.1, yaw_rad=0.05, speed_mps=0.2, seed=1)))
    states = [report.state for report in it.advance(at(200.0))]

    assert it.state.pose == Pose(0.0, 0.0, 0.0)
    for values, deviation in (
        ([state.pose.x_m for state in states], 0.1),
        ([state.pose.y_m for state in states], 0.1),
        ([state.pose.yaw_rad for state in states], 0.05),
        ([state.speed_mps for state in states], 0.2),
    ):
        mean = sum(values) / len(values)
        spread = math.sqrt(sum((value - mean) ** 2 for value in values) / len(values))
        assert mean == pytest.approx(0.0, abs=deviation / 10)
        assert spread == pytest.approx(deviation, rel=0.1)


@pytest.mark.parametrize(
    ("noise", "differs"),
    [
        (Noise(position_m=0.1), (True, True, False, False)),
        (Noise(yaw_rad=0.1), (False, False, True, False)),
        (Noise(speed_mps=0.1), (False, False, False, True)),
        (Noise(), (False, False, False, False)),
    ],
)
def test_noise_is_added_to_what_it_is_of(noise: Noise, differs: tuple[bool, ...]) -> None:
    (report,) = vehicle(Plant(noise=noise)).advance(START)
    pose = report.state.pose

    values = (pose.x_m, pose.y_m, pose.yaw_rad, report.state.speed_mps)
    assert tuple(value != 0.0 for value in values) == differs


def test_the_same_seed_gives_the_same_noise_and_another_one_another() -> None:
    def reports(seed: int) -> tuple[VehicleReport, ...]:
        return vehicle(Plant(noise=Noise(position_m=0.1, seed=seed))).advance(at(1.0))

    assert reports(1) == reports(1)
    assert reports(1) != reports(2)


def test_noise_goes_on_where_it_was_when_nothing_was_reported_meanwhile() -> None:
    def places(it: SimulatedVehicle, until_s: float) -> list[float]:
        return [report.state.pose.x_m for report in it.advance(at(until_s))]

    heard, lost = (vehicle(Plant(noise=Noise(position_m=0.1, seed=1))) for _ in range(2))
    places(lost, 0.5)
    lost.set_reporting(False, at(0.5))
    lost.set_reporting(True, at(1.0))

    assert places(lost, 1.5) == places(heard, 1.0)[11:]


# --- at rest -------------------------------------------------------------------------------------


@pytest.mark.parametrize("plant", [Plant(), SLOW], ids=["ideal", "slow"])
def test_an_hour_at_rest_is_72000_reports_that_say_the_same(plant: Plant) -> None:
    it = vehicle(replace(plant, noise=Noise()))
    driven(it, DriveCommand(2.0, 0.3), 0.0, 2.0)
    it.advance(at(30.0))
    rest = it.state
    reports: list[VehicleReport] = []
    while it.wake_at() <= at(3630.0):
        reports += it.advance(it.wake_at())

    assert len(reports) == 72_000
    assert {report.state for report in reports} == {rest}
    assert rest.speed_mps == 0.0
