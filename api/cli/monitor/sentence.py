"""The sentences at the top: state of the robot, emergency stop, connection, storage, restart.

`web/js/base/state_sentence.js` has the same rules; one test runs both over the same cases.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from api.cli.error_lines import error_name, is_pressing
from api.cli.monitor import words
from api.cli.monitor.device_words import not_stopped_words, stop_places
from api.cli.monitor.part_problems import part_problems
from api.cli.monitor.store import Robot
from api.cli.monitor.view import Level, View, seconds_of

Json = Mapping[str, Any]

STANDSTILL_MPS = 0.05
"""Below this a vehicle stands; the service uses the same limit."""

_RESTART_TOLD_S = 600.0
_NAMED = 3
_ALARMS = {"STILL_MOVING": "STILL MOVING", "STANDSTILL_UNKNOWN": "STANDSTILL UNKNOWN"}
"""Words for a vehicle that should stand and does not, or of which it is not known."""


@dataclass(frozen=True, slots=True)
class Sentence:
    """A state and its reasons, the most important one first."""

    word: str
    """IDLE, RUNNING, STOPPING, HELD, ABORTED, ERROR, WAS ERROR, or the state of the connection."""
    text: str
    more: tuple[str, ...] = ()
    """Further reasons."""
    level: Literal["calm", "held", "aborted", "attention", "error"] = "calm"


def contact_sentence(view: View) -> Sentence | None:
    """Return the state of the connection; None while it is good."""
    contact, at = view.contact, view.robot.at
    if contact.level is Level.LIVE:
        return None
    if contact.level is not Level.LOST:
        return Sentence("CONNECTING", contact.why or "waiting for the first values")
    began = words.time_of_day(view.now_s - contact.silence_s)
    since = f"since {began} ({words.duration(contact.silence_s)}), reconnecting"
    old = "" if at is None else f"values shown are from {words.time_of_day(seconds_of(at))}"
    more = tuple(text for text in (contact.why, old) if text)
    return Sentence("NO CONTACT", since, more, "error")


def state_sentence(view: View) -> Sentence | None:
    """Return the current or last known state of the robot; None: no state was received."""
    robot = view.robot
    if robot.system_state is None:
        return None
    said = _error_sentence(robot) if _is_error(robot) else _calm_sentence(robot)
    if view.contact.level is Level.LIVE:
        return said
    return Sentence(f"WAS {said.word}", said.text, said.more, said.level)


def absence_sentence(view: View) -> Sentence | None:
    """Return which nodes of a ROS 2 graph do not answer; None: all do, or a service tells."""
    robot = view.robot
    if not robot.of_graph:
        return None
    nodes = [part for part in (robot.parts or {}).values() if part["kind"] == "node"]
    away = [part["name"] for part in nodes if not part["reachable"]]
    if not away:
        return None
    named = ", ".join(away[:_NAMED])
    others = f" and {len(away) - _NAMED} more" if len(away) > _NAMED else ""
    text = f"{len(away)} of {len(nodes)} nodes: {named}{others}"
    if not robot.is_settled:
        return Sentence("LOOKING FOR", text)
    if len(away) < len(nodes):
        return Sentence("ABSENT", text, level="attention")
    hint = "no node answers: is this the ROS_DOMAIN_ID of the robot, and the model that it runs?"
    return Sentence("ABSENT", text, (hint,), "attention")


def stop_sentence(view: View) -> Sentence | None:
    """Return that the emergency stop is engaged; None while it is not."""
    stop = view.robot.emergency_stop
    if stop is None or not stop["engaged"]:
        return None
    is_live = view.contact.level is Level.LIVE
    by = f", by {stop['by']}" if stop["by"] else ""
    why = f": {stop['reason']}" if stop["reason"] else ""
    since = f"for {words.duration(view.known_for_s(stop['since_at']))}"
    engaged = "engaged" if is_live else "was engaged"
    where = f" {places}" if (places := stop_places(stop)) else ""
    text = f"{engaged}{where}{why}, {since}{by}, {standstill_words(view.robot)}"
    away = not_stopped_words(view.robot.devices)
    return Sentence("EMERGENCY STOP", text, (away,) if away else (), "error")


def standstill_words(robot: Robot) -> str:
    """Return whether the vehicle stands under the emergency stop."""
    if robot.this_device is not None:
        return "the vehicle is the supervisor's to stop"
    moves = _moving_at(robot)
    if robot.system_state is not None and alarm_of(robot.system_state):
        at = "may be moving" if moves is None else f"still moves at {words.speed(moves)}"
        return f"use the hardware stop: the vehicle {at}"
    if moves is not None:
        return f"the vehicle moves at {words.speed(moves)}"
    is_known = robot.vehicle is not None and robot.vehicle["speed_mps"] is not None
    if not is_known or "vehicle" in _holds(robot):
        return "it is not known whether the vehicle stands"
    stop = robot.emergency_stop
    stands = stop is not None and stop["standstill_at"]
    return "the vehicle is at a standstill" if stands else "no standstill yet"


def storage_sentence(view: View) -> Sentence | None:
    """Return that what happens is not stored; None while it is."""
    fault = (view.robot.system_state or {}).get("storage_fault")
    if fault is None:
        return None
    if view.contact.level is not Level.LIVE:
        return Sentence("STORAGE FAILED", fault, level="attention")
    text = f"{fault}; a restart may forget what you ask now"
    return Sentence("STORAGE FAILS", text, level="attention")


def restart_sentence(view: View) -> Sentence | None:
    """Return that the service was restarted, for 10 min after a restart; else None."""
    at = view.robot.restarted_at
    if at is None or view.age_s(at) > _RESTART_TOLD_S:
        return None
    when = words.time_of_day(seconds_of(at))
    is_kept = view.robot.boot > 1
    kept = "nothing moves before somebody asks" if is_kept else "earlier tasks and holds are gone"
    return Sentence("RESTARTED", f"at {when}; {kept}")


def _is_error(robot: Robot) -> bool:
    return robot.system_state is not None and robot.system_state["state"] == "ERROR"


def _error_sentence(robot: Robot) -> Sentence:
    state, task = robot.system_state or {}, robot.current_task
    texts = [reason["message"] for reason in state["reasons"]] or [", ".join(state["errors"])]
    first, *others = texts
    text = first if task is None else f"{first}, task {task['id']} is {_STANDS[task['status']]}"
    kept = _held_by([hold for hold in _holds(robot).values() if hold["owner"] != "error"])
    also = (f"also {kept}",) if kept else ()
    found = (*_movement(robot), *part_problems(robot.parts or {}, robot.devices))
    more = (*others, *found, *also, *_aborted(robot))
    return Sentence(alarm_of(state) or "ERROR", text, more, "error")


def _calm_sentence(robot: Robot) -> Sentence:
    state = robot.system_state or {}
    word, text = _activity(robot)
    reasons = [reason["message"] for reason in state["reasons"]]
    found = [*_movement(robot), *part_problems(robot.parts or {}, robot.devices)]
    found = [*reasons, *(found or _pressing(robot))]
    text = "; ".join([*found[:1], text])
    more = tuple(found[1:])
    if alarm := alarm_of(state):
        return Sentence(alarm, text, more, "error")
    is_unable = not _holds(robot).keys().isdisjoint(_UNABLE)
    return Sentence(
        word, text, more, "attention" if found or is_unable else _LEVELS.get(word, "calm")
    )


def _pressing(robot: Robot) -> list[str]:
    """Return the urgent errors of a robot that looks well otherwise."""
    texts = [_error_words(error) for error in robot.errors.values() if is_pressing(error)]
    left = len(texts) - _NAMED
    if left <= 0:
        return texts
    return [*texts[:_NAMED], f"{left} more such {'error' if left == 1 else 'errors'}"]


def _error_words(error: Json) -> str:
    name = error_name(error)
    return f"{name}: {error['message']}" if error["message"] else name


def alarm_of(state: Json) -> str | None:
    """Return the word for a vehicle that should stand and does not; None: there is none."""
    reasons = state["reasons"]
    return _ALARMS.get(reasons[0].get("code", "")) if reasons else None


def _activity(robot: Robot) -> tuple[str, str]:
    """Return what the robot does apart from what is wrong; a held task is never called running."""
    task, held = robot.current_task, _held_by(list(_holds(robot).values()))
    if task is None:
        status = (robot.system_state or {})["task_status"]
        if status in _UNKNOWN_TASKS:
            return _UNKNOWN_TASKS[status]
        text = next(_aborted(robot), None)
        then = f"; a new one would be {held}" if held else ""
        return ("IDLE", f"no task{then}") if text is None else ("ABORTED", f"{text}{then}")
    at, why = f"task {task['id']} at {words.percent(task['progress'])}", held or task["reason"]
    text = f"{at}, {why}" if why else at
    if task["status"] == "PAUSING":
        moves = _moving_at(robot)
        return "STOPPING", text if moves is None else f"{text}, still at {words.speed(moves)}"
    if held:
        return "HELD", text
    if task["status"] == "PAUSED":
        return "PAUSED", text
    far = f"{words.percent(task['progress'])}, {words.waypoint_words(task)}"
    return "RUNNING", f"task {task['id']} {far}"


def _held_by(holds: Sequence[Json]) -> str:
    """Return "held by gate (the gate is shut), operator and loading"; nothing without holds."""
    named = [_hold_words(hold) for hold in holds[:_NAMED]]
    if len(holds) > _NAMED:
        named.append(f"{len(holds) - _NAMED} more")
    if not named:
        return ""
    *others, last = named
    return f"held by {', '.join(others)} and {last}" if others else f"held by {last}"


def _hold_words(hold: Json) -> str:
    owner, reason = hold["owner"], hold["reason"]
    # The name of the hold of a restart says why; its reason says how it ends, in the list of holds.
    return f"{owner} ({reason})" if reason and owner != "restart" else owner


def _aborted(robot: Robot) -> Iterator[str]:
    task = robot.task
    if task is not None and task["ended_at"] and task["status"] == "ABORTED":
        why = f": {task['reason']}" if task["reason"] else ""
        at = words.time_of_day(seconds_of(task["ended_at"]))
        yield f"task {task['id']} was aborted at {at}{why}"


def _movement(robot: Robot) -> Iterator[str]:
    """Yield that the vehicle moves though no task drives or stops it."""
    # An alarm tells already how fast it moves.
    moves = None if alarm_of(robot.system_state or {"reasons": ()}) else _moving_at(robot)
    task = robot.current_task
    status = None if task is None else task["status"]
    drives = status == "PAUSING" or (status == "RUNNING" and not _holds(robot))
    if moves is not None and (not drives or _is_error(robot)):
        yield f"the vehicle moves at {words.speed(moves)}"


def _moving_at(robot: Robot) -> float | None:
    """Return the speed of a vehicle that is known to move, m/s; None: it stands, or unknown."""
    speed = None if robot.vehicle is None else robot.vehicle["speed_mps"]
    # The hold is set while there is no pose that is recent enough.
    if speed is None or "vehicle" in _holds(robot) or abs(speed) < STANDSTILL_MPS:
        return None
    return abs(float(speed))


def _holds(robot: Robot) -> Mapping[str, Json]:
    return robot.holds or {}


_LEVELS: Mapping[str, Literal["held", "aborted"]] = {"HELD": "held", "ABORTED": "aborted"}
"""Words with a level of their own: nothing is wrong, and yet a person has to do something."""
_STANDS = {"RUNNING": "running", "PAUSING": "stopping", "PAUSED": "paused"}
_UNABLE = ("vehicle", "drive_process", "navigation")
"""The holds of a vehicle that cannot be driven: without a pose, commands or a controller."""
_UNKNOWN_TASKS = {
    "RUNNING_TASK": ("RUNNING", "the task is running"),
    "PAUSED_TASK": ("PAUSED", "the task is paused"),
}
"""Of a task that no frame has told yet."""
