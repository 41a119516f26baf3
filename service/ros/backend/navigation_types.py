"""Goals, feedback and results of a controller, as the fields of the actions that are supported."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from domain.commands import SendGoal
from service.ros.graph.graph import Fields, Message

Progress: TypeAlias = tuple[int, float]
"""The first waypoint that is not yet passed, and the driven share of the path."""


@dataclass(frozen=True, slots=True)
class NavigationType:
    """How one type of action says what the core says."""

    goal: Callable[[SendGoal, str], Fields]
    """Returns the fields of a goal whose waypoints are in a frame."""
    progress: Callable[[Message, SendGoal], Progress]
    """Returns what a feedback says of a goal."""
    failure: Callable[[Message], str]
    """Returns why a result is no success; empty: it says nothing against one."""


def _waypoints_goal(command: SendGoal, _: str) -> Fields:
    rows = command.path.waypoints.tolist()
    return {
        "waypoints": [{"x_m": x, "y_m": y, "yaw_rad": yaw} for x, y, yaw in rows],
        "start_index": command.start_index,
        "speed_mps": command.speed_mps,
    }


def _waypoints_progress(feedback: Message, _: SendGoal) -> Progress:
    return int(feedback.target_index), float(feedback.progress)


def _waypoints_failure(result: Message) -> str:
    return "" if result.success else result.message or "it gave no reason"


def _path_goal(command: SendGoal, frame_id: str) -> Fields:
    """Return the rest of the path, since FollowPath has no index to begin with."""
    header = {"frame_id": frame_id}
    rows = command.path.waypoints[command.start_index :].tolist()
    poses = [
        {
            "header": header,
            "pose": {
                "position": {"x": x, "y": y},
                "orientation": {"z": math.sin(yaw / 2), "w": math.cos(yaw / 2)},
            },
        }
        for x, y, yaw in rows
    ]
    return {"path": {"header": header, "poses": poses}}


def _path_progress(feedback: Message, command: SendGoal) -> Progress:
    """Return progress from the distance that is left, all that FollowPath tells."""
    path = command.path
    begun_m = path.distance_of(command.first_index)
    at_m = path.length_m - float(feedback.distance_to_goal)
    share = (at_m - begun_m) / (path.length_m - begun_m)
    index = path.index_after(at_m) if math.isfinite(at_m) else path.count
    return max(index, command.start_index), min(max(share, 0.0), 1.0)


def _path_failure(result: Message) -> str:
    # Before ROS 2 Jazzy a result is empty.
    code = getattr(result, "error_code", 0)
    return (getattr(result, "error_msg", "") or f"error {code}") if code else ""


NAVIGATION_TYPES: Mapping[str, NavigationType] = {
    "pilothouse_msgs/action/NavigateWaypoints": NavigationType(
        _waypoints_goal, _waypoints_progress, _waypoints_failure
    ),
    "nav2_msgs/action/FollowPath": NavigationType(_path_goal, _path_progress, _path_failure),
}
