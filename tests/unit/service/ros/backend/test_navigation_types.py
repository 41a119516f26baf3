"""Goals, feedback and results in the words of each action."""

from types import SimpleNamespace

import pytest

from domain.commands import SendGoal
from domain.identifiers import GoalId
from service.ros.backend.navigation_types import NAVIGATION_TYPES
from tests.support.paths import straight

WAYPOINTS = NAVIGATION_TYPES["pilothouse_msgs/action/NavigateWaypoints"]
FOLLOW_PATH = NAVIGATION_TYPES["nav2_msgs/action/FollowPath"]
COMMAND = SendGoal(GoalId(1), straight(), 0, 18, "stanley", 2.0)


def test_waypoints_go_whole_with_the_one_to_begin_with() -> None:
    fields = WAYPOINTS.goal(COMMAND, "odom")

    assert len(fields["waypoints"]) == 21
    assert (fields["start_index"], fields["speed_mps"]) == (18, 2.0)


def test_waypoints_come_back_as_they_are_said() -> None:
    feedback = SimpleNamespace(target_index=19, progress=0.9)
    assert WAYPOINTS.progress(feedback, COMMAND) == (19, 0.9)


@pytest.mark.parametrize(
    ("success", "message", "failure"),
    [(True, "", ""), (False, "stuck", "stuck"), (False, "", "it gave no reason")],
)
def test_a_result_without_success_is_a_failure(success: bool, message: str, failure: str) -> None:
    assert WAYPOINTS.failure(SimpleNamespace(success=success, message=message)) == failure


def test_nav2_gets_the_rest_of_the_path_in_the_frame_of_the_robot_file() -> None:
    path = FOLLOW_PATH.goal(COMMAND, "odom")["path"]

    assert path["header"] == {"frame_id": "odom"}
    assert [pose["pose"]["position"]["x"] for pose in path["poses"]] == [18.0, 19.0, 20.0]
    assert path["poses"][0]["pose"]["orientation"] == {"z": 0.0, "w": 1.0}


@pytest.mark.parametrize(
    ("left_m", "index", "share"),
    [(1.5, 19, 0.925), (0.0, 20, 1.0), (25.0, 18, 0.0), (float("nan"), 21, float("nan"))],
)
def test_progress_of_nav2_follows_from_the_distance_that_is_left(
    left_m: float, index: int, share: float
) -> None:
    target_index, progress = FOLLOW_PATH.progress(
        SimpleNamespace(distance_to_goal=left_m, speed=1.0), COMMAND
    )
    assert target_index == index
    assert progress == pytest.approx(share, nan_ok=True)


@pytest.mark.parametrize(
    ("result", "failure"),
    [
        (SimpleNamespace(), ""),
        (SimpleNamespace(error_code=0, error_msg=""), ""),
        (SimpleNamespace(error_code=102, error_msg=""), "error 102"),
        (SimpleNamespace(error_code=102, error_msg="no valid control"), "no valid control"),
    ],
)
def test_a_result_of_nav2_has_a_code_since_jazzy(result: SimpleNamespace, failure: str) -> None:
    assert FOLLOW_PATH.failure(result) == failure
