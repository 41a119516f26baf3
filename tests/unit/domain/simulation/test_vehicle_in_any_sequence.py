"""What holds of the simulated vehicle whatever it is told, and whenever."""

import math
import pickle
from collections.abc import Sequence
from itertools import pairwise
from typing import TypeAlias

from hypothesis import given, settings
from hypothesis import strategies as st

from domain.inputs import VehicleReport
from domain.simulation.vehicle import REPORT_PERIOD, SimulatedVehicle
from domain.simulation.vehicle_settings import Noise, Plant, VehicleSettings
from domain.timebase import Instant, seconds, to_seconds
from domain.vehicle import DriveCommand, Pose, VehicleLimits

START = seconds(50.0) + 3
LIMITS = VehicleLimits()
END = seconds(3.0)

Act: TypeAlias = tuple[int, DriveCommand | bool | None]
"""When in ns since the start, and what: a command, whether to report, or just a look."""

ODD_TIMES = st.integers(0, END) | st.integers(0, 60).map(lambda n: n * REPORT_PERIOD)
NUMBERS = st.floats(-15.0, 15.0) | st.sampled_from([math.nan, math.inf, -math.inf, 0.0, -0.0])
ANGLES = st.floats(-0.8, 0.8) | st.sampled_from([math.nan, math.inf])
COMMANDS = st.builds(DriveCommand, NUMBERS, ANGLES)
SCRIPTS = st.lists(st.tuples(ODD_TIMES, COMMANDS | st.booleans()), max_size=10).map(
    lambda script: sorted(script, key=lambda act: act[0])
)
LOOKS = st.lists(ODD_TIMES, max_size=20)
PLANTS = st.builds(
    Plant,
    acceleration_mps2=st.none() | st.floats(0.1, 5.0),
    braking_mps2=st.none() | st.floats(0.1, 5.0),
    steering_rate_radps=st.none() | st.floats(0.05, 2.0),
    steering_lag_s=st.just(0.0) | st.floats(0.01, 1.0),
    speed_lag_s=st.just(0.0) | st.floats(0.01, 1.0),
    delay=st.just(0) | st.integers(0, seconds(0.7)),
    noise=st.just(Noise()) | st.just(Noise(0.02, 0.01, 0.05, seed=7)),
)


def vehicle(plant: Plant, start: Instant = START) -> SimulatedVehicle:
    return SimulatedVehicle(VehicleSettings(Pose(1.0, -2.0, 3.0), plant), start)


def play(
    it: SimulatedVehicle, script: Sequence[Act], until: int, start: Instant = START
) -> list[VehicleReport]:
    """Do what is scripted, and return what was reported until the end."""
    reports: list[VehicleReport] = []
    for at, act in script:
        if act is None:
            reports += it.advance(start + at)
        elif isinstance(act, bool):
            it.set_reporting(act, start + at)
        else:
            it.drive(act, start + at)
    return reports + list(it.advance(start + until))


@given(plant=PLANTS, script=SCRIPTS, looks=LOOKS)
def test_it_makes_no_difference_how_often_one_looks(
    plant: Plant, script: list[Act], looks: list[int]
) -> None:
    seldom, often = vehicle(plant), vehicle(plant)
    looked: list[Act] = [*script, *((at, None) for at in looks)]
    # A stable order: what is scripted for an instant comes before a look at it.
    looked.sort(key=lambda act: act[0])

    assert play(often, looked, END) == play(seldom, script, END)
    assert often.state == seldom.state
    assert often.command == seldom.command


@settings(max_examples=50)
@given(plant=PLANTS, script=SCRIPTS)
def test_it_makes_no_difference_to_look_at_an_instant_before_something_is_told_then(
    plant: Plant, script: list[Act]
) -> None:
    looked = [part for act in script for part in ((act[0], None), act)]

    assert play(vehicle(plant), looked, END) == play(vehicle(plant), script, END)


@settings(max_examples=50)
@given(plant=PLANTS, script=SCRIPTS, later=st.integers(0, 10**15))
def test_it_makes_no_difference_when_it_all_begins(
    plant: Plant, script: list[Act], later: int
) -> None:
    some_day = vehicle(plant, START + later)

    assert play(some_day, script, END, START + later) == play(vehicle(plant), script, END)


@given(plant=PLANTS, before=SCRIPTS, after=SCRIPTS, half_way=st.integers(0, END))
def test_a_copy_made_half_way_goes_on_like_the_original(
    plant: Plant, before: list[Act], after: list[Act], half_way: int
) -> None:
    it = vehicle(plant)
    play(it, [act for act in before if act[0] <= half_way], half_way)
    copied: SimulatedVehicle = pickle.loads(pickle.dumps(it))
    later = [act for act in after if act[0] >= half_way]

    assert play(copied, later, END) == play(it, later, END)
    assert copied.state == it.state


@settings(max_examples=50)
@given(plant=PLANTS, script=SCRIPTS)
def test_it_wants_to_be_woken_exactly_when_there_is_something_to_report(
    plant: Plant, script: list[Act]
) -> None:
    it = vehicle(plant)
    times = []
    for at, act in [*script, (END, None)]:
        while it.wake_at() <= START + at:
            due = it.wake_at()
            it.advance(due)
            assert it.wake_at() > due
            times.append(due - START)
        play(it, [(at, act)], at)

    assert times == [n * REPORT_PERIOD for n in range(61)]


@given(plant=PLANTS, script=SCRIPTS)
def test_no_vehicle_does_what_it_cannot(plant: Plant, script: list[Act]) -> None:
    it = vehicle(plant)
    states = [it.state]
    for number in range(1, 61):
        due = [act for act in script if (number - 1) * REPORT_PERIOD <= act[0]]
        play(it, [act for act in due if act[0] < number * REPORT_PERIOD], number * REPORT_PERIOD)
        states.append(it.state)
    period_s = to_seconds(REPORT_PERIOD)
    slack = 1e-5
    faster, turning = plant.acceleration_mps2, plant.steering_rate_radps

    for before, after in pairwise(states):
        assert all(map(math.isfinite, (after.pose.x_m, after.pose.y_m, after.pose.yaw_rad)))
        assert abs(after.pose.yaw_rad) <= math.pi
        assert abs(after.speed_mps) <= LIMITS.max_speed_mps
        assert abs(after.steering_angle_rad) <= LIMITS.max_steering_angle_rad
        gained = abs(after.speed_mps) - abs(before.speed_mps)
        if faster is not None and after.speed_mps * before.speed_mps > 0:
            assert gained <= faster * period_s + slack
        if plant.braking_mps2 is not None:
            assert -gained <= plant.braking_mps2 * period_s + slack
        turned = abs(after.steering_angle_rad - before.steering_angle_rad)
        assert turning is None or turned <= turning * period_s + slack
        way = math.hypot(after.pose.x_m - before.pose.x_m, after.pose.y_m - before.pose.y_m)
        assert way <= LIMITS.max_speed_mps * period_s + slack


@settings(max_examples=50)
@given(plant=PLANTS, script=SCRIPTS)
def test_every_vehicle_stands_in_the_end_when_it_hears_nothing_more(
    plant: Plant, script: list[Act]
) -> None:
    it = vehicle(plant)
    play(it, script, END)
    # 11.2 m/s at 0.1 m/s2, and 15 time constants of a second.
    it.advance(START + seconds(150.0))
    rest = it.state
    it.advance(START + seconds(160.0))

    assert rest.speed_mps == 0.0
    assert it.state == rest
    assert it.command.speed_mps == 0.0
