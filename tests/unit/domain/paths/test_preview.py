import math
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from domain.paths.path import Path
from domain.paths.preview import PathPreview, preview
from domain.paths.speed_profile import REACTION_S, SpeedLimits
from domain.vehicle import Pose, VehicleLimits
from tests.support.approach_limits import approach_limits
from tests.support.shared import shared_folder
from tests.support.tables import table

VEHICLE = VehicleLimits(wheelbase_m=1.75, max_steering_angle_rad=0.61, max_speed_mps=11.2)
TURNING_CIRCLE_M = 1.75 / math.tan(0.61)


def line(length_m: float, spacing_m: float = 0.5) -> NDArray[np.float64]:
    """Return waypoints along the x axis; shape (n, 3)."""
    x = np.linspace(0.0, length_m, round(length_m / spacing_m) + 1)
    return np.column_stack((x, np.zeros_like(x), np.zeros_like(x)))


def circle(radius_m: float, turn_rad: float = math.pi) -> NDArray[np.float64]:
    """Return waypoints of an arc to the left that begins at the origin along x; shape (n, 3)."""
    angles = np.linspace(0.0, turn_rad, round(radius_m * turn_rad / 0.3) + 1)
    return np.column_stack((radius_m * np.sin(angles), radius_m * (1 - np.cos(angles)), angles))


def seen(
    waypoints: NDArray[np.float64],
    cruise_mps: float = 2.8,
    pose: Pose | None = None,
    limits: SpeedLimits | None = None,
) -> PathPreview:
    return preview(Path(waypoints), cruise_mps, pose, approach_limits(VEHICLE, limits))


def codes(found: PathPreview) -> list[tuple[str, int | None]]:
    return [(warning.code, warning.index) for warning in found.warnings]


def test_a_straight_path_has_a_length_and_no_bend() -> None:
    found = seen(line(40.0))

    assert found.waypoint_count == 81
    assert found.length_m == pytest.approx(40.0)
    assert found.min_radius_m is None
    assert found.steerable
    assert found.warnings == ()


def test_distances_between_waypoints_are_told_as_they_are_given() -> None:
    waypoints = line(10.0, spacing_m=1.0)
    waypoints[4:, 0] += 2.0
    waypoints[-1] = waypoints[-2]
    spacing = seen(waypoints).spacing

    assert spacing.min_m == 0.0
    assert spacing.median_m == pytest.approx(1.0)
    assert spacing.max_m == pytest.approx(3.0)


def test_the_radius_is_that_of_the_tightest_bend() -> None:
    arc = circle(8.0, math.pi / 2)
    straight = np.column_stack((np.full(40, 8.0), 8.0 + np.arange(1, 41) * 0.5, np.zeros(40)))
    found = seen(np.vstack((arc, straight)))

    assert found.min_radius_m == pytest.approx(8.0, rel=0.02)
    assert found.steerable


def test_the_turning_circle_of_the_vehicle_is_told() -> None:
    assert seen(line(10.0)).vehicle_min_radius_m == pytest.approx(TURNING_CIRCLE_M)


def test_a_bend_that_the_vehicle_cannot_steer_is_told_with_its_place() -> None:
    straight = line(20.0)
    bend = circle(1.8, math.pi / 2)
    bend[:, 0] += 20.0
    found = seen(np.vstack((straight, bend[1:])))

    assert not found.steerable
    ((code, index),) = codes(found)
    assert code == "TOO_TIGHT"
    assert index is not None
    assert 38 <= index <= 50


def test_a_bend_that_the_vehicle_can_just_steer_is_no_fault() -> None:
    found = seen(circle(TURNING_CIRCLE_M * 1.02))

    assert found.steerable
    assert found.warnings == ()


def test_waypoints_far_apart_are_told_with_the_first_of_them() -> None:
    waypoints = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [9.0, 0.0, 0.0], [10.0, 0.0, 0.0]])

    assert codes(seen(waypoints)) == [("SPARSE", 1)]


def test_a_recording_that_stands_still_is_told() -> None:
    waypoints = np.vstack((np.zeros((30, 3)), line(10.0)))

    assert codes(seen(waypoints)) == [("STANDS_STILL", None)]
    assert codes(seen(np.vstack((np.zeros((5, 3)), line(10.0))))) == []


class Start(NamedTuple):
    """Where the vehicle is, and how far that is from the start of the path along x."""

    pose: Pose
    distance_m: float
    heading_error_rad: float
    warning: str | None = None


@table(
    {
        "at the start": Start(Pose(0.0, 0.0, 0.0), distance_m=0.0, heading_error_rad=0.0),
        "as far as it may be": Start(Pose(3.0, -4.0, 0.5), distance_m=5.0, heading_error_rad=0.5),
        "too far": Start(
            Pose(-3.1, -4.1, 0.5),
            distance_m=math.hypot(3.1, 4.1),
            heading_error_rad=0.5,
            warning="FAR_START",
        ),
        "turned away": Start(
            Pose(0.0, 1.0, -3.0), distance_m=1.0, heading_error_rad=-3.0, warning="TURNED_AWAY"
        ),
        "turned by more than once around": Start(
            Pose(0.0, 1.0, math.tau + 0.1), distance_m=1.0, heading_error_rad=0.1
        ),
    }
)
def test_the_start_is_compared_with_where_the_vehicle_is(row: Start) -> None:
    found = seen(line(10.0), pose=row.pose)

    assert found.start is not None
    assert found.start.distance_m == pytest.approx(row.distance_m)
    assert found.start.heading_error_rad == pytest.approx(row.heading_error_rad)
    assert codes(found) == ([(row.warning, 0)] if row.warning else [])


