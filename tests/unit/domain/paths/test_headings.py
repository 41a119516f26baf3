import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from domain.paths.headings import Heading, Ways, along, wrapped

RAD, DEG, COMPASS = Heading.RAD, Heading.DEG, Heading.COMPASS


def circle(
    count: int = 100, radius_m: float = 20.0
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return places around a circle, counter-clockwise, and headings along it."""
    angles = np.linspace(0.0, 1.9 * math.pi, count)
    places = radius_m * np.column_stack((np.cos(angles), np.sin(angles)))
    return places, wrapped(angles + math.pi / 2)


def test_headings_along_the_way_fit() -> None:
    places, yaws = circle()

    assert Ways(places).fit(yaws, RAD).misfit_rad < 0.05


def test_headings_of_who_drives_backwards_fit() -> None:
    places, yaws = circle()

    assert Ways(places).fit(yaws + math.pi, RAD).misfit_rad < 0.05


def test_headings_across_the_way_do_not_fit() -> None:
    places, yaws = circle()

    assert Ways(places).fit(yaws + math.pi / 2, RAD).misfit_rad == pytest.approx(
        math.pi / 2, abs=0.05
    )


def test_the_median_counts_and_not_a_few_wild_headings() -> None:
    places, yaws = circle()
    yaws[::5] = 1.0

    assert Ways(places).fit(yaws, RAD).misfit_rad < 0.05


def test_who_stands_still_first_counts_only_once() -> None:
    places, yaws = circle()
    jitter = np.random.default_rng(3).normal(0.0, 0.02, (5_000, 2))
    places = np.concatenate((places[0] + jitter, places))
    yaws = np.concatenate((np.full(5_000, yaws[0]), yaws))

    assert Ways(places).fit(yaws, RAD).misfit_rad < 0.05


def test_a_short_path_has_ways_too() -> None:
    places = np.column_stack((np.linspace(0.0, 0.4, 21), np.zeros(21)))
    ways = Ways(places)

    assert ways.count >= 5
    assert ways.fit(np.full(21, 0.2), RAD).misfit_rad == pytest.approx(0.2)


@pytest.mark.parametrize("count", [1, 7])
def test_where_all_places_are_one_there_is_no_way(count: int) -> None:
    assert Ways(np.ones((count, 2))).count == 0


@given(st.floats(-100.0, 100.0))
def test_a_wrapped_angle_is_the_same_direction_within_half_a_turn(angle: float) -> None:
    (found,) = wrapped(np.array([angle])).tolist()

    assert -math.pi <= found <= math.pi
    assert math.cos(found) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(found) == pytest.approx(math.sin(angle), abs=1e-9)


@pytest.mark.parametrize(
    ("angle", "expected"),
    [
        (0.0, 0.0),
        (3.0, 3.0),
        (4.0, 4.0 - 2 * math.pi),
        (-4.0, 2 * math.pi - 4.0),
        (7.0, 7.0 - 2 * math.pi),
    ],
)
def test_an_angle_is_wrapped_by_whole_turns(angle: float, expected: float) -> None:
    assert wrapped(np.array([angle]))[0] == pytest.approx(expected)


def test_a_way_is_as_long_as_half_a_metre_or_a_tenth_of_a_short_path() -> None:
    along_x = np.column_stack((np.linspace(0.0, 20.0, 81), np.zeros(81)))
    y = [0.0, 0.12, 0.25, 0.37, 0.5, 0.62, 0.75, 0.87, 1.0, 1.12, 1.25]
    short = np.column_stack((np.zeros(11), y))

    assert Ways(along_x).count == 40
    assert Ways(short).count == 5


def test_a_way_does_not_depend_on_where_the_path_lies() -> None:
    places = np.array([[7.0, -3.0], [7.0, -2.4], [7.6, -2.4], [7.6, -2.0], [7.6, -1.6]])

    assert Ways(places).count == Ways(places - places[0]).count == 4
    north = math.pi / 2 + np.array([0.0, 0.0, 0.0, 0.0, 0.01])
    assert Ways(places).fit(north, RAD).misfit_rad == pytest.approx(0.0)


def test_the_second_waypoint_counts_if_it_is_far_enough() -> None:
    assert Ways(np.array([[0.0, 0.0], [1.0, 0.0]])).count == 1


# --- units ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("heading", "east", "north"),
    [
        (Heading.RAD, 0.0, math.pi / 2),
        (Heading.DEG, 360.0, 90.0),
        (Heading.COMPASS, 90.0, 360.0),
        (Heading.RAD_NORTH, -math.pi / 2, math.tau),
        (Heading.RAD_COMPASS, math.pi / 2, math.tau),
    ],
)
def test_east_and_north_are_east_and_north_in_any_unit(
    heading: Heading, east: float, north: float
) -> None:
    yaws = heading.yaws(np.array([east, north]))

    assert np.cos(yaws) == pytest.approx([1, 0], abs=1e-12)
    assert np.sin(yaws) == pytest.approx([0, 1], abs=1e-12)


def test_radians_are_kept_as_they_are_counted() -> None:
    assert Heading.RAD.yaws(np.array([50.0])).tolist() == [50.0]


@pytest.mark.parametrize("heading", list(Heading))
def test_the_unit_in_which_headings_fit_is_found(heading: Heading) -> None:
    places, yaws = circle()
    turned = {
        Heading.RAD: yaws,
        Heading.DEG: np.degrees(yaws),
        Heading.COMPASS: (90 - np.degrees(yaws)) % 360,
        Heading.RAD_NORTH: yaws - math.pi / 2,
        Heading.RAD_COMPASS: math.pi / 2 - yaws,
    }
    fit, _ = Ways(places).best_fit(turned[heading], list(Heading))

    assert (fit.heading, fit.fits, fit.is_reversed) == (heading, True, False)


def test_headings_against_the_way_are_told_as_reversed() -> None:
    places, yaws = circle()

    assert Ways(places).best_fit(wrapped(yaws + math.pi), [RAD, DEG, COMPASS])[0].is_reversed


def test_radians_against_the_way_are_no_degrees_along_it() -> None:
    places = np.column_stack((np.arange(60.0), np.zeros(60)))
    # 3.19 rad is the way back; 3.19 degrees are the way.
    fit, _ = Ways(places).best_fit(np.full(60, 3.19), [RAD, DEG, COMPASS])

    assert (fit.heading, fit.is_reversed) == (RAD, True)


def test_a_heading_along_the_way_is_preferred_to_one_against_it() -> None:
    places = np.column_stack((-np.arange(60.0), np.arange(60.0)))
    # North-west is 315 on a compass; in degrees from east it is south-east.
    fit, _ = Ways(places).best_fit(np.full(60, 315.0), [DEG, COMPASS])

    assert (fit.heading, fit.is_reversed) == (COMPASS, False)


@pytest.mark.parametrize("values", [1.1, 5.5, 100.0, 1.6e9])
def test_what_is_the_same_all_around_a_circle_fits_in_no_unit(values: float) -> None:
    places, yaws = circle()

    assert not Ways(places).best_fit(np.full_like(yaws, values), list(Heading))[1]


def test_what_never_changes_fits_no_path_that_turns_now_and_then() -> None:
    corner = [(float(x), 0.0) for x in range(30)] + [(29.0, float(y)) for y in range(1, 10)]
    ways = Ways(np.array(corner))

    assert not ways.best_fit(np.full(39, 2.0), [RAD, DEG, COMPASS])[1]
    assert ways.best_fit(np.r_[np.full(30, 2.0), np.full(9, 92.0)], [RAD, DEG, COMPASS])[1]


def test_a_time_on_a_straight_is_no_heading_of_many_turns() -> None:
    places = np.column_stack((np.arange(60.0), np.zeros(60)))
    # In degrees it would turn by 6 from beginning to end.
    times = 1_600_000_200 + 0.1 * np.arange(60.0)

    assert not Ways(places).best_fit(times, list(Heading))[1]


def test_headings_of_the_way_to_a_corner_fit_as_well_as_those_of_the_way_from_it() -> None:
    places = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0], [0.0, 20.0]])
    leaving = np.array([0.0, math.pi / 2, math.pi, math.pi / 2, math.pi / 2])
    arriving = np.array([0.0, 0.0, math.pi / 2, math.pi, math.pi / 2])

    assert Ways(places).fit(leaving, RAD).misfit_rad == pytest.approx(0.0)
    assert Ways(places).fit(arriving, RAD).misfit_rad == pytest.approx(0.0)


@pytest.mark.parametrize("places", [[[0, 0], [1, 0]], [[1, 1], [1, 1], [1, 1]]])
def test_one_way_or_none_says_too_little_to_doubt_a_heading(places: list[list[float]]) -> None:
    ways = Ways(np.array(places, dtype=float))

    assert ways.best_fit(np.full(len(places), 5.0), [RAD, DEG, COMPASS])[0].heading is RAD
    assert ways.best_fit(np.full(len(places), 90.0), [RAD, DEG, COMPASS])[0].heading is DEG


def test_the_first_heading_beside_the_way_is_found() -> None:
    places = np.column_stack((np.arange(10.0), np.zeros(10)))
    yaws = np.zeros(10)
    yaws[6:] = 1.0

    assert Ways(places).first_misfit(yaws, RAD) == 6


# --- directions of the path ----------------------------------------------------------------------


def test_headings_of_the_path_lead_from_neighbour_to_neighbour() -> None:
    places = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 2.0]])

    assert along(places) == pytest.approx([0.0, math.pi / 4, math.pi / 2, math.pi / 2])


def test_who_stands_faces_where_it_came_from_or_where_it_will_go() -> None:
    places = np.array([[0.0, 0.0]] * 3 + [[0.0, 1.0]] + [[0.0, 2.0]] * 3)

    assert along(places) == pytest.approx([math.pi / 2] * 7)


def test_a_path_of_one_place_faces_east() -> None:
    assert along(np.ones((3, 2))).tolist() == [0.0, 0.0, 0.0]
