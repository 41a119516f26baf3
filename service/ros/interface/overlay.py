"""What the robot is at, drawn into a map: markers, and the path of the task.

Nothing is computed while nobody listens.
"""

from collections.abc import Iterator
from itertools import islice
from math import cos, sin
from typing import NamedTuple

from domain.identifiers import TaskId
from domain.snapshot import SystemState, SystemStateView, TaskView, VehicleView
from domain.timebase import Instant, seconds
from domain.vehicle import Pose
from service.frame_feed import Frame, FrameFeed
from service.frame_publisher import PERIOD
from service.ros.interface.drawn_path import DrawnPath
from service.ros.interface.endpoints import OWN_NODE, Fields, Listeners, OfferedTopic
from service.ros.interface.markers import Color, Kind, Look, Size, marker, no_marker, pose
from service.ros.interface.message_fields import header
from service.supervisor import Supervisor

OVERLAY = "/pilothouse/overlay"
PATH = "/pilothouse/path"

_AT_MOST_EVERY = seconds(0.2) - PERIOD // 2
"""0.2 s, less half a tick, since ticks may come a little early."""
_AT_LEAST_EVERY = seconds(1.0) - PERIOD // 2
_MOST_ERRORS = 5
_LONGEST_LINE = 80

# Of the GEM e2. All others are drawn to its scale, since the robot file has only the wheelbase.
_BODY = Size(2.45, 1.70, 2.08)
_REAR_M = 0.35
"""How far the body reaches behind the rear axle."""
_TEXT_M, _TEXT_OVER_M = 0.8, 1.5

_COLORS = {
    SystemState.IDLE: Color(0.6, 0.6, 0.6),
    SystemState.RUNNING: Color(0.1, 0.7, 0.2),
    SystemState.ERROR: Color(0.85, 0.1, 0.1),
}
_DONE = Look(0, Kind.LINE_STRIP, Size(0.2, 0.0, 0.0), Color(0.5, 0.5, 0.5))
_AHEAD = Look(1, Kind.LINE_STRIP, Size(0.2, 0.0, 0.0), Color(0.1, 0.4, 0.9))
_LOOKAHEAD = Look(2, Kind.SPHERE, Size(0.5, 0.5, 0.5), Color(1.0, 0.6, 0.0))
_VEHICLE, _TEXT = 3, 4


class _PathTold(NamedTuple):
    """A published path."""

    task: TaskId | None
    """None: there is none, and an empty one was published."""


class Overlay:
    """The two topics of the overlay, fed with frames."""

    def __init__(self, supervisor: Supervisor, listeners: Listeners, frame_id: str) -> None:
        self._supervisor = supervisor
        self._frame_id = frame_id
        self._listeners = listeners
        self._drawn: DrawnPath | None = None
        """The path of the task that is not ended; None: there is none."""
        self._path_told: _PathTold | None = None
        """What was published of the path; None: nothing since somebody listens."""
        self._told_at: Instant | None = None
        self._told: object = None
        """What the last overlay was made of."""

    def offered(self) -> tuple[OfferedTopic, ...]:
        """Return the topics."""
        types = {OVERLAY: "visualization_msgs/msg/MarkerArray", PATH: "nav_msgs/msg/Path"}
        return tuple(
            OfferedTopic(name, type_name, OWN_NODE, False, latched=name == PATH, on_demand=True)
            for name, type_name in types.items()
        )

    def last(self) -> Fields | None:
        """Return the path as it was published, for who listens from now on; None: it is to come."""
        frame = self._supervisor.frames.newest
        if frame is None or self._path_told is None or self._path_told != self._path_now():
            return None
        return self._path_message(frame)

    def take(self, frames: FrameFeed) -> None:
        """Publish what has to be published with the newest frame."""
        hears_path, hears_overlay = map(self._listeners.hears, (PATH, OVERLAY))
        frame = frames.newest
        if not hears_path:
            self._path_told = None
        if frame is None or not (hears_path or hears_overlay):
            self._drawn = None
            return
        self._draw(frame.task)
        path = self._path_now()
        if hears_path and path is not None and path != self._path_told:
            self._path_told = path
            self._listeners.send(PATH, self._path_message(frame))
        if hears_overlay and self._is_due(frame):
            self._told_at, self._told = frame.at, _what_matters(frame, self._drawn)
            self._listeners.send(OVERLAY, {"markers": list(self._markers(frame))})

    def _draw(self, task: TaskView | None) -> None:
        """Go on with the drawing of the path, a few milliseconds at most."""
        if task is None or task.ended_at is not None:
            self._drawn = None
        elif self._drawn is None or self._drawn.task != task.id:
            path = self._supervisor.core.driving.path_of(task.id)
            self._drawn = DrawnPath(task, path)
        elif not self._drawn.is_done:
            self._drawn.go_on()

    def _path_now(self) -> _PathTold | None:
        """Return what is to be published of the path; None: it is still being drawn."""
        drawn = self._drawn
        if drawn is None:
            return _PathTold(None)
        return _PathTold(drawn.task) if drawn.is_done else None

    def _path_message(self, frame: Frame) -> Fields:
        head = self._header(frame)
        return {"header": head, "poses": [] if self._drawn is None else self._drawn.poses(head)}

    def _is_due(self, frame: Frame) -> bool:
        """Tell whether an overlay is published: after a change, and else once a second."""
        if self._told_at is None:
            return True
        since = frame.at - self._told_at
        if since < _AT_MOST_EVERY:
            return False
        return since >= _AT_LEAST_EVERY or _what_matters(frame, self._drawn) != self._told

    def _header(self, frame: Frame) -> Fields:
        stamped = header(self._supervisor.clock, frame.at)
        return {**stamped, "frame_id": self._frame_id}

    def _markers(self, frame: Frame) -> Iterator[Fields]:
        """Yield all markers; what is not there is removed, whatever was drawn before."""
        head, vehicle = self._header(frame), frame.vehicle
        scale = self._supervisor.approach_limits.vehicle.scale
        task, drawn = frame.task, self._drawn
        lines: tuple[list[Fields], list[Fields]] = ([], [])
        if task is not None and drawn is not None and drawn.is_done:
            lines = drawn.lines(task)
        for drawn_as, line in zip((_DONE, _AHEAD), lines, strict=True):
            look = drawn_as.scaled(scale)
            yield marker(head, look, points=line) if line else no_marker(head, look)
        if vehicle.lookahead is None:
            yield no_marker(head, _LOOKAHEAD)
        else:
            there = Pose(vehicle.lookahead.x_m, vehicle.lookahead.y_m, 0.0)
            yield marker(head, _LOOKAHEAD.scaled(scale), pose(there))
        yield from _vehicle_and_text(head, frame, scale)


