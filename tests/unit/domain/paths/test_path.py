import pickle
from math import cos, hypot, nan, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from domain.errors import InvalidValueError
from domain.paths.path import SPACING_M, WINDOW_M, Path
from domain.vehicle import Point, VehicleLimits


def path(*places: tuple[float, float]) -> Path:
    return Path(np.array([(x, y, 0.0) for x, y in places]))


def arc(radius: float, angle: float, step: float = 0.25) -> NDArray[np.float64]:
    """Return a bend to the left that begins eastwards at the origin; shape (n, 2)."""
    along = np.linspace(0, angle, round(radius * angle / step) + 1)
    return radius * np.column_stack((np.sin(along), 1 - np.cos(along)))


def path_of(places: NDArray[np.float64]) -> Path:
    return Path(np.column_stack((places, np.zeros(len(places)))))


LINE = path((0, 0), (10, 0), (20, 0))
CORNER = path((0, 0), (20, 0), (20, 20))
OUT_AND_BACK = path((0, 0), (10, 0), (20, 0), (10, 0), (0, 0))
BEND = path_of(arc(20, pi))


# --- what a path is ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("waypoints", "said"),
    [
        (np.zeros((5, 2)), "shape"),
        (np.zeros(3), "shape"),
        (np.zeros((1, 3)), "2 to 100000 waypoints, not 1"),
        (np.zeros((0, 3)), "2 to 100000 waypoints, not 0"),
        (np.array([[0, 0, 0], [nan, 0, 0]]), "x_m must be finite"),
        (np.array([[0, 0, nan], [1, 0, 0]]), "yaw_rad must be finite"),
        (np.array([[0, 0, 0], [1e200, 0, 0]]), r"within \+-10,000,000 m"),
        (np.ones((9, 3)), "same position"),
    ],
)
def test_waypoints_that_are_no_path_are_refused(waypoints: NDArray[np.float64], said: str) -> None:
    with pytest.raises(InvalidValueError, match=said):
        Path(waypoints)


def test_a_waypoint_that_is_not_finite_is_pointed_at() -> None:
    with pytest.raises(InvalidValueError) as caught:
        Path(np.array([[0, 0, 0], [1, 0, 0], [2, nan, 0]]))

    assert caught.value.pointer == "/waypoints/2/y_m"


