"""Whole drives: stops, bends that slow wheels cannot follow, starts beside the path, any size."""

from itertools import pairwise
from math import cos, pi, sin

import numpy as np
import pytest

from domain.paths.path import Path
from domain.simulation.vehicle_settings import Plant
from domain.snapshot import TaskPhase
from domain.timebase import seconds
from domain.tracking.trackers import TRACKERS
from domain.vehicle import Point, Pose, VehicleLimits
from tests.support.drives import Trip, through
from tests.support.track_study import PLANTS, track

EVERY_TRACKER = pytest.mark.parametrize("controller", sorted(TRACKERS))
SLOW_WHEELS = Plant(2.0, 3.0, 0.5, 0.15, delay=seconds(0.05))


def shifted(path: Path, x_m: float, y_m: float) -> Path:
    return Path(path.waypoints + np.array([x_m, y_m, 0.0]))


def arena(wheelbase_m: float) -> Path:
    """Return a closed course, as large as a vehicle needs it: straights, bends and a chicane."""
    size = wheelbase_m / 1.75
    t = np.linspace(0, 1, 80)
    a = np.linspace(0, pi, 60)
    straight = np.column_stack((25 * t, 0 * t))
    bend = np.column_stack((25 + 6 * np.sin(a), 6 - 6 * np.cos(a)))
    chicane = np.column_stack((25 - 25 * t, 12 + 1.8 * np.sin(2 * pi * t)))
    back = np.column_stack((-6 * np.sin(a[:-4]), 6 + 6 * np.cos(a[:-4])))
    places = np.concatenate((straight, bend[1:], chicane[1:], back[1:])) * size
    return Path(np.column_stack((places, np.zeros(len(places)))))


# --- stops ---------------------------------------------------------------------------------------


def test_what_a_held_vehicle_rolls_over_is_driven() -> None:
    """From 5 m/s it rolls 12.5 m; waypoints are 29 m apart."""
    trip = Trip(through((0, 0), (30, 0), (59, 0)), "pure_pursuit", 5.0, Plant(braking_mps2=1.0))
    trip.drive(7.0)
    trip.hold()
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason


@pytest.mark.parametrize("braking_mps2", [0.3, 1.0])
@pytest.mark.parametrize("at_s", np.arange(8.0, 15.0, 0.9).tolist())
def test_a_hold_near_the_end_does_not_keep_a_task_from_succeeding(
    at_s: float, braking_mps2: float
) -> None:
    """It may roll past the end."""
    plant = Plant(braking_mps2=braking_mps2)
    trip = Trip(through((0, 0), (30, 0), (59, 0)), "pure_pursuit", 5.0, plant)
    trip.drive(at_s)
    trip.hold()
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason


@EVERY_TRACKER
def test_any_number_of_holds_on_a_closed_course_adds_up_to_nothing(controller: str) -> None:
    trip = Trip(arena(1.75), controller, 5.0, Plant(1.0, 1.0, 0.5, 0.15))
    held = 0
    while not trip.ended:
        trip.drive(4.0)
        trip.hold()
        held += 1

    assert held > 5
    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason
    assert trip.largest_error_m() < 0.5


@pytest.mark.parametrize("spacing_m", [0.2, 20.0])
@pytest.mark.parametrize("lost_s", [0.4, 2.0, 30.0])
def test_what_a_vehicle_rolls_over_while_its_pose_is_lost_is_driven(
    lost_s: float, spacing_m: float
) -> None:
    """The hold of a lost pose stops it; from 5 m/s it rolls 15 m unseen."""
    x = np.arange(0.0, 60.0, spacing_m)
    path = Path(np.column_stack((x, 0 * x, 0 * x)))
    trip = Trip(path, "pure_pursuit", 5.0, Plant(braking_mps2=1.0))
    trip.drive(6.0)
    trip.robot.lose_pose()
    trip.robot.advance(lost_s)
    trip.robot.lose_pose(lost=False)
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason
    assert trip.largest_error_m() < 0.1


