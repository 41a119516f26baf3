import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from domain.paths.headings import Ways, wrapped


def circle(
    count: int = 100, radius_m: float = 20.0
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return places around a circle, counter-clockwise, and headings along it."""
    angles = np.linspace(0.0, 1.9 * math.pi, count)
    places = radius_m * np.column_stack((np.cos(angles), np.sin(angles)))
    return places, wrapped(angles + math.pi / 2)


def test_headings_along_the_way_fit() -> None:
    places, yaws = circle()

    assert Ways(places).misfit(yaws) < 0.05


def test_headings_of_who_drives_backwards_fit() -> None:
    places, yaws = circle()

    assert Ways(places).misfit(yaws + math.pi) < 0.05


def test_headings_across_the_way_do_not_fit() -> None:
    places, yaws = circle()

    assert Ways(places).misfit(yaws + math.pi / 2) == pytest.approx(math.pi / 2, abs=0.05)


def test_the_median_counts_and_not_a_few_wild_headings() -> None:
    places, yaws = circle()
    yaws[::5] = 1.0

    assert Ways(places).misfit(yaws) < 0.05


def test_who_stands_still_first_counts_only_once() -> None:
    places, yaws = circle()
    jitter = np.random.default_rng(3).normal(0.0, 0.02, (5_000, 2))
    places = np.concatenate((places[0] + jitter, places))
    yaws = np.concatenate((np.full(5_000, yaws[0]), yaws))

    assert Ways(places).misfit(yaws) < 0.05


def test_a_short_path_has_ways_too() -> None:
    places = np.column_stack((np.linspace(0.0, 0.4, 21), np.zeros(21)))
    ways = Ways(places)

    assert ways.count >= 5
    assert ways.misfit(np.full(21, 0.2)) == pytest.approx(0.2)


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
    assert Ways(places).misfit(np.full(5, math.pi / 2)) == pytest.approx(0.0)


def test_the_second_waypoint_counts_if_it_is_far_enough() -> None:
    ways = Ways(np.array([[0.0, 0.0], [1.0, 0.0]]))

    assert ways.count == 1
    assert ways.misfit(np.array([0.3, 9.0])) == pytest.approx(0.3)
