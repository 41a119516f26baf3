"""The known state of the robot, as a pure fold of the frames of the stream."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

Json = Mapping[str, Any]

_NOTES_KEPT = 20


@dataclass(frozen=True, slots=True)
class Note:
    """The text of an event."""

    at: str
    """Time as in frames."""
    words: str


@dataclass(frozen=True, slots=True)
class Robot:
    """The known state of the robot; before the first frame, nothing is known."""

    model: str = ""
    """Name of the model file; empty: not known."""
    of_graph: bool = False
    """Whether this was observed in a ROS 2 graph, so that only parts are known."""
    is_settled: bool = False
    """Of a graph: whether all that can be known soon is known."""
    epoch: str | None = None
    boot: int = 1
    """Number of the run of the service; 1: it kept nothing of earlier ones."""
    restarted_at: str | None = None
    """Time of a restart of the service since the monitor runs; None: there was none."""
    at: str | None = None
    """Time of the newest frame."""
    system_state: Json | None = None
    parts: Mapping[str, Json] | None = None
    """By name, systems before nodes."""
    signals: Mapping[str, Json] | None = None
    task: Json | None = None
    """The current task, or the one that ended last."""
    vehicle: Json | None = None
    holds: Mapping[str, Json] | None = None
    """By owner, the oldest first."""
    errors: Mapping[str, Json] = field(default_factory=dict)
    """By name, those that are not normal."""
    reactions: Mapping[str, Json] = field(default_factory=dict)
    """All, by name."""
    devices: Mapping[str, Json] = field(default_factory=dict)
    """The other computers of the robot, by name; empty: it has one computer."""
    this_device: Json | None = None
    """Which device the service runs on, and whose word counts; None: it is no device."""
    emergency_stop: Json | None = None
    last_event_id: int = 0
    notes: tuple[Note, ...] = ()
    """The newest notable events, in order."""

    @property
    def current_task(self) -> Json | None:
        """Return the task that has not ended, if there is one."""
        return None if self.task is None or self.task["ended_at"] else self.task

    @property
    def is_whole(self) -> bool:
        """Tell whether everything is known."""
        if self.of_graph:
            return self.is_settled
        known = (self.system_state, self.parts, self.signals, self.holds, self.emergency_stop)
        return None not in known

    def as_json(self) -> dict[str, Any]:
        """Return the known state; each member has the form of the HTTP API."""
        if self.of_graph:
            return {"at": self.at, "parts": self.parts}
        return {
            "at": self.at,
            "system_state": self.system_state,
            "parts": self.parts,
            "signals": self.signals,
            "task": self.task,
            "vehicle": self.vehicle,
            "emergency_stop": self.emergency_stop,
            "holds": list((self.holds or {}).values()),
            "errors": list(self.errors.values()),
            "reactions": list(self.reactions.values()),
            "devices": list(self.devices.values()),
            "this_device": self.this_device,
        }


def fold(robot: Robot, frame: Json) -> Robot:
    """Return the known state after one more frame; frames of unknown types are ignored.

    Args:
        robot: The state before; it is not changed.
        frame: Of the stream.
    """
    folder = _FOLDERS.get(frame["type"])
    return robot if folder is None else folder(robot, frame)


def _hello(robot: Robot, frame: Json) -> Robot:
    """Continue, or start again: after a restart of the service the earlier state is void."""
    # A service of an earlier version does not name it.
    model = frame.get("model", "")
    if robot.epoch in (None, frame["epoch"]):
        # Errors that ended without contact are not told: the next frame has all that are on.
        known = replace(robot, epoch=frame["epoch"], boot=frame["boot"], errors={})
        return replace(known, model=model)
    begun = Robot(model, epoch=frame["epoch"], boot=frame["boot"], restarted_at=frame["started_at"])
    if begun.boot > 1:
        # Events go on, and one of them tells what was restored.
        return replace(begun, last_event_id=robot.last_event_id, notes=robot.notes)
    note = Note(frame["started_at"], "the service was restarted: earlier tasks and holds are gone")
    return replace(begun, notes=_kept((*robot.notes, note)))


def _state(robot: Robot, frame: Json) -> Robot:
    return replace(
        robot,
        at=frame["at"],
        system_state=frame.get("system_state", robot.system_state),
        parts=_merged(robot.parts, frame.get("parts")),
        signals=_merged(robot.signals, frame.get("signals")),
        task=frame.get("task", robot.task),
        vehicle=frame.get("vehicle", robot.vehicle),
        holds=frame.get("holds", robot.holds),
        errors=_open_ones(robot.errors, frame.get("errors", {})),
        reactions={**robot.reactions, **frame.get("reactions", {})},
        devices={**robot.devices, **frame.get("devices", {})},
        this_device=frame.get("this_device", robot.this_device),
        emergency_stop=frame.get("emergency_stop", robot.emergency_stop),
    )


def _graph(robot: Robot, frame: Json) -> Robot:
    """Take parts that were observed in a ROS 2 graph; the frame is made on this machine."""
    return replace(
        robot,
        model=frame["model"],
        of_graph=True,
        is_settled=frame["settled"],
        at=frame["at"],
        parts=_merged(robot.parts, frame["parts"]),
    )


def _merged(
    known: Mapping[str, Json] | None, changed: Mapping[str, Json] | None
) -> Mapping[str, Json] | None:
    """Merge the changed members of a frame; the first frame has all members, in order."""
    return known if changed is None else {**(known or {}), **changed}


def _open_ones(known: Mapping[str, Json], changed: Mapping[str, Json]) -> Mapping[str, Json]:
    """Merge changed errors; one that ended is told once more, as normal."""
    if not changed:
        return known
    merged = {**known, **changed}
    return {
        name: error
        for name, error in merged.items()
        if error["state"] != "normal" or error["shelved_until_at"] is not None
    }


def _event(robot: Robot, event: Json) -> Robot:
    if event["id"] <= robot.last_event_id:
        return robot
    robot = replace(robot, last_event_id=event["id"])
    if not event["notable"]:
        return robot
    return replace(robot, notes=_kept((*robot.notes, Note(event["at"], event["words"]))))


def _gap(robot: Robot, gap: Json) -> Robot:
    """Skip missing events: the next frame shows their effects.

    Without an end they are of a run that the service does not know, and others follow.
    """
    to = gap["to"]
    return replace(robot, last_event_id=0 if to is None else max(robot.last_event_id, to))


def _kept(notes: tuple[Note, ...]) -> tuple[Note, ...]:
    return notes[-_NOTES_KEPT:]


_FOLDERS: Mapping[str, Callable[[Robot, Json], Robot]] = {
    "hello": _hello,
    "state": _state,
    "graph": _graph,
    "event": _event,
    "gap": _gap,
}
