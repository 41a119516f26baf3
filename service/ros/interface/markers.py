"""Markers for RViz and other viewers, as `visualization_msgs/msg/Marker` with all its fields.

Source: visualization_msgs, `Marker.msg`.
"""

from collections.abc import Sequence
from enum import IntEnum
from math import cos, sin
from typing import NamedTuple

from domain.vehicle import Pose
from service.ros.interface.endpoints import Fields

LIFETIME_S = 3
"""Viewers remove a marker that was not repeated for so long: the service may have ended."""

_ADD, _DELETE = 0, 2


class Kind(IntEnum):
    """Type of a marker."""

    CUBE = 1
    SPHERE = 2
    LINE_STRIP = 4
    TEXT = 9


class Color(NamedTuple):
    """Parts of a colour, 0 to 1."""

    r: float
    g: float
    b: float
    a: float = 1.0


class Size(NamedTuple):
    """Extent along the axes of a marker, m; a line has the width x, a text the height z."""

    x_m: float
    y_m: float
    z_m: float


class Look(NamedTuple):
    """What a marker looks like, wherever it is."""

    number: int
    """No two markers of one message have the same."""
    kind: Kind
    size: Size
    color: Color

    def scaled(self, scale: float) -> "Look":
        """Return it larger or smaller."""
        return self._replace(size=Size(*(scale * extent for extent in self.size)))


_HERE: Fields = {"x": 0.0, "y": 0.0, "z": 0.0}
_UNTURNED: Fields = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
_NO_HEADER: Fields = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
_NAMESPACE = "pilothouse"


def pose(value: Pose, z_m: float = 0.0) -> Fields:
    """Return a `geometry_msgs/msg/Pose`."""
    half = value.yaw_rad / 2
    return {
        "position": {"x": value.x_m, "y": value.y_m, "z": z_m},
        "orientation": {"x": 0.0, "y": 0.0, "z": sin(half), "w": cos(half)},
    }


def marker(
    header: Fields,
    look: Look,
    at: Fields | None = None,
    points: Sequence[Fields] = (),
    text: str = "",
) -> Fields:
    """Return a marker that is drawn.

    Args:
        header: Of the message.
        look: Its number, kind, size and colour.
        at: Its pose; None: the origin, as for a line, whose points say where it is.
        points: Of a line.
        text: Of a text.
    """
    return {
        **_marker(header, look, _ADD),
        "pose": at or {"position": _HERE, "orientation": _UNTURNED},
        "points": list(points),
        "text": text,
    }


def no_marker(header: Fields, look: Look) -> Fields:
    """Return a marker that removes the one with the same number, if there is one."""
    return _marker(header, look, _DELETE)


def _marker(header: Fields, look: Look, action: int) -> Fields:
    x_m, y_m, z_m = look.size
    return {
        "header": header,
        "ns": _NAMESPACE,
        "id": look.number,
        "type": int(look.kind),
        "action": action,
        "pose": {"position": _HERE, "orientation": _UNTURNED},
        "scale": {"x": x_m, "y": y_m, "z": z_m},
        "color": look.color._asdict(),
        "lifetime": {"sec": LIFETIME_S, "nanosec": 0},
        "frame_locked": False,
        "points": [],
        "colors": [],
        "texture_resource": "",
        "texture": {"header": _NO_HEADER, "format": "", "data": []},
        "uv_coordinates": [],
        "text": "",
        "mesh_resource": "",
        "mesh_file": {"filename": "", "data": []},
        "mesh_use_embedded_materials": False,
    }
