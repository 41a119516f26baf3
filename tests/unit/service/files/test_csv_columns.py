"""Where x, y and the heading are."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.errors import InvalidValueError
from domain.paths.headings import Heading
from service.files.csv_columns import UnknownColumnsError, column_names, named, unnamed


def found(text: str) -> tuple[int, int, int | None, object]:
    columns = named(text.split(","))
    return columns.x, columns.y, columns.yaw, columns.quaternion


@pytest.mark.parametrize(
    ("names", "where"),
    [
        ("x,y", (0, 1, None, None)),
        ("s_m,x_m,y_m,psi_rad,kappa_radpm,vx_mps", (1, 2, 3, None)),
        ("yaw,y,x", (2, 1, 0, None)),
        ("t,x,y,z,qx,qy,qz,qw", (1, 2, None, (4, 5, 6, 7))),
        ("x,y,qz,qw", (0, 1, None, (None, None, 2, 3))),
        ("x,y,qx,qy,qz", (0, 1, None, None)),
        ("x,y,qx,qy,qz,qw,yaw", (0, 1, 6, None)),
        ("x,y,lat,lon", (0, 1, None, None)),
        ("left_x,left_y,center_x,center_y", (2, 3, None, None)),
        ("inner_x,inner_y", (0, 1, None, None)),
        ("x,y,pose.yaw,heading", (0, 1, 3, None)),
        ("pose.position.x,pose.position.y,twist.linear.x,twist.linear.y", (0, 1, None, None)),
        ("x_m,x_normvec_m,y_m,y_normvec_m", (0, 2, None, None)),
    ],
)
def test_columns_are_found_in_any_order(names: str, where: object) -> None:
    assert found(names) == where


@pytest.mark.parametrize(
    ("names", "code", "word"),
    [
        ("a,b", "UNKNOWN_COLUMNS", "no column is named x"),
        ("x,z", "UNKNOWN_COLUMNS", "none y"),
        ("map_x,odom_y", "UNKNOWN_COLUMNS", "x"),
        ("x,y,x,y", "AMBIGUOUS_COLUMNS", "more than one"),
        ("left_x,left_y,right_x,right_y", "AMBIGUOUS_COLUMNS", "more than one"),
        ("lat,lon", "LATITUDE_LONGITUDE", "latitude"),
        ("x_km,y_km", "WRONG_UNIT", "km"),
        ("x [deg],y [deg]", "WRONG_UNIT", "deg"),
    ],
)
def test_names_that_do_not_say_where_x_and_y_are_are_refused(
    names: str, code: str, word: str
) -> None:
    with pytest.raises(UnknownColumnsError, match=word) as caught:
        named(names.split(","))

    assert caught.value.code == code
    assert caught.value.hint


@pytest.mark.parametrize(
    ("name", "headings"),
    [
        ("yaw_deg", {Heading.DEG, Heading.COMPASS}),
        ("psi_rad", {Heading.RAD, Heading.RAD_NORTH, Heading.RAD_COMPASS}),
        ("heading_compass", {Heading.COMPASS}),
        ("yaw", set(Heading)),
    ],
)
def test_a_name_limits_what_the_heading_may_be(name: str, headings: set[Heading]) -> None:
    assert set(named(["x", "y", name]).headings) == headings


@pytest.mark.parametrize(("width", "yaw"), [(2, None), (3, 2), (9, 2)])
def test_without_names_the_order_is_x_y_yaw(width: int, yaw: int | None) -> None:
    columns = unnamed(width)

    assert (columns.x, columns.y, columns.yaw, len(columns.names)) == (0, 1, yaw, width)


def test_asked_names_may_be_left_open() -> None:
    assert column_names("-, x ,_,y,,foo") == ("-", "x", "_", "y", "", "foo")


@pytest.mark.parametrize("text", ["", "x", "yaw,s", "x,y,x", "lat,lon"])
def test_asked_names_need_x_and_y(text: str) -> None:
    with pytest.raises(InvalidValueError, match="such as x,y,yaw"):
        column_names(text)


@given(st.lists(st.text(max_size=20), max_size=30))
def test_any_names_are_columns_or_are_refused(names: list[str]) -> None:
    with contextlib.suppress(UnknownColumnsError):
        assert all(0 <= index < len(names) for index in named(names).used)
