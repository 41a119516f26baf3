import math

import numpy as np
import pytest
from numpy.typing import NDArray

from domain.errors import InvalidValueError
from domain.paths.waypoints import MAX_WAYPOINTS, check_waypoints


def line(count: int) -> NDArray[np.float64]:
    points = np.zeros((count, 3))
    points[:, 0] = np.arange(count)
    return points


@pytest.mark.parametrize("count", [2, MAX_WAYPOINTS])
def test_as_many_waypoints_as_a_path_may_have_are_taken_as_they_are(count: int) -> None:
    check_waypoints(line(count))


@pytest.mark.parametrize("count", [0, 1, MAX_WAYPOINTS + 1])
def test_too_few_or_too_many_are_refused(count: int) -> None:
    with pytest.raises(InvalidValueError, match=f"not {count}") as caught:
        check_waypoints(line(count))

    assert caught.value.pointer == "/waypoints"


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize(("column", "name"), [(0, "x_m"), (1, "y_m"), (2, "yaw_rad")])
def test_what_is_not_finite_is_refused_with_its_place(column: int, name: str, value: float) -> None:
    points = line(20)
    points[12, column] = value

    with pytest.raises(InvalidValueError) as caught:
        check_waypoints(points)

    assert caught.value.pointer == f"/waypoints/12/{name}"


@pytest.mark.parametrize(("column", "name"), [(0, "x_m"), (1, "y_m")])
def test_what_is_further_out_than_a_thousand_kilometres_is_refused(column: int, name: str) -> None:
    points = line(20)
    points[3, column] = 1e7
    check_waypoints(points)

    points[3, column] = -1.001e7
    with pytest.raises(InvalidValueError) as caught:
        check_waypoints(points)

    assert caught.value.pointer == f"/waypoints/3/{name}"


def test_a_heading_may_have_been_counted_on_over_many_turns() -> None:
    points = line(3)
    points[:, 2] = 1e7

    check_waypoints(points)


def test_the_first_of_several_faults_is_told() -> None:
    points = line(20)
    points[[4, 9], [2, 0]] = math.nan

    with pytest.raises(InvalidValueError) as caught:
        check_waypoints(points)

    assert caught.value.pointer == "/waypoints/4/yaw_rad"


def test_what_is_wrong_with_a_waypoint_is_told_with_its_value() -> None:
    points = line(20)
    points[3, 1] = 2.5e7

    with pytest.raises(InvalidValueError) as caught:
        check_waypoints(points)

    assert caught.value.message == ("y_m must be finite and within +-10,000,000 m, not 2.5e+07")