def _vehicle_and_text(head: Fields, frame: Frame, scale: float) -> Iterator[Fields]:
    state, color = frame.vehicle.state, _COLORS[frame.system_state.state]
    body = Look(_VEHICLE, Kind.CUBE, _BODY, color._replace(a=0.6)).scaled(scale)
    # Without a pose, the text is at the origin.
    at = Pose(0.0, 0.0, 0.0) if state is None else state.pose
    if state is None:
        yield no_marker(head, body)
    else:
        middle = _middle(at, scale * (_BODY.x_m / 2 - _REAR_M))
        yield marker(head, body, pose(middle, body.size.z_m / 2))
    text = Look(_TEXT, Kind.TEXT, Size(0.0, 0.0, _TEXT_M), color).scaled(scale)
    above = pose(at, body.size.z_m + _TEXT_OVER_M * scale)
    yield marker(head, text, above, text="\n".join(_words(frame)))


def _what_matters(frame: Frame, drawn: DrawnPath | None) -> object:
    vehicle = frame.vehicle
    is_drawn = drawn is not None and drawn.is_done
    return frame.system_state, frame.task, vehicle.state, vehicle.lookahead, is_drawn


def _middle(rear_axle: Pose, ahead_m: float) -> Pose:
    yaw = rear_axle.yaw_rad
    return Pose(rear_axle.x_m + ahead_m * cos(yaw), rear_axle.y_m + ahead_m * sin(yaw), yaw)


def _words(frame: Frame) -> Iterator[str]:
    """Yield what the text says, line by line."""
    yield _first_line(frame.system_state, frame.vehicle)
    task = frame.task
    if task is not None:
        yield _line(f"task {task.id} {task.status}, {task.progress:.0%} of {task.length_m:.0f} m")
        if task.reason:
            yield _line(task.reason)
    reasons = frame.system_state.reasons
    for reason in islice(reasons, _MOST_ERRORS):
        yield _line(f"{reason.code}: {reason.message}")
    if len(reasons) > _MOST_ERRORS:
        yield f"and {len(reasons) - _MOST_ERRORS} more"


def _first_line(system_state: SystemStateView, vehicle: VehicleView) -> str:
    if vehicle.state is None:
        return f"{system_state.state}, pose unknown"
    return f"{system_state.state}, {vehicle.state.speed_mps:.1f} m/s"


def _line(words: str) -> str:
    return words if len(words) <= _LONGEST_LINE else f"{words[: _LONGEST_LINE - 3]}..."
