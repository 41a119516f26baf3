"""Columns that are not x and y."""

import numpy as np
import pytest
from numpy.typing import NDArray

from service.files.csv_suspects import no_place_in, other_format_in
from tests.support.field_files import Track

Floats = NDArray[np.float64]

TRACK = Track()


def table(*columns: Floats) -> Floats:
    return np.column_stack(columns)


def doubt(sample: Floats, *, is_heading: bool = False, may_be: bool = False) -> str:
    found = other_format_in(sample) or no_place_in(
        sample, sample[:, :2], is_heading=is_heading, may_be_heading=may_be
    )
    return "" if found is None else f"{found.message}: {found.hint}"


@pytest.mark.parametrize("unit", [1.0, 1e3, 1e9])
def test_a_time_in_the_first_column_is_told(unit: float) -> None:
    times = (1_600_000_000 + TRACK.t) * unit

    assert "?columns=time,x,y" in doubt(table(times, TRACK.x, TRACK.y))


def test_a_time_before_a_pose_with_a_quaternion_is_told() -> None:
    sample = table(1.6e9 + TRACK.t, TRACK.x, TRACK.y, TRACK.zero, *TRACK.quaternion)

    assert "?columns=time,x,y,z,qx,qy,qz,qw" in doubt(sample)


@pytest.mark.parametrize("scale", [0.05, 1.0, 20.0])
def test_the_distance_along_the_path_is_told(scale: float) -> None:
    track = Track(scale)

    assert "?columns=s,x,y" in doubt(table(track.s, track.x, track.y, track.yaw))


def test_a_diagonal_is_no_distance_where_its_heading_fits() -> None:
    along = np.arange(50.0)
    sample = table(along, along, np.full(50, np.pi / 4))

    assert doubt(sample, is_heading=True) == ""


def test_a_straight_along_x_is_no_distance() -> None:
    assert doubt(table(np.arange(50.0), np.zeros(50), np.zeros(50))) == ""


@pytest.mark.parametrize("steps", [np.ones(121), np.full(121, 0.04)])
def test_a_count_and_a_clock_before_x_and_y_are_told(steps: Floats) -> None:
    track = Track(0.2)

    assert "?columns=t,x,y" in doubt(table(np.cumsum(steps), track.x, track.y))


def test_a_clock_may_be_x_where_the_third_column_fits_as_a_heading() -> None:
    sample = table(np.linspace(0, 5, 121), 0.01 * TRACK.x, TRACK.y)

    assert doubt(sample, may_be=True) == ""
    assert doubt(sample, is_heading=True) == ""


def test_x_in_even_steps_with_a_third_column_of_zeros_is_x() -> None:
    assert doubt(table(np.arange(121.0), TRACK.y, TRACK.zero)) == ""


def test_poses_as_matrices_are_told() -> None:
    ones, zeros = TRACK.one, TRACK.zero
    row = (ones, zeros, zeros, TRACK.x, zeros, ones, zeros, TRACK.y, zeros, zeros, ones, zeros)

    assert "3x4 matrices" in doubt(table(*row))


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_degrees_of_latitude_and_longitude_are_told(order: tuple[int, int]) -> None:
    places = table(40.093 + TRACK.y / 111_000, -122.2357 + TRACK.x / 85_000)

    assert "latitude" in doubt(places[:, order])


@pytest.mark.parametrize("scale", [0.05, 1.0])
def test_a_path_is_none_of_these(scale: float) -> None:
    track = Track(scale)

    assert doubt(table(track.x, track.y)) == ""
    assert doubt(table(track.x, track.y, track.yaw, track.speed)) == ""
    assert doubt(table(track.x, track.y, track.s)) == ""
    assert doubt(table(track.x + 303_628, track.y + 3_900_696)) == ""


def test_gaps_are_none_of_these() -> None:
    assert doubt(np.full((20, 12), np.nan)) == ""
