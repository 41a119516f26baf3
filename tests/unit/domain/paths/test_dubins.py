from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.paths.dubins import shortest_curve
from domain.vehicle import Pose

HERE = Pose(0.0, 0.0, 0.0)
PLACES = st.floats(-12, 12)
ANGLES = st.one_of(st.floats(-pi, pi), st.sampled_from([0.0, pi / 2, pi, -pi / 2]))
POSES = st.builds(Pose, PLACES, PLACES, ANGLES)


def test_straight_ahead_there_is_nothing_to_turn() -> None:
    assert shortest_curve(HERE, Pose(7.0, 0.0, 0.0), 3.0).length_m == pytest.approx(7.0)


def test_who_is_there_already_drives_nowhere() -> None:
    curve = shortest_curve(HERE, HERE, 3.0)

    assert curve.length_m == pytest.approx(0.0)
    assert len(curve.places(0.1)) == 1


def test_a_quarter_turn_is_one_arc() -> None:
    curve = shortest_curve(HERE, Pose(3.0, 3.0, pi / 2), 3.0)

    assert curve.length_m == pytest.approx(3.0 * pi / 2)


def test_turning_on_the_spot_takes_three_arcs() -> None:
    curve = shortest_curve(HERE, Pose(0.0, 0.0, pi), 3.0)

    # A sixth of a circle, five sixths of one, and a sixth: 7/3 pi in all.
    assert curve.length_m == pytest.approx(3.0 * 7 / 3 * pi)
    assert 0 not in curve.turns


@given(POSES, POSES, st.floats(0.5, 8))
def test_every_pose_is_reached_with_its_heading_and_no_tighter_than_allowed(
    start: Pose, end: Pose, radius_m: float
) -> None:
    curve = shortest_curve(start, end, radius_m)
    places = curve.places(0.05)

    assert places[0] == pytest.approx([start.x_m, start.y_m, start.yaw_rad])
    assert places[-1, :2] == pytest.approx([end.x_m, end.y_m], abs=1e-5)
    assert np.cos(places[-1, 2] - end.yaw_rad) == pytest.approx(1.0, abs=1e-6)
    steps = np.hypot(*np.diff(places[:, :2], axis=0).T)
    assert steps.sum() == pytest.approx(curve.length_m, rel=1e-3, abs=1e-6)
    turned = np.abs(np.diff(places[:, 2]))
    assert (turned <= steps / radius_m * (1 + 1e-3) + 1e-9).all()
    assert steps.max(initial=0.0) <= 0.05 + 1e-9


@given(POSES, st.floats(0.5, 8))
def test_a_mirrored_errand_is_as_long(end: Pose, radius_m: float) -> None:
    mirrored = Pose(end.x_m, -end.y_m, -end.yaw_rad)

    length_m = shortest_curve(HERE, mirrored, radius_m).length_m
    assert length_m == pytest.approx(shortest_curve(HERE, end, radius_m).length_m, abs=1e-5)
