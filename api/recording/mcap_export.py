"""Recorded robots as channels of MCAP: what frames showed 20 times a second, and the events."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from api.http.schemas.health import EmergencyStopJson, StreamedSignalJson, SystemStateJson
from api.http.schemas.parts import PartJson
from api.http.schemas.tasks import HoldJson, TaskJson, VehicleJson
from api.recording import foxglove
from api.recording.mcap_file import McapFile
from api.recording.plain_schema import Schema, fitted, plain_schema
from domain.identifiers import TaskId
from domain.snapshot import SignalView, TaskView
from domain.timebase import Instant
from service.event_log import EventReader, Gap
from service.frame_feed import Frame
from service.frame_publisher import PERIOD
from service.recorded_pieces import Piece, offset_of
from service.replayed_robot import ReplayedRobot

_MOST_POSES = 1_000
"""Of a path; more are thinned out."""
_EVENTS_AT_ONCE = 100_000

_SCHEMAS: Mapping[str, Schema] = {
    "pilothouse.SystemState": plain_schema(SystemStateJson),
    "pilothouse.Part": plain_schema(PartJson),
    "pilothouse.Task": plain_schema(TaskJson),
    "pilothouse.Vehicle": plain_schema(VehicleJson),
    "pilothouse.EmergencyStop": plain_schema(EmergencyStopJson),
    "pilothouse.Holds": {
        "type": "object",
        "properties": {"items": {"type": "array", "items": plain_schema(HoldJson)}},
        "required": ["items"],
    },
    "foxglove.Log": foxglove.LOG_SCHEMA,
    "foxglove.PoseInFrame": foxglove.POSE_SCHEMA,
    "foxglove.PosesInFrame": foxglove.PATH_SCHEMA,
}


def _signal_schema() -> Schema:
    """Return the schema of a signal: its value as a number for plots, or else as text."""
    schema = plain_schema(StreamedSignalJson)
    members = {
        **schema["properties"],
        "value": {"type": "number", "description": "true is 1, false is 0; left out: none"},
        "text": {"type": "string", "description": "The value, if it is text"},
    }
    required = [name for name in schema["required"] if name != "value"]
    return {**schema, "properties": members, "required": required}


_SIGNAL_SCHEMA = _signal_schema()


def export_mcap(
    pieces: Iterable[Piece],
    version: str,
    path: Path,
    first_event: int | None,
    tell: Callable[[Instant, int], None],
) -> int:
    """Write pieces of a record to a file, and return how many messages it has.

    Args:
        pieces: In order.
        version: This release of Pilothouse.
        path: Of the file, which appears when it is complete.
        first_event: Id of the event that it begins with; None: all.
        tell: Called with each tick: its time in ns since 1970, and the messages so far.

    Raises:
        NoMcapError: mcap is not installed.
        PilothouseError: Something cannot be replayed.
        OSError: The file cannot be written.
    """
    with McapFile(path, f"pilothouse {version}") as file:
        for piece in pieces:
            robot = ReplayedRobot(piece, version)
            channels = _Channels(file, robot, offset_of(piece.boot), first_event)
            tick: Instant | None = None
            while (due := robot.next_at) is not None:
                # Ticks in which nothing was recorded show nothing new.
                tick = due if tick is None else tick + max(1, -((tick - due) // PERIOD)) * PERIOD
                robot.advance_to(tick)
                channels.note(tick)
                tell(tick + offset_of(piece.boot), file.messages)
        return file.messages


class _Channels:
    """Writes what a robot shows."""

    def __init__(
        self, file: McapFile, robot: ReplayedRobot, offset: int, first_event: int | None
    ) -> None:
        self._file = file
        self._robot = robot
        self._supervisor = robot.supervisor
        self._offset = offset
        log = robot.supervisor.events
        self._events = EventReader(log, log.before)
        self._first_event = first_event or 0
        self._last_ns = 0
        self._task: TaskId | None = None

    def note(self, tick: Instant) -> None:
        """Write what is new at a tick."""
        log = self._supervisor.events
        for event in self._events.take(_EVENTS_AT_ONCE):
            if not isinstance(event, Gap) and event.id >= self._first_event:
                at_ns = event.at + self._offset
                level = foxglove.INFO if event.event.notable else foxglove.DEBUG
                message = foxglove.log_message(at_ns, level, event.kind, event.event.words)
                self._write("/events", "foxglove.Log", at_ns, message)
        if log.newest >= self._first_event:
            self._robot.publish()
            frame = self._supervisor.frames.newest
            if frame is not None:
                self._write_frame(frame, tick + self._offset)

    def _write_frame(self, frame: Frame, at_ns: int) -> None:
        clock = self._supervisor.clock
        state = SystemStateJson.of(frame.system_state, frame.seq, frame.at, frame.simulated, clock)
        self._write_model("/system_state", "pilothouse.SystemState", at_ns, state)
        for part, view in frame.parts.items():
            self._write_model(f"/parts/{part}", "pilothouse.Part", at_ns, PartJson.of(view, clock))
        for name, signal in frame.signals.items():
            self._write_signal(f"/signals/{name}", at_ns, signal)
        if frame.holds_changed:
            items = (HoldJson.of(hold, clock) for hold in frame.holds.values())
            holds = [item.model_dump(mode="json") for item in items]
            self._write("/holds", "pilothouse.Holds", at_ns, {"items": holds})
        if frame.emergency_stop_changed:
            stop = EmergencyStopJson.of(frame.emergency_stop, clock)
            self._write_model("/emergency_stop", "pilothouse.EmergencyStop", at_ns, stop)
        if frame.task_changed and frame.task is not None:
            self._write_task(frame.task, at_ns)
        if frame.vehicle_changed:
            limits = self._supervisor.core.driving.limits
            vehicle = VehicleJson.of(frame.vehicle, limits, clock)
            self._write_model("/vehicle", "pilothouse.Vehicle", at_ns, vehicle)
            if frame.vehicle.state is not None:
                pose = foxglove.pose_message(at_ns, frame.vehicle.state.pose)
                self._write("/pose", "foxglove.PoseInFrame", at_ns, pose)

    def _write_task(self, task: TaskView, at_ns: int) -> None:
        shown = TaskJson.of(task, self._supervisor.clock)
        self._write_model("/task", "pilothouse.Task", at_ns, shown)
        if task.id != self._task:
            self._task = task.id
            points = self._supervisor.core.driving.path_of(task.id).waypoints
            every = -(-len(points) // _MOST_POSES)
            poses = foxglove.path_message(at_ns, points[::every].tolist())
            self._write("/path", "foxglove.PosesInFrame", at_ns, poses)

    def _write_signal(self, topic: str, at_ns: int, view: SignalView) -> None:
        shown = StreamedSignalJson.of(view, self._supervisor.clock).model_dump(mode="json")
        value = shown.pop("value")
        message = fitted(shown, _SIGNAL_SCHEMA)
        if isinstance(value, str):
            message["text"] = value
        elif value is not None:
            message["value"] = float(value)
        if not self._file.has(topic):
            self._file.add_channel(topic, "pilothouse.Signal", _SIGNAL_SCHEMA)
        self._file.write(topic, self._in_order(at_ns), message)

    def _write_model(self, topic: str, kind: str, at_ns: int, shown: BaseModel) -> None:
        self._write(topic, kind, at_ns, fitted(shown.model_dump(mode="json"), _SCHEMAS[kind]))

    def _write(self, topic: str, kind: str, at_ns: int, message: Mapping[str, Any]) -> None:
        if not self._file.has(topic):
            self._file.add_channel(topic, kind, _SCHEMAS[kind])
        self._file.write(topic, self._in_order(at_ns), message)

    def _in_order(self, at_ns: int) -> int:
        """Return the time that a message is filed under: a timer may be told after its tick."""
        self._last_ns = max(self._last_ns, at_ns)
        return self._last_ns