@EVERY_TRACKER
def test_a_vehicle_that_is_held_in_a_bend_brakes_along_its_path(controller: str) -> None:
    """With the wheels held it would leave an s-bend while it rolls."""
    x = np.arange(0.0, 90.0, 0.5)
    bends = Path(np.column_stack((x, 4 * np.sin(x / 8), np.zeros_like(x))))
    trip = Trip(bends, controller, 5.0, Plant(1.0, 0.4), bends_start(bends))
    for _ in range(3):
        trip.drive(8.0)
        trip.hold()
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason
    assert trip.largest_error_m() < 0.5


def bends_start(path: Path) -> Pose:
    place = path.point_at(0.0)
    return Pose(place.x_m, place.y_m, path.heading_at(0.0))


# --- speed and error -----------------------------------------------------------------------------


@EVERY_TRACKER
def test_two_corners_are_driven_as_slowly_as_the_wheels_turn(controller: str) -> None:
    trip = Trip(through((0, 0), (40, 0), (40, 3), (120, 3)), controller, 8.0, SLOW_WHEELS)
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason
    assert trip.lateral_mps2() <= 2.0 + 1e-6
    assert trip.largest_error_m() < 2.0
    grown = [
        after.speed_mps - before.speed_mps
        for before, after in pairwise(trip.looks)
        if abs(after.error_m) > max(0.3, abs(before.error_m))
    ]
    assert max(grown) <= 0.0


# --- approach ------------------------------------------------------------------------------------


@EVERY_TRACKER
@pytest.mark.parametrize("yaw_rad", [0.0, pi / 2, pi, -pi / 2])
def test_a_path_3_5_m_beside_is_approached_slowly_and_driven(
    controller: str, yaw_rad: float
) -> None:
    trip = Trip(through((0, 3.5), (50, 3.5), (100, 3.5)), controller, start=Pose(0.0, 0.0, yaw_rad))
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason
    beside = next(n for n, look in enumerate(trip.looks) if abs(look.error_m) <= 0.5)
    assert max(look.speed_mps for look in trip.looks[:beside]) <= 1.0


@pytest.mark.parametrize("speed_mps", [2.8, 8.0])
@pytest.mark.parametrize("turn_rad", [0.0, pi / 4, pi / 2, pi])
@pytest.mark.parametrize("plant", sorted(PLANTS))
def test_a_task_that_replaces_one_at_speed_brakes_before_it_turns(
    plant: str, turn_rad: float, speed_mps: float
) -> None:
    trip = Trip(through((0, 0), (50, 0), (300, 0)), speed_mps=speed_mps, plant=PLANTS[plant])
    trip.drive(12.0)
    here = trip.robot.robot.vehicle.state.pose
    begin = (here.x_m - 3.5 * sin(turn_rad), here.y_m + 3.5 * cos(turn_rad))
    end = (begin[0] + 60 * cos(turn_rad), begin[1] + 60 * sin(turn_rad))
    trip.robot.submit_task(through(begin, end), controller="stanley", speed_mps=speed_mps)
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason
    assert trip.lateral_mps2() <= 2.0 + 1e-6


def test_a_hold_while_it_brakes_before_an_approach_changes_nothing() -> None:
    trip = Trip(through((0, 0), (300, 0)), speed_mps=8.0, plant=PLANTS["gazebo-like"])
    trip.drive(12.0)
    here = trip.robot.robot.vehicle.state.pose
    new = through((here.x_m, 0.0), (here.x_m, 60.0))
    trip.robot.submit_task(new, controller="stanley", speed_mps=2.8)
    for _ in range(4):
        trip.drive(0.5)
        trip.hold(0.2)
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason


def test_a_vehicle_whose_wheels_are_stuck_gives_up_with_the_reason() -> None:
    stuck = Plant(steering_rate_radps=1e-6)
    trip = Trip(through((0, 3.5), (50, 3.5), (100, 3.5)), plant=stuck, start=Pose(0.0, 0.0, pi))
    trip.drive()

    assert trip.robot.task.status is TaskPhase.ABORTED
    assert trip.robot.task.reason is not None
    assert "its way onto the path" in trip.robot.task.reason


