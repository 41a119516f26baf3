"""The sentences at the top: state of the robot, emergency stop, connection, restart."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from api.cli.monitor import words
from api.cli.monitor.view import Level, View, seconds_of

Json = Mapping[str, Any]

_TASKS = {
    "NO_TASK": "no task",
    "PAUSED_TASK": "the task is paused",
    "RUNNING_TASK": "the task is running",
}


_RESTART_TOLD_S = 600.0


@dataclass(frozen=True, slots=True)
class Sentence:
    """A state and its reasons, the most important one first."""

    word: str
    """IDLE, RUNNING, ERROR, WAS ERROR, or the state of the connection."""
    text: str
    more: tuple[str, ...] = ()
    """Further reasons."""


def contact_sentence(view: View) -> Sentence | None:
    """Return the state of the connection; None while it is good."""
    contact, at = view.contact, view.robot.at
    if contact.level is Level.LIVE and view.robot.system_state is not None:
        return None
    if contact.level is not Level.LOST:
        return Sentence("CONNECTING", contact.why or "waiting for the first values")
    began = words.time_of_day(view.now_s - contact.silence_s)
    since = f"since {began} ({words.duration(contact.silence_s)}), reconnecting"
    old = "" if at is None else f"values shown are from {words.time_of_day(seconds_of(at))}"
    more = tuple(text for text in (contact.why, old) if text)
    return Sentence("NO CONTACT", since, more)


def state_sentence(view: View) -> Sentence | None:
    """Return the current or last known state of the robot; None: no state was received."""
    state, task = view.robot.system_state, view.robot.current_task
    if state is None:
        return None
    word = state["state"] if view.contact.level is Level.LIVE else f"WAS {state['state']}"
    if state["state"] != "ERROR":
        text = _TASKS.get(state["task_status"], "") if task is None else _task_words(task)
        return Sentence(word, text)
    first, *more = [reason["message"] for reason in state["reasons"]] or [
        ", ".join(state["errors"])
    ]
    paused = "" if task is None else f"; task {task['id']} is {_STANDS[task['status']]}"
    return Sentence(word, first + paused, tuple(more))


def stop_sentence(view: View) -> Sentence | None:
    """Return that the emergency stop is engaged; None while it is not."""
    stop = view.robot.emergency_stop
    if stop is None or not stop["engaged"]:
        return None
    by = f", by {stop['by']}" if stop["by"] else ""
    why = f": {stop['reason']}" if stop["reason"] else ""
    since = f"for {words.duration(view.age_s(stop['since_at']))}"
    stands = "the vehicle is at a standstill" if stop["standstill_at"] else "no standstill yet"
    return Sentence("EMERGENCY STOP", f"engaged{why}, {since}{by}, {stands}")


def restart_sentence(view: View) -> Sentence | None:
    """Return that the service was restarted, for 10 min after a restart; else None."""
    at = view.robot.restarted_at
    if at is None or view.age_s(at) > _RESTART_TOLD_S:
        return None
    when = words.time_of_day(seconds_of(at))
    return Sentence("RESTARTED", f"at {when}; earlier tasks and holds are gone")


def _task_words(task: Json) -> str:
    name, why = f"task {task['id']}", f": {task['reason']}" if task["reason"] else ""
    if task["status"] == "PAUSING":
        return f"{name} is stopping{why}"
    if task["status"] == "PAUSED":
        return f"{name} at {words.percent(task['progress'])} is paused{why}"
    return f"{name} {words.percent(task['progress'])}, {words.waypoint_words(task)}"


_STANDS = {"RUNNING": "running", "PAUSING": "stopping", "PAUSED": "paused"}
