"""Plays the vectors of smart_polaris about the task planner on anything that drives tasks."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from tests.support.polaris import Send, Vector, sends_of

TICK_MS = 50


@dataclass(frozen=True)
class Seen:
    """What a reader sees of the robot and its task."""

    state: str
    errors: frozenset[str]
    planner: str
    start_index: int | None
    """First waypoint not yet passed of the current task."""
    active_goal_start_index: int | None
    task_file: str | None
    commanded_mps: float
    last_progress: float | None
    """Of the task that was served last."""


class PlannerRobot(Protocol):
    """A fresh robot at script time 0 that the player drives; time only rises."""

    def advance_to(self, at_s: float) -> None:
        """Let script time be `at_s`."""

    def reading(self, signal: str, value: object) -> None:
        """Send a reading."""

    def serve(self, file: str) -> bool:
        """Serve a waypoint file; return whether it was taken."""

    def cancel(self) -> None:
        """Cancel the current task."""

    def controller(self, step: Mapping[str, Any]) -> None:
        """Let navigation say what the vector scripts."""

    def observe(self) -> Seen:
        """Return what is seen now."""


def play(vector: Vector, robot: PlannerRobot, expected: str) -> list[str]:
    """Play a vector and return what was seen otherwise than expected; empty: it passes."""
    failures: list[str] = []
    seen_at: dict[int, Seen] = {}
    for at_ms, act in _timeline(vector, expected):
        robot.advance_to(at_ms / 1000)
        if isinstance(act, Send):
            robot.reading(act.signal, act.value)
        elif "task" in act:
            failures += _serve_or_cancel(robot, act, at_ms)
        elif "controller" in act:
            robot.controller(act)
        else:
            seen_at[at_ms] = seen = robot.observe()
            failures += [
                f"{at_ms} ms: {key}: {act[key]}, seen {seen}"
                for key in wrong_keys(act, seen_at, seen)
            ]
    return failures


def _timeline(vector: Vector, expected: str) -> Iterator[tuple[int, Send | Mapping[str, Any]]]:
    """Yield what to do and to look at in order of time; at one instant, looks come last."""
    items: list[tuple[int, int, Send | Mapping[str, Any]]] = []
    for step in vector["steps"]:
        if "signal" in step:
            items += [(send.at_ms, 0, send) for send in sends_of(step)]
        else:
            items.append((round(step["t"] * 1000), 0, step))
    for look in vector[expected]:
        items += [(at, 1, look) for at in looks_of(look)]
    items.sort(key=lambda item: item[:2])
    return ((at, act) for at, _, act in items)


def looks_of(look: Mapping[str, Any]) -> list[int]:
    """Return the times at which an expectation has to hold, ms; every tick of a window."""
    if "t" in look:
        return [round(look["t"] * 1000)]
    first, last = round(look["from"] * 1000), round(look["to"] * 1000)
    return list(range(math.ceil(first / TICK_MS) * TICK_MS, last + 1, TICK_MS))


def _serve_or_cancel(robot: PlannerRobot, step: Mapping[str, Any], at_ms: int) -> list[str]:
    if step["task"] == "cancel":
        robot.cancel()
        return []
    # An error of the original's service call is a refusal here; so is what a safer one refuses.
    wanted = step["expect"].get("success", False) and step["file"] not in UNSAFE_FILES
    taken = robot.serve(step["file"])
    return [] if taken is wanted else [f"{at_ms} ms: {step['file']}: taken: {taken}"]


UNSAFE_FILES = frozenset({"nan.csv", "../fixtures/line_21.csv"})
"""Served by the original, refused by a safer successor."""


def wrong_keys(look: Mapping[str, Any], seen_at: Mapping[int, Seen], seen: Seen) -> Iterator[str]:
    """Yield the keys of an expectation that do not hold.

    Args:
        look: What is expected.
        seen_at: What was seen at the times looked at so far, ms.
        seen: What is seen now.
    """
    checks: Mapping[str, Callable[[Any], bool]] = {
        "state": lambda value: seen.state == value,
        "errors": lambda value: seen.errors == frozenset(value),
        "planner": lambda value: seen.planner == value,
        "start_index": lambda value: _index_fits(value, seen.start_index, seen_at),
        "active_goal_start_index": lambda value: seen.active_goal_start_index == value,
        "task_file": lambda value: seen.task_file == value,
        "commanded_speed": lambda value: (seen.commanded_mps > 0) is (value == "positive"),
        "last_progress": lambda value: (
            seen.last_progress is not None and abs(seen.last_progress - value) <= 5e-4
        ),
    }
    for key, value in look.items():
        if key not in ("t", "from", "to") and not checks[key](value):
            yield key


def _index_fits(wanted: Any, index: int | None, seen_at: Mapping[int, Seen]) -> bool:  # noqa: ANN401
    if index is None:
        return False
    if not isinstance(wanted, Mapping):
        return index == int(wanted)
    if "gt" in wanted:
        return index > int(wanted["gt"])
    before = seen_at[round(wanted["ge_at"] * 1000)].start_index
    return before is not None and index >= before