def test_a_vehicle_that_stands_too_far_ahead_of_a_short_path_drives_back_to_its_start() -> None:
    trip = Trip(through((0, 0), (5, 0), (10, 0)), start=Pose(5.0, 0.0, 0.0))
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason


def test_a_held_vehicle_that_was_carried_away_is_not_let_loose_across_the_field() -> None:
    trip = Trip(through((0, 0), (50, 0), (100, 0)))
    trip.drive(6.0)
    trip.robot.hold()
    trip.robot.advance(5.0)
    vehicle = trip.robot.robot.vehicle
    moved = Pose(vehicle.state.pose.x_m, 15.0, 0.0)
    vehicle._state = type(vehicle.state)(moved, 0.0, 0.0)  # noqa: SLF001 - carried by hand
    trip.robot.advance(0.2)
    trip.robot.release()

    assert trip.robot.task.status is TaskPhase.ABORTED
    told = trip.robot.task.reason
    assert told == "15.0 m from where the path goes on, which is approached from at most 5 m"


def test_a_held_vehicle_that_was_carried_along_its_path_does_not_drive_all_the_way_back() -> None:
    trip = Trip(through((0, 0), (2000, 0), (4000, 0)))
    trip.drive(6.0)
    trip.robot.hold()
    trip.robot.advance(5.0)
    vehicle = trip.robot.robot.vehicle
    stood_m = vehicle.state.pose.x_m
    vehicle._state = type(vehicle.state)(Pose(stood_m + 1500, 0.0, 0.0), 0.0, 0.0)  # noqa: SLF001
    trip.robot.advance(0.2)
    trip.robot.release()

    assert trip.robot.task.status is TaskPhase.ABORTED
    assert str(trip.robot.task.reason).startswith("1500.0 m from where the path goes on")


