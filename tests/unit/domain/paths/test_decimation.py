from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from domain.paths.decimation import Decimation

TOLERANCE_M = 0.05


def decimated(places: NDArray[np.float64], most: int = 2_000) -> NDArray[np.int64]:
    """Return the indices of the points that are kept in the end."""
    decimation = Decimation(places, TOLERANCE_M, most)
    while not decimation.is_done:
        decimation.go_on()
    return decimation.indices


def farthest_m(places: NDArray[np.float64], kept: NDArray[np.int64]) -> float:
    """Return how far the farthest point is from the line through the kept ones, m."""
    worst = 0.0
    for first, last in pairwise(kept):
        start, chord = places[first], places[last] - places[first]
        ways = places[first : last + 1] - start
        along = np.clip(ways @ chord / max(chord @ chord, 1e-300), 0.0, 1.0)
        worst = max(worst, float(np.max(np.hypot(*(ways - along[:, np.newaxis] * chord).T))))
    return worst


def circle(count: int, radius_m: float) -> NDArray[np.float64]:
    """Return points on a circle that ends where it begins."""
    angles = np.linspace(0.0, 2 * np.pi, count)
    return radius_m * np.column_stack((np.cos(angles), np.sin(angles)))


def zigzag(count: int) -> NDArray[np.float64]:
    """Return points of which none can be left out."""
    numbers = np.arange(count)
    return np.column_stack((0.5 * numbers, 0.2 * (numbers % 2))).astype(np.float64)


def test_a_straight_line_is_its_two_ends() -> None:
    along = np.linspace(0.0, 100.0, 1_000)

    assert decimated(np.column_stack((along, 2 * along))).tolist() == [0, 999]


def test_two_points_are_both_kept() -> None:
    assert decimated(np.array([[0.0, 0.0], [1.0, 1.0]])).tolist() == [0, 1]


def test_a_corner_is_kept() -> None:
    places = np.array([[0.0, 0.0], [5.0, 0.0], [10.0, 0.0], [10.0, 5.0], [10.0, 10.0]])

    assert decimated(places).tolist() == [0, 2, 4]


def test_no_point_of_a_loop_is_farther_off_than_the_tolerance() -> None:
    places = circle(4_000, 50.0)

    kept = decimated(places)

    assert len(kept) < 200
    assert farthest_m(places, kept) <= TOLERANCE_M


def test_points_at_one_place_are_kept_once() -> None:
    places = np.zeros((10, 2))
    places[5:] = (3.0, 4.0)

    assert farthest_m(places, decimated(places)) == 0.0
    assert len(decimated(places)) <= 4


def test_more_points_than_allowed_are_never_kept() -> None:
    places = zigzag(1_000)

    assert len(decimated(places, most=1_000)) == 1_000
    assert len(decimated(places, most=100)) == 100


def test_few_points_are_spent_where_the_line_is_farthest_off() -> None:
    places = zigzag(400)
    places[200, 1] = 50.0

    assert 200 in decimated(places, most=3)


def test_a_long_line_is_done_in_several_portions() -> None:
    places = circle(100_000, 5_000.0)
    decimation = Decimation(places, TOLERANCE_M, 2_000)

    decimation.go_on()

    assert not decimation.is_done
    assert decimation.indices.tolist()[0] == 0
    assert decimation.indices.tolist()[-1] == 99_999
