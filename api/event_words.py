"""What happened, in words for an operator; what only the program needs to know is left out."""

from collections.abc import Callable, Collection, Mapping
from typing import Any

from domain.events import Event

Data = Mapping[str, Any]


def event_words(event: Event, systems: Collection[str]) -> str | None:
    """Return what happened in words, or None if it is not for an operator.

    Args:
        event: What happened.
        systems: Names of the systems. What becomes of their nodes one by one is left out.
    """
    data = event.data
    if event.kind == "part.actual_changed":
        is_told = data["part"] in systems
        return f"{data['part']}: {data['was']} -> {data['actual']}" if is_told else None
    words = _WORDS.get(event.kind)
    return None if words is None else words(data)


def _state(data: Data) -> str:
    errors = ", ".join(data["errors"])
    change = data["state"] if data["state"] == data["was"] else f"{data['was']} -> {data['state']}"
    return f"{change}: {errors}" if errors else str(change)


def _because(words: str, data: Data) -> str:
    return f"{words}: {data['reason']}" if data.get("reason") else words


def _change(ending: str) -> Callable[[Data], str]:
    return lambda data: _because(f"{data['part']}: change {ending}", data)


def _task(words: str) -> Callable[[Data], str]:
    return lambda data: _because(f"task {data['task']} {words}", data)


def _ended(words: str) -> Callable[[Data], str]:
    return lambda data: _because(f"task {data['task']} {words} at {data['progress']:.0%}", data)


_WORDS: Mapping[str, Callable[[Data], str]] = {
    "system_state.changed": _state,
    "error.raised": lambda data: f"{data['error']}: {data['message']}",
    "error.cleared": lambda data: f"{data['error']} is over",
    "error.acknowledged": lambda data: f"{data['error']} is acknowledged",
    "emergency_stop.engaged": lambda data: _because("emergency stop engaged", data),
    "emergency_stop.released": lambda _: "emergency stop released",
    "emergency_stop.standstill": lambda _: "the vehicle stands after the emergency stop",
    "node.unreachable": lambda data: f"{data['node']} is not reachable",
    "node.reachable": lambda data: f"{data['node']} is reachable",
    "node.restoring": lambda data: f"{data['node']} is back, and restored to {data['target']}",
    "node.not_restored": lambda data: _because(f"{data['node']} is back, not restored", data),
    "change.succeeded": _change("succeeded"),
    "change.failed": _change("failed"),
    "change.timed_out": _change("timed out"),
    "change.superseded": _change("superseded"),
    "change.canceled": _change("canceled"),
    "task.served": lambda data: f"task {data['task']} is served, {data['length_m']:.1f} m",
    "task.started": _task("drives"),
    "task.resumed": _task("drives on"),
    "task.pausing": _task("stops"),
    "task.paused": _task("stands"),
    "task.succeeded": _ended("has succeeded"),
    "task.canceled": _ended("ends"),
    "task.aborted": _ended("is given up"),
    "hold.set": lambda data: _because(f"hold of {data['owner']}", data),
    "hold.released": lambda data: f"hold of {data['owner']} released",
}
