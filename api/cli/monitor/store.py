"""What is known of the robot, as a pure fold of the frames of the stream and of a few answers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from api.cli.monitor.latches import holds_after, stop_after

Json = Mapping[str, Any]

_NOTES_KEPT = 20


@dataclass(frozen=True, slots=True)
class Note:
    """Something that happened, in words."""

    at: str
    """As in frames."""
    words: str


@dataclass(frozen=True, slots=True)
class Robot:
    """What is known of the robot; before the first frame, nothing."""

    epoch: str | None = None
    at: str | None = None
    """Time of the newest frame."""
    system_state: Json | None = None
    parts: Mapping[str, Json] | None = None
    """By name, systems before nodes."""
    signals: Mapping[str, Json] | None = None
    task: Json | None = None
    vehicle: Json | None = None
    holds: tuple[Json, ...] | None = None
    emergency_stop: Json | None = None
    last_event_id: int = 0
    notes: tuple[Note, ...] = ()
    """The newest of what happened, in order."""

    @property
    def is_whole(self) -> bool:
        """Tell whether there is something to be said of everything."""
        known = (self.system_state, self.parts, self.signals, self.holds, self.emergency_stop)
        return None not in known

    def as_json(self) -> dict[str, Any]:
        """Return what is known, each member as the interface has it."""
        return {
            "at": self.at,
            "system_state": self.system_state,
            "parts": self.parts,
            "signals": self.signals,
            "task": self.task,
            "vehicle": self.vehicle,
            "emergency_stop": self.emergency_stop,
            "holds": self.holds,
        }


def fold(robot: Robot, message: Json) -> Robot:
    """Return what is known after one more message; one of an unknown type tells nothing.

    Args:
        robot: What is known; it is not changed.
        message: A frame of the stream, or an answer as `structure`, `holds` or `emergency_stop`.
    """
    folder = _FOLDERS.get(message["type"])
    return robot if folder is None else folder(robot, message)


def _hello(robot: Robot, frame: Json) -> Robot:
    """Go on, or begin anew: after a restart of the service nothing of before is true."""
    if robot.epoch in (None, frame["epoch"]):
        return replace(robot, epoch=frame["epoch"])
    note = Note(robot.at or "", "the service was restarted")
    return Robot(epoch=frame["epoch"], notes=_kept((*robot.notes, note)))


def _state(robot: Robot, frame: Json) -> Robot:
    at = frame["at"]
    return replace(
        robot,
        at=at,
        system_state=frame.get("system_state", robot.system_state),
        parts=_parts(robot.parts, frame.get("parts"), at),
        signals=_signals(robot.signals, frame.get("signals")),
        task=frame.get("task", robot.task),
        vehicle=frame.get("vehicle", robot.vehicle),
    )


def _parts(
    parts: Mapping[str, Json] | None, changed: Mapping[str, Json] | None, at: str
) -> Mapping[str, Json] | None:
    """Frames carry the changed parts, and may leave out what the structure told once."""
    if changed is None:
        return parts
    known = dict(parts or {})
    for name, part in changed.items():
        before = known.get(name, {})
        since = None if part["converged"] else before.get("deviation_since_at") or at
        known[name] = {"name": name, **before, "deviation_since_at": since, **part}
    return known


def _signals(
    signals: Mapping[str, Json] | None, changed: Mapping[str, Json] | None
) -> Mapping[str, Json] | None:
    return signals if changed is None else {**(signals or {}), **changed}


def _structure(robot: Robot, answer: Json) -> Robot:
    """Take the order of the parts; one that was streamed is newer than any answer."""
    streamed = robot.parts or {}
    parts = {item["name"]: streamed.get(item["name"], item) for item in answer["items"]}
    return replace(robot, parts=parts)


def _event(robot: Robot, event: Json) -> Robot:
    if event["id"] <= robot.last_event_id:
        return robot
    holds, stop = robot.holds, robot.emergency_stop
    robot = replace(
        robot,
        last_event_id=event["id"],
        holds=None if holds is None else holds_after(holds, event),
        emergency_stop=None if stop is None else stop_after(stop, event),
    )
    if not event["notable"]:
        return robot
    return replace(robot, notes=_kept((*robot.notes, Note(event["at"], event["words"]))))


def _gap(robot: Robot, gap: Json) -> Robot:
    """Events that are missing say nothing that the next frame does not say."""
    return replace(robot, last_event_id=max(robot.last_event_id, gap["to"] or 0))


def _holds(robot: Robot, answer: Json) -> Robot:
    return replace(robot, holds=tuple(answer["items"]))


def _emergency_stop(robot: Robot, answer: Json) -> Robot:
    stop = {name: value for name, value in answer.items() if name != "type"}
    return replace(robot, emergency_stop=stop)


def _kept(notes: tuple[Note, ...]) -> tuple[Note, ...]:
    return notes[-_NOTES_KEPT:]


_FOLDERS: Mapping[str, Callable[[Robot, Json], Robot]] = {
    "hello": _hello,
    "state": _state,
    "event": _event,
    "gap": _gap,
    "structure": _structure,
    "holds": _holds,
    "emergency_stop": _emergency_stop,
}