def test_a_pose_that_jumps_by_kilometres_is_not_searched_for_along_the_path(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    trip = Trip(through((0, 0), (50_000, 0), (100_000, 0)))
    trip.drive(6.0)
    trip.robot.hold()
    trip.robot.advance(5.0)
    vehicle = trip.robot.robot.vehicle
    vehicle._state = type(vehicle.state)(Pose(90_000.0, 0.0, 0.0), 0.0, 0.0)  # noqa: SLF001
    trip.robot.advance(0.2)
    judged: list[float] = []
    point_at = Path.point_at

    def judge(path: Path, distance_m: float) -> Point:
        judged.append(distance_m)
        return point_at(path, distance_m)

    monkeypatch.setattr(Path, "point_at", judge)
    trip.robot.release()

    assert trip.robot.task.status is TaskPhase.ABORTED
    assert len(judged) < 100


# --- far from the origin -------------------------------------------------------------------------


@EVERY_TRACKER
@pytest.mark.parametrize("there", [(303_628.48, 3_900_696.88), (5e6, -5e6), (-1e7 + 200, 9.9e6)])
def test_a_path_far_from_the_origin_is_driven_alike(
    controller: str, there: tuple[float, float]
) -> None:
    x = np.arange(0.0, 40.0, 0.1)
    path = Path(np.column_stack((x, 3 * np.sin(x / 6), np.zeros_like(x))))
    plant = PLANTS["gazebo-like"]
    here = Trip(path, controller, start=Pose(0.0, 1.0, 0.4), plant=plant)
    far = Trip(
        shifted(path, *there), controller, start=Pose(there[0], there[1] + 1.0, 0.4), plant=plant
    )
    here.drive()
    far.drive()

    assert far.robot.task.status is TaskPhase.SUCCEEDED, far.robot.task.reason
    assert len(far.looks) == len(here.looks)
    assert far.places == pytest.approx(here.places + np.array(there), abs=1e-6)
    for one, other in zip(here.looks, far.looks, strict=True):
        assert other.speed_mps == pytest.approx(one.speed_mps, abs=1e-6)
        assert other.commanded_rad == pytest.approx(one.commanded_rad, abs=1e-6)


@pytest.mark.parametrize("yaw_rad", [0.0, pi / 2, pi, -pi / 2])
def test_a_path_at_the_edge_of_the_range_is_approached_from_beyond_it(yaw_rad: float) -> None:
    edge = 1e7
    places = ((edge - 30.0, edge), (edge, edge))
    trip = Trip(through(*places), start=Pose(edge - 30.0, edge - 2.0, yaw_rad))
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason


@pytest.mark.parametrize("x_m", [1e7, 1e15, -1e300])
def test_a_pose_that_jumps_anywhere_ends_the_task_with_a_reason(x_m: float) -> None:
    trip = Trip(through((0, 0), (50, 0), (100, 0)))
    trip.drive(6.0)
    vehicle = trip.robot.robot.vehicle
    vehicle._state = type(vehicle.state)(Pose(x_m, x_m, 0.0), 0.0, 0.0)  # noqa: SLF001
    trip.hold()
    trip.drive()

    assert trip.robot.task.status is TaskPhase.ABORTED
    assert trip.robot.task.reason


# --- any size ------------------------------------------------------------------------------------


@EVERY_TRACKER
@pytest.mark.parametrize("wheelbase_m", [0.175, 0.33, 0.6, 1.0, 1.75, 3.0, 6.0])
@pytest.mark.parametrize("plant", [Plant(), Plant(3.0, 3.0, 1.5, 0.05)], ids=["ideal", "late"])
def test_a_vehicle_of_any_size_follows_a_course_of_its_size(
    controller: str, wheelbase_m: float, plant: Plant
) -> None:
    course = arena(wheelbase_m)
    cruise_mps = 2.8 * (wheelbase_m / 1.75) ** 0.5
    limits = VehicleLimits(wheelbase_m=wheelbase_m)
    trip = Trip(course, controller, cruise_mps, plant, limits=limits)
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason
    assert trip.largest_error_m() <= 0.25 * wheelbase_m
    assert trip.lateral_mps2() <= 2.0 + 1e-6


@EVERY_TRACKER
@pytest.mark.parametrize("speed_mps", [0.5, 2.0, 5.0])
@pytest.mark.parametrize("name", ["gem_e2_loop", "gem_e2_real_loop_compass_heading"])
def test_a_vehicle_of_1_to_10_follows_a_recorded_track_of_1_to_10(
    name: str, speed_mps: float, controller: str
) -> None:
    """With the look-ahead of a car it would be off by 1.4 to 2.4 m, and still succeed."""
    recorded = track(f"tracks/{name}.csv").waypoints
    small = Path((recorded - recorded[0]) * np.array([0.1, 0.1, 1.0]))
    limits = VehicleLimits(wheelbase_m=0.33)
    start = Pose(0.0, 0.0, small.for_vehicle(limits).heading_at(0.0))
    trip = Trip(small, controller, speed_mps, Plant(3.0, 3.0, 3.2, 0.05), start, limits)
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason
    assert trip.largest_error_m() < 0.1


@EVERY_TRACKER
def test_a_small_vehicle_that_is_off_its_track_is_given_up(controller: str) -> None:
    """A 1:10 track is about 1.2 m wide, so that 3 m beside it would tell nothing."""
    late = Plant(steering_lag_s=5.0)
    places = through((0, 0), (3, 0), (3, 3), (0, 3), (0, 0.3))
    trip = Trip(places, controller, 3.0, late, limits=VehicleLimits(wheelbase_m=0.33))
    trip.drive()

    assert trip.robot.task.status is TaskPhase.ABORTED
    assert trip.robot.task.reason == "0.6 m from the path for 1 s"


def test_a_small_vehicle_passes_a_hairpin_in_order() -> None:
    """The legs are 1.2 m apart: the other one is never taken for the one it is on."""
    a = np.linspace(-pi / 2, pi / 2, 30)
    places = [(x, 0.0) for x in np.arange(0.0, 4.0, 0.1)]
    places += [(4 + 0.6 * cos(t), 0.6 + 0.6 * sin(t)) for t in a.tolist()]
    places += [(x, 1.2) for x in np.arange(4.0, 0.0, -0.1)]
    trip = Trip(through(*places), limits=VehicleLimits(wheelbase_m=0.33), speed_mps=1.5)
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason
    assert trip.largest_error_m() < 0.1
