"""What of a robot has to change before a log gets a new picture."""

from collections.abc import Hashable, Mapping
from typing import Any

from api.cli.monitor.store import Robot

Json = Mapping[str, Any]


def standing(robot: Robot) -> Hashable:
    """Return what is equal as long as nothing has happened: values, ages and ways do not count."""
    state, task, stop = robot.system_state, robot.task, robot.emergency_stop
    return (
        robot.epoch,
        None if state is None else (state["state"], *state["errors"]),
        tuple(_part(part) for part in (robot.parts or {}).values()),
        None if task is None else (task["id"], task["status"]),
        None if stop is None else (stop["engaged"], stop["standstill_at"]),
        tuple((hold["owner"], hold["reason"]) for hold in robot.holds or ()),
    )


def _part(part: Json) -> Hashable:
    pairs = (part["target"], part["effective_target"], part["actual"])
    labels = tuple(None if pair is None else (pair["state"], pair["mode"]) for pair in pairs)
    return (part["name"], labels, part["converged"], part.get("reachable"))
