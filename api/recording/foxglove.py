"""Messages that Foxglove and Lichtblick know how to draw, with their schemas.

Source: the JSON schemas of foxglove/schemas. The level of a log is an integer here: there it is a
list of alternatives without a type, which Lichtblick rejects.
"""

import math
from collections.abc import Iterable
from typing import Any

from domain.timebase import Instant
from domain.vehicle import Pose

FRAME = "map"
DEBUG, INFO = 1, 2
_NS = 1_000_000_000


def _object(description: str, **members: dict[str, Any]) -> dict[str, Any]:
    return {
        "type": "object",
        "description": description,
        "properties": members,
        "required": list(members),
    }


_NUMBER, _TEXT, _INTEGER = {"type": "number"}, {"type": "string"}, {"type": "integer"}
_TIME = _object("Time since 1970 UTC", sec=_INTEGER, nsec=_INTEGER) | {"title": "time"}
_POSE = _object(
    "A pose in space",
    position=_object("Metres", x=_NUMBER, y=_NUMBER, z=_NUMBER),
    orientation=_object("Quaternion", x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER),
)

LOG_SCHEMA = _object(
    "A message of a log",
    timestamp=_TIME,
    level=_INTEGER,
    message=_TEXT,
    name=_TEXT,
    file=_TEXT,
    line=_INTEGER,
)
POSE_SCHEMA = _object("A pose with its time", timestamp=_TIME, frame_id=_TEXT, pose=_POSE)
PATH_SCHEMA = _object(
    "Poses along a path", timestamp=_TIME, frame_id=_TEXT, poses={"type": "array", "items": _POSE}
)


def log_message(at_ns: Instant, level: int, name: str, words: str) -> dict[str, Any]:
    """Return a `foxglove.Log`; `at_ns` is in ns since 1970 UTC."""
    time = _time(at_ns)
    return {
        "timestamp": time,
        "level": level,
        "message": words,
        "name": name,
        "file": "",
        "line": 0,
    }


def pose_message(at_ns: Instant, pose: Pose) -> dict[str, Any]:
    """Return a `foxglove.PoseInFrame`; `at_ns` is in ns since 1970 UTC."""
    return {
        "timestamp": _time(at_ns),
        "frame_id": FRAME,
        "pose": _pose(pose.x_m, pose.y_m, pose.yaw_rad),
    }


def path_message(at_ns: Instant, points: Iterable[tuple[float, float, float]]) -> dict[str, Any]:
    """Return a `foxglove.PosesInFrame`.

    Args:
        at_ns: ns since 1970 UTC.
        points: x and y in m, yaw in rad.
    """
    poses = [_pose(*point) for point in points]
    return {"timestamp": _time(at_ns), "frame_id": FRAME, "poses": poses}


def _time(at_ns: Instant) -> dict[str, int]:
    return {"sec": at_ns // _NS, "nsec": at_ns % _NS}


def _pose(x_m: float, y_m: float, yaw_rad: float) -> dict[str, Any]:
    half = yaw_rad / 2
    return {
        "position": {"x": x_m, "y": y_m, "z": 0.0},
        "orientation": {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)},
    }