def test_of_a_vehicle_that_is_nowhere_nothing_is_said() -> None:
    assert seen(line(10.0)).start is None


def test_several_warnings_are_all_there() -> None:
    corner = np.array([[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0]])
    found = seen(corner, pose=Pose(-9.0, 0.0, 3.1))

    assert [code for code, _ in codes(found)] == ["TOO_TIGHT", "SPARSE", "FAR_START", "TURNED_AWAY"]


def test_a_straight_lasts_as_long_as_speeding_up_driving_and_braking() -> None:
    limits = SpeedLimits(acceleration_mps2=1.0, braking_mps2=2.0)
    # Braking is planned with 80 % of what is allowed, and begins so much before it has to.
    braking_s = 4.0 / 1.6
    expected_s = 4.0 + braking_s + (100.0 - 8.0 - 4.0 * braking_s / 2) / 4.0 + REACTION_S

    assert seen(line(100.0), 4.0, limits=limits).duration_s == pytest.approx(expected_s, abs=1.0)


def test_a_lap_of_the_gem_is_estimated_near_its_optimum() -> None:
    # The fastest lap with v <= 7 m/s, 2 m/s2 lateral and 1 m/s2 along takes 126.2 s.
    text = (shared_folder("tracks") / "gem_e2_loop.csv").read_text(encoding="utf-8")
    waypoints = np.array([[float(c) for c in row.split(",")[:3]] for row in text.split()])

    found = seen(waypoints, 7.0)

    assert found.length_m == pytest.approx(834.8, abs=2.0)
    assert found.duration_s == pytest.approx(128.0, abs=3.0)
    assert found.steerable


def test_curves_cost_time() -> None:
    straight, curve = line(math.pi * 20.0), circle(20.0)

    # sqrt(0.5 m/s2 * 20 m) = 3.2 m/s instead of 8 m/s.
    limits = SpeedLimits(lateral_acceleration_mps2=0.5)
    assert seen(straight, 8.0, limits=limits).duration_s == pytest.approx(17.0, abs=1.0)
    assert seen(curve, 8.0, limits=limits).duration_s == pytest.approx(23.5, abs=1.0)


@given(
    st.floats(0.05, 200.0),
    st.floats(0.2, 20.0),
    st.floats(0.1, 5.0),
    st.floats(0.1, 5.0),
)
def test_a_duration_is_never_shorter_than_the_way_at_full_speed(
    length_m: float, cruise_mps: float, acceleration_mps2: float, braking_mps2: float
) -> None:
    waypoints = line(length_m, spacing_m=length_m / 10)
    limits = SpeedLimits(2.0, acceleration_mps2, braking_mps2)
    duration = seen(waypoints, cruise_mps, limits=limits).duration_s

    assert duration >= length_m / min(cruise_mps, VEHICLE.max_speed_mps) * 0.999
    assert math.isfinite(duration)


def test_warnings_say_how_much_in_words() -> None:
    corner = np.array([[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [8.0, 8.0, 0.0]])
    found = seen(np.vstack((np.zeros((11, 3)), corner)), pose=Pose(-9.0, 0.0, 3.1))
    words = [warning.message for warning in found.warnings]

    assert words[0].startswith("a bend of ")
    assert words[0].endswith(" m radius; the vehicle needs 2.5 m and will leave the path there")
    assert words[1:] == [
        "8.0 m between two waypoints; the path is straight in between",
        "11 waypoints are at the position of the one before",
        "the path begins 9.0 m from the vehicle, and is approached from at most 5 m",
        "the vehicle faces away from the direction of the path",
    ]


def test_what_is_exactly_at_a_limit_is_no_warning() -> None:
    waypoints = np.vstack((np.zeros((10, 3)), line(10.0, spacing_m=5.0)))

    assert codes(seen(waypoints, pose=Pose(0.0, 0.0, math.pi / 2))) == []


def test_a_start_is_judged_where_it_is_and_not_from_the_origin() -> None:
    waypoints = line(10.0)
    waypoints[:, 0] += 3.0
    waypoints[:, 1] += 7.0
    found = seen(waypoints, pose=Pose(2.0, 5.0, 0.25))

    assert found.start is not None
    assert found.start.distance_m == pytest.approx(math.hypot(1.0, 2.0))


def test_the_heading_error_is_that_against_where_the_path_begins() -> None:
    bent = circle(20.0, math.pi / 2)
    turned = np.column_stack((-bent[:, 1], bent[:, 0], bent[:, 2]))
    found = seen(turned, pose=Pose(0.0, 0.0, math.pi / 2 + 0.3))

    assert found.start is not None
    assert found.start.heading_error_rad == pytest.approx(0.3, abs=0.03)


def test_a_place_of_few_metres_is_looked_at_finely_enough_to_see_its_bend() -> None:
    found = seen(np.vstack((line(3.0), np.array([[3.0, 0.5, 0.0], [3.0, 3.0, 0.0]]))))

    assert not found.steerable


def test_a_short_way_takes_the_time_to_speed_up_and_brake() -> None:
    limits = SpeedLimits(acceleration_mps2=0.5, braking_mps2=0.5)

    assert seen(line(10.0), 8.0, limits=limits).duration_s == pytest.approx(9.7, abs=1.0)