def test_a_path_does_not_change_with_what_it_was_made_of() -> None:
    waypoints = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    line = Path(waypoints)
    waypoints[1, 0] = 5.0

    assert line.waypoints[1, 0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        line.waypoints[1, 0] = 5.0


def test_a_path_is_the_same_in_another_process() -> None:
    sent = pickle.loads(pickle.dumps(BEND))

    assert np.array_equal(sent.waypoints, BEND.waypoints)
    assert sent.length_m == BEND.length_m
    assert sent.project(3.0, 1.0, 5) == BEND.project(3.0, 1.0, 5)


def test_a_copy_of_a_path_is_seen_as_by_the_same_vehicle() -> None:
    """A simulation that goes on with a copy of a small vehicle smooths its bends no more."""
    small = BEND.for_vehicle(VehicleLimits(wheelbase_m=0.33))
    sent = pickle.loads(pickle.dumps(small))

    assert sent.heading_at(3.0) == small.heading_at(3.0) != BEND.heading_at(3.0)


def test_distances_are_those_along_the_line() -> None:
    assert (CORNER.count, CORNER.length_m) == (3, 40.0)
    assert [CORNER.distance_of(index) for index in range(3)] == [0.0, 20.0, 40.0]
    assert CORNER.waypoint(1) == Point(20.0, 0.0)


@pytest.mark.parametrize(
    ("distance_m", "index"), [(-1.0, 0), (0.0, 1), (9.9, 1), (10.0, 2), (20.0, 2), (99.0, 2)]
)
def test_a_waypoint_is_passed_once_it_is_reached(distance_m: float, index: int) -> None:
    assert LINE.index_after(distance_m) == index


def test_a_path_goes_straight_on_at_both_its_ends() -> None:
    assert CORNER.point_at(-2.0) == Point(-2.0, 0.0)
    assert CORNER.point_at(25.0) == Point(20.0, 5.0)
    assert CORNER.point_at(43.0) == Point(20.0, 23.0)


def test_a_very_short_path_has_its_length() -> None:
    short = path((0, 0), (0.01, 0), (0.02, 0))

    assert short.length_m == pytest.approx(0.02)
    assert short.distance_of(1) == pytest.approx(0.01)


# --- standing still ------------------------------------------------------------------------------


def test_standing_still_adds_no_length() -> None:
    drift = [(-0.00004 * step, 0.0) for step in range(650)]
    stood = path(*drift, *((0.25 * step, 0.0) for step in range(1, 81)))

    assert stood.length_m == pytest.approx(20.0, abs=SPACING_M)
    assert stood.heading_at(0.0) == 0.0
    assert stood.distance_of(649) < SPACING_M


def test_who_stood_still_at_the_start_leaves_all_waypoints_of_it_behind() -> None:
    drift = [(-0.00004 * step, 0.0) for step in range(650)]
    stood = path(*drift, *((0.25 * step, 0.0) for step in range(1, 81)))
    index = stood.index_after(stood.project(0.0, 0.0, 0).distance_m)
    for x in np.arange(0.0, 2.0, 0.1):
        index = stood.index_after(stood.project(x, 0.0, index).distance_m)

    assert stood.waypoint(index - 1).x_m <= 1.9 < stood.waypoint(index).x_m


def test_the_jitter_of_a_receiver_adds_little_length() -> None:
    noise = np.random.default_rng(1).normal(0, 0.02, (1000, 2))
    noise[600:, 0] += np.linspace(0, 40, 400)

    assert path_of(noise).length_m == pytest.approx(40, abs=2)


def test_repeated_waypoints_are_passed_together() -> None:
    twice = path((0, 0), (5, 0), (5, 0), (5, 0), (10, 0), (10, 0))

    assert twice.length_m == 10.0
    assert twice.index_after(5.0) == 4
    assert twice.project(10.5, 0.0, 4).distance_m == twice.length_m


def test_a_path_ends_at_its_last_waypoint_even_if_that_drifted_back() -> None:
    drifted = path((0, 0), (5, 0), (10, 0), (9.97, 0))

    assert drifted.length_m == pytest.approx(9.97)
    assert drifted.heading_at(drifted.length_m) == pytest.approx(0)


# --- headings and curvatures ---------------------------------------------------------------------


def test_a_bend_has_the_heading_and_curvature_of_its_circle() -> None:
    for distance in (5.0, 20.0, 40.0):
        assert BEND.heading_at(distance) == pytest.approx(distance / 20, abs=0.002)
        assert BEND.curvature_at(distance) == pytest.approx(1 / 20, rel=0.02)


def test_a_bend_to_the_right_is_negative() -> None:
    assert path_of(arc(20, pi) * [1, -1]).curvature_at(20) == pytest.approx(-1 / 20, rel=0.02)


def test_the_tightest_bend_of_a_vehicle_keeps_its_curvature() -> None:
    assert path_of(arc(2.5, pi, 0.1)).curvature_at(3.9) == pytest.approx(1 / 2.5, rel=0.02)


def test_a_heading_that_passes_west_does_not_jump_in_curvature() -> None:
    west = path_of(arc(20, pi) @ np.array([[-1, 0], [0, -1]]))

    assert max(abs(west.curvature_at(d)) for d in np.arange(0, 60, 0.5)) < 0.051


def test_the_curvature_of_a_noisy_recording_is_that_of_the_road() -> None:
    noise = np.random.default_rng(1).normal(0, 0.02, (1000, 2))
    noisy = path_of(np.column_stack((np.arange(1000) * 0.1, np.zeros(1000))) + noise)

    assert np.abs(noisy.curvatures_at(np.arange(5, noisy.length_m - 5, 0.5))).max() < 0.05


def test_many_curvatures_are_the_same_as_one_after_the_other() -> None:
    for some in (CORNER, OUT_AND_BACK, BEND):
        at = np.arange(-3, some.length_m + 3, 0.25)
        assert some.curvatures_at(at).tolist() == pytest.approx([some.curvature_at(d) for d in at])


def test_where_a_path_turns_back_on_itself_it_still_has_a_heading() -> None:
    assert abs(OUT_AND_BACK.heading_at(20.0)) == pytest.approx(pi)


# --- where a vehicle is --------------------------------------------------------------------------


def test_a_vehicle_beside_the_path_is_left_or_right_of_it() -> None:
    left, right = LINE.project(4.0, 1.5, 0), LINE.project(4.0, -1.5, 0)

    assert (left.distance_m, left.cross_track_error_m, left.heading_rad) == (4.0, 1.5, 0.0)
    assert right.cross_track_error_m == -1.5


def test_outside_of_a_corner_the_error_is_the_distance_from_it() -> None:
    assert CORNER.project(23.0, -4.0, 1).cross_track_error_m == pytest.approx(-5.0)


def test_before_the_start_and_beyond_the_end_only_the_side_counts() -> None:
    before, beyond = LINE.project(-3.0, 1.0, 0), LINE.project(22.0, 1.0, 2)

    assert (before.distance_m, before.cross_track_error_m) == (0.0, 1.0)
    assert (beyond.distance_m, beyond.cross_track_error_m) == (20.0, 1.0)


def test_beyond_the_last_waypoint_the_distance_is_exactly_the_length() -> None:
    slanted = path((0.1, 0.3), (3.3, 1.7), (7.7, 2.9))

    assert slanted.project(7.8, 2.95, 2).distance_m == slanted.length_m
    assert slanted.project(7.6, 2.85, 2).distance_m < slanted.length_m


def test_a_vehicle_that_was_pushed_back_is_at_the_last_waypoint_it_passed() -> None:
    pushed = LINE.project(7.5, 0.2, 2)

    assert (pushed.distance_m, pushed.cross_track_error_m) == (10.0, 0.2)


def test_a_vehicle_that_was_pushed_ahead_is_found_there() -> None:
    dense = path_of(np.column_stack((np.arange(0, 20, 0.05), np.zeros(400))))

    assert dense.project(8.0, 1.0, dense.index_after(5.0)).distance_m == pytest.approx(8.0)


def test_waypoints_further_apart_than_the_window_are_followed() -> None:
    sparse = path((0, 0), (100, 0), (100, 100))

    assert sparse.project(99.0, 0.0, 1).distance_m == 99.0
    assert sparse.project(100.0, 40.0, 1).distance_m == 140.0


def test_a_corner_that_was_cut_is_found_again_behind_it() -> None:
    index = 1
    for x, y in ((17.0, 0.0), (18.0, 1.0), (18.5, 3.0), (19.0, 5.0)):
        at = CORNER.project(x, y, index)
        index = CORNER.index_after(at.distance_m)

    assert (at.distance_m, at.cross_track_error_m) == (25.0, 1.0)


def test_on_an_out_and_back_the_way_out_is_not_taken_for_the_way_back() -> None:
    index = 0
    for x in np.arange(0.0, 19.6, 0.5):
        at = OUT_AND_BACK.project(x, 0.02, index)
        assert at.distance_m == pytest.approx(x)
        index = OUT_AND_BACK.index_after(at.distance_m)


def test_a_path_is_not_left_where_it_crosses_itself() -> None:
    t = np.linspace(0, 2 * pi, 800)
    eight = path_of(10 * np.column_stack((np.sin(t), np.sin(2 * t) / 2)))
    index = 0
    for distance in np.arange(0, eight.length_m, 0.14):
        place = eight.point_at(distance)
        at = eight.project(place.x_m + 0.01, place.y_m, index)
        assert at.distance_m == pytest.approx(distance, abs=0.05)
        index = eight.index_after(at.distance_m)


def test_the_end_of_a_loop_that_overlaps_its_start_is_not_taken_for_it() -> None:
    loop = path_of(arc(20, 2 * pi + 0.15))

    assert loop.project(1.0, 0.0, 0).distance_m == pytest.approx(1.0, abs=0.1)


def test_a_start_index_past_the_end_is_at_the_end() -> None:
    assert LINE.project(15.0, 0.0, 99).distance_m == 15.0


places = st.tuples(st.floats(-50, 50), st.floats(-50, 50))


@given(st.lists(places, min_size=2, max_size=30).filter(lambda p: len({*p}) > 1), places, st.data())
def test_a_vehicle_is_found_on_the_path_and_never_before_what_it_passed(
    corners: list[tuple[float, float]], vehicle: tuple[float, float], data: st.DataObject
) -> None:
    try:
        some = path(*corners)
    except InvalidValueError:
        return
    index = data.draw(st.integers(0, some.count - 1))

    at = some.project(*vehicle, index)

    passed = some.distance_of(max(index - 1, 0))
    following = some.distance_of(max(index, 1))
    assert passed <= at.distance_m <= some.length_m
    assert some.index_after(at.distance_m) >= index
    assert abs(at.cross_track_error_m) <= 1e-9 + hypot(
        vehicle[0] - some.point_at(at.distance_m).x_m,
        vehicle[1] - some.point_at(at.distance_m).y_m,
    )
    # No further than the segment that begins within the window.
    begun = [some.distance_of(i) for i in range(some.count) if some.distance_of(i) > passed]
    ends = [end for end in begun if end >= following + WINDOW_M]
    assert at.distance_m <= (ends[0] if ends else some.length_m)


@given(st.floats(-pi, pi), places, st.floats(0, 60))
def test_a_turned_and_moved_path_is_the_same_path(
    angle: float, by: tuple[float, float], distance: float
) -> None:
    turn = np.array([[cos(angle), sin(angle)], [-sin(angle), cos(angle)]])
    moved = path_of(arc(20, pi) @ turn + by)
    place = moved.point_at(distance)

    assert moved.length_m == pytest.approx(BEND.length_m)
    assert moved.curvature_at(distance) == pytest.approx(BEND.curvature_at(distance))
    assert moved.project(place.x_m, place.y_m, moved.index_after(distance)).distance_m == (
        pytest.approx(distance)
    )
