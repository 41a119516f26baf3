"""Of what a controller says, that counts which the pose of the vehicle bears out."""

import math
import re

import pytest

from domain.timebase import seconds
from domain.tracking.claimed_progress import ClaimedProgress
from domain.tracking.coverage import Coverage
from domain.tracking.line_watch import GivenUpError, LegLimits
from domain.vehicle import Pose, VehicleState
from tests.support.paths import straight

LIMITS = LegLimits(
    max_cross_track_m=3.0,
    max_cross_track_for=seconds(1),
    no_progress_for=seconds(20),
    least_progress_m=0.05,
)


def at(x_m: float, y_m: float = 0.0) -> VehicleState:
    return VehicleState(Pose(x_m, y_m, 0.0), 1.0, 0.0)


def progress(start_index: int = 0, reached_m: float = 0.0) -> ClaimedProgress:
    """Return the progress along 20 m with a waypoint on each metre."""
    coverage = Coverage(straight(), reached_m, 0.0, 3.0, 1.0)
    return ClaimedProgress(coverage, 0, start_index, 5.0, seconds(0))


def test_both_have_to_say_that_a_waypoint_is_passed() -> None:
    driven = progress()
    driven.claim(4, 0.2, at(2.5))
    driven.follow(at(2.5), LIMITS, seconds(1))
    assert (driven.target_index, driven.distance_m) == (3, 2.5)

    driven.follow(at(6.5), LIMITS, seconds(2))
    assert (driven.target_index, driven.distance_m) == (4, 4.0)


def test_a_waypoint_just_ahead_may_be_called_passed_and_one_far_ahead_may_not() -> None:
    driven = progress()
    driven.claim(8, 0.3, at(2.1))
    with pytest.raises(GivenUpError, match=re.escape("passed waypoint 8, which is 5.9 m ahead")):
        driven.claim(9, 0.4, at(2.1))


def test_a_vehicle_beside_the_path_passed_nothing_of_it_further_on() -> None:
    driven = progress()
    with pytest.raises(GivenUpError, match="ahead of the vehicle"):
        driven.claim(15, 0.7, at(0.0, 4.0))


@pytest.mark.parametrize(
    ("index", "share", "words"),
    [
        (21, 0.5, "drives to waypoint 21 of 21"),
        (2**63, 0.5, "of 21"),
        (3, 0.5, "went back from waypoint 5 to 3"),
        (5, math.nan, "progress is nan"),
        (5, math.inf, "progress is inf"),
        (5, 1.01, "progress is 1.01"),
        (5, -0.01, "progress is -0.01"),
    ],
)
def test_what_no_progress_can_be_is_given_up(index: int, share: float, words: str) -> None:
    driven = progress(start_index=5, reached_m=4.5)
    with pytest.raises(GivenUpError, match=words):
        driven.claim(index, share, at(4.5))


def test_on_its_way_to_the_path_a_vehicle_may_be_far_from_it_and_later_not() -> None:
    driven = progress()
    for second in range(3):
        driven.follow(at(0.0, 4.5), LIMITS, seconds(second))
    driven.follow(at(1.0, 0.0), LIMITS, seconds(4))
    driven.follow(at(2.0, 4.5), LIMITS, seconds(5))
    with pytest.raises(GivenUpError, match=re.escape("4.5 m from the path for 1 s")):
        driven.follow(at(2.0, 4.5), LIMITS, seconds(6))


def test_without_progress_that_both_see_the_goal_is_given_up() -> None:
    driven = progress()
    driven.follow(at(0.0), LIMITS, seconds(0))
    driven.follow(at(5.0), LIMITS, seconds(19))
    with pytest.raises(GivenUpError, match="no progress"):
        driven.follow(at(9.0), LIMITS, seconds(20))


def test_while_it_stops_a_vehicle_passes_more_than_was_said() -> None:
    driven = progress()
    driven.claim(3, 0.1, at(3.0))
    driven.roll(at(4.5))
    assert (driven.target_index, driven.distance_m) == (5, 4.5)


def test_it_arrived_where_it_stands_near_the_end_and_left_nothing_out() -> None:
    driven = progress()
    for x_m in range(20):
        driven.roll(at(float(x_m)))
    assert (
        driven.why_not_arrived(at(17.0), 0.5) == "the vehicle stands 3.0 m from the last waypoint"
    )
    assert driven.why_not_arrived(at(20.3), 0.5) == ""


def test_it_did_not_arrive_if_it_skipped_what_lies_between() -> None:
    driven = progress()
    driven.roll(at(0.0))
    for y_m in (4.0, 8.0, 12.0):
        driven.roll(at(0.0, y_m))
    for x_m in (10.0, 20.0):
        driven.roll(at(x_m, 12.0))

    assert "were skipped" in driven.why_not_arrived(at(20.0), 0.5)
