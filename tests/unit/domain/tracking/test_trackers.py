"""What holds for every tracker, on any path that can be driven and on many that cannot."""

from math import cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.errors import InvalidValueError
from domain.paths.path import WINDOW_M, Path
from domain.tracking.trackers import TRACKERS
from domain.vehicle import Pose, VehicleLimits, VehicleState
from tests.support.track_study import LIMITS, PLANTS, beside_start, drive, figures

controllers = st.sampled_from(sorted(TRACKERS))
plants = st.sampled_from(sorted(PLANTS))
offsets = st.tuples(st.floats(0, 3), st.floats(-pi, pi)).map(
    lambda polar: (polar[0] * cos(polar[1]), polar[0] * sin(polar[1]))
)


def winding(bends: list[tuple[float, float]], spacing: float) -> Path:
    """Return a path of arcs that begins eastwards at the origin.

    Args:
        bends: Curvature, 1/m, and length, m, of each arc.
        spacing: Distance of its waypoints, m.
    """
    ends = np.cumsum([length for _, length in bends])
    at = np.linspace(0, ends[-1], max(round(ends[-1] / 0.01), 2))
    curvature = np.array([c for c, _ in bends])[np.searchsorted(ends[:-1], at, side="right")]
    step = at[1]
    yaw = np.cumsum(curvature) * step
    places = np.cumsum(np.column_stack((np.cos(yaw), np.sin(yaw))) * step, axis=0)
    chosen = np.unique(np.append(np.arange(0, len(at), max(round(spacing / step), 1)), len(at) - 1))
    return Path(np.column_stack((places, yaw))[chosen])


drivable = st.builds(
    winding,
    st.lists(st.tuples(st.floats(-0.12, 0.12), st.floats(3, 15)), min_size=1, max_size=5),
    st.sampled_from([0.02, 0.25, 1.0, 3.0]),
)


@given(drivable, controllers, plants, offsets, st.floats(-0.5, 0.5), st.floats(0.5, 7))
def test_a_vehicle_that_begins_nearby_is_steered_along_all_of_the_path(
    path: Path,
    controller: str,
    plant: str,
    offset: tuple[float, float],
    turned: float,
    speed: float,
) -> None:
    begin = beside_start(path, 0.0)
    start = Pose(begin.x_m + offset[0], begin.y_m + offset[1], begin.yaw_rad + turned)

    record = drive(path, controller, PLANTS[plant], start, speed, time_limit_s=25)

    assert np.isfinite(record.commanded_rad).all()
    assert np.abs(record.commanded_rad).max() <= LIMITS.max_steering_angle_rad
    assert (np.diff(record.target_index) >= 0).all()
    assert record.distance_m[0] <= 3.0 + 0.5
    # On the inside of the tightest bend, 3 m off, a metre driven is 1.6 m of the path; where
    # waypoints are 3 m apart, the bend is a corner, and passed with a step of up to 1.1 m.
    gained, driven = np.diff(record.distance_m), np.diff(record.driven_m)
    assert (gained <= 2 * driven + 1.2).all()
    assert gained.sum() <= 2 * driven.sum() + 1.2


@given(
    st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9)), min_size=2, max_size=12),
    controllers,
    st.tuples(st.floats(-20, 20), st.floats(-20, 20), st.floats(-pi, pi)),
    st.floats(-2, 11),
    st.floats(-0.61, 0.61),
    st.integers(0, 11),
)
def test_whatever_the_path_and_the_vehicle_the_steering_is_possible(
    places: list[tuple[float, float]],
    controller: str,
    pose: tuple[float, float, float],
    speed: float,
    steering: float,
    index: int,
) -> None:
    try:
        path = Path(np.array([(x, y, 0.0) for x, y in places]))
    except InvalidValueError:
        return
    index = min(index, path.count - 1)
    state = VehicleState(Pose(*pose), speed, steering)

    said = TRACKERS[controller](VehicleLimits()).control_step(state, path, index)

    assert abs(said.steering_angle_rad) <= LIMITS.max_steering_angle_rad
    assert index <= said.target_index < path.count
    assert path.distance_of(max(index - 1, 0)) <= said.distance_m <= path.length_m
    assert abs(said.cross_track_error_m) < 100
    assert hypot(said.lookahead.x_m, said.lookahead.y_m) < 100


@given(drivable, controllers, st.floats(0, 1), offsets)
def test_a_vehicle_that_was_moved_by_hand_goes_on_where_it_was_put(
    path: Path, controller: str, share: float, offset: tuple[float, float]
) -> None:
    before = share * path.length_m
    place, yaw = path.point_at(before), path.heading_at(before)
    moved = Pose(place.x_m + offset[0], place.y_m + offset[1], yaw)
    index, distance = path.index_after(before), before

    for _ in range(50):
        said = TRACKERS[controller](LIMITS).control_step(VehicleState(moved, 0.0, 0.0), path, index)
        index, distance = said.target_index, said.distance_m

    # Moved by 3 m, also towards the middle of the tightest bend.
    assert distance - before <= 6.0


@pytest.mark.parametrize("controller", sorted(TRACKERS))
@pytest.mark.parametrize("plant", sorted(PLANTS))
@pytest.mark.parametrize("length", [0.3, 1.0, 2.0, 5.0])
def test_a_path_shorter_than_any_look_ahead_is_driven_to_its_end(
    controller: str, plant: str, length: float
) -> None:
    short = Path(np.array([[1.0, 1.0, 0.0], [1.0 + 0.6 * length, 1.0 + 0.8 * length, 0.0]]))

    found = figures(drive(short, controller, PLANTS[plant]))

    assert found["done"]
    assert found["covered"] > 0.95
    assert found["end_m"] <= 0.3


@pytest.mark.parametrize("controller", sorted(TRACKERS))
@pytest.mark.parametrize("plant", sorted(PLANTS))
def test_the_same_length_of_a_crossing_path_is_driven_as_it_is_long(
    controller: str, plant: str
) -> None:
    t = np.linspace(0, 2 * pi, 400)
    eight = Path(np.column_stack((60 * np.sin(t), 30 * np.sin(2 * t), t)))

    record = drive(eight, controller, PLANTS[plant])

    assert record.result is not None
    assert record.result.succeeded
    assert record.driven_m[-1] == pytest.approx(eight.length_m, rel=0.02)


@pytest.mark.parametrize("controller", sorted(TRACKERS))
def test_a_vehicle_that_is_put_aside_in_a_hairpin_stays_on_its_way_out(controller: str) -> None:
    # 20 m out, half a circle of 4 m, 20 m back: 8 m beside.
    hairpin = winding([(0.0, 20.0), (0.25, 4 * pi), (0.0, 20.0)], 0.25)
    index = hairpin.index_after(15.0)
    tracker = TRACKERS[controller](LIMITS)

    for _ in range(100):
        said = tracker.control_step(VehicleState(Pose(15.0, 3.0, 0.0), 0.0, 0.0), hairpin, index)
        index = said.target_index

    assert said.distance_m == pytest.approx(15.0, abs=WINDOW_M / 10)
