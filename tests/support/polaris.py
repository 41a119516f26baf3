"""Plays the conformance vectors of smart_polaris on anything that can be driven like a robot.

The format is `polaris-conformance/1`: timed readings, and what has to be seen when.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

TICK_MS = 50
"""Period of the original state manager; an expectation over a window is checked so often."""

BITS: Mapping[str, int] = {
    "BATTERY_LOW": 1,
    "ESTOP": 2,
    "GPS_LOST": 4,
    "SIGNAL_LOST": 8,
    "SIGNAL_LOW": 16,
    "TEMPERATURE_HIGH": 32,
    "STALE_DATA": 64,
}

Vector: TypeAlias = Mapping[str, Any]


@dataclass(frozen=True)
class Observation:
    """What a reader of the system state sees."""

    state: str
    errors: frozenset[str]
    error_code: int


class Robot(Protocol):
    """A fresh robot at script time 0 s that the player drives; time only rises."""

    def advance_to(self, at_s: float) -> None:
        """Let script time be `at_s`, and what is due until then happen."""

    def reading(self, signal: str, value: object, stamp_offset_s: float) -> bool:
        """Send a reading stamped so much later than now; return whether it was taken."""

    def task_status(self, status: str) -> None:
        """Report the status of the task planner."""

    def observe(self) -> Observation:
        """Return what is seen now."""


@dataclass(frozen=True)
class Send:
    """One reading, or one report of the task planner (`task_status`)."""

    at_ms: int
    signal: str
    value: object
    stamp_offset_s: float


@dataclass(frozen=True)
class Look:
    """One moment at which an expectation has to hold."""

    at_ms: int
    expected: Mapping[str, Any]


def timeline(vector: Vector, expected: str = "expected") -> list[Send | Look]:
    """List what to do and to look at in order of time; at one instant, readings come first.

    Args:
        vector: One vector of a file.
        expected: Which of its lists of expectations to take, `expected` or `expected_safer`.
    """
    # A step `advance_clock` sets the clock of the day, which nothing is judged by here.
    steps = [step for step in vector["steps"] if "advance_clock" not in step]
    sends: list[Send | Look] = [send for step in steps for send in sends_of(step)]
    looks: list[Send | Look] = [look for item in vector[expected] for look in _looks(item)]
    return sorted(sends + looks, key=lambda item: (item.at_ms, isinstance(item, Look)))


def play(vector: Vector, robot: Robot, expected: str = "expected") -> list[str]:
    """Play a vector and return what was seen otherwise than expected; empty: it passes."""
    failures = []
    refused = False
    may_refuse = any("any_of" in item or "input_rejected" in item for item in vector[expected])
    for item in timeline(vector, expected):
        robot.advance_to(item.at_ms / 1000)
        if isinstance(item, Look):
            seen = robot.observe()
            failures += [f"{item.at_ms} ms: {wrong}" for wrong in _differences(item, seen, refused)]
        elif item.signal == "task_status":
            robot.task_status(str(item.value))
        elif not robot.reading(item.signal, item.value, item.stamp_offset_s):
            refused = True
            if not may_refuse:
                failures.append(f"{item.at_ms} ms: refused: {item}")
    return failures


def sends_of(step: Mapping[str, Any]) -> Iterator[Send]:
    """Yield every reading that a step sends.

    Raises:
        ValueError: It is another kind of step.
    """
    if "signal" not in step:
        raise ValueError(f"a step that this player does not know: {step}")
    start = step["t"]
    count = 1
    if "repeat_hz" in step:
        count += math.floor((step["until"] - start) * step["repeat_hz"] + 1e-6)
    for number in range(count):
        at = start + (number / step["repeat_hz"] if number else 0.0)
        since_stamp = at - start if step.get("stamp") == "first" else 0.0
        yield Send(
            at_ms=round(at * 1000),
            signal=step["signal"],
            value=_value(step, number, count),
            stamp_offset_s=step.get("stamp_offset_s", 0.0) - since_stamp,
        )


def _value(step: Mapping[str, Any], number: int, count: int) -> object:
    if "ramp" in step:
        first, last = step["ramp"]
        return first + (last - first) * number / (count - 1)
    return math.nan if step["value"] == "NaN" else step["value"]


def _looks(item: Mapping[str, Any]) -> Iterator[Look]:
    if "t" in item:
        yield Look(round(item["t"] * 1000), item)
        return
    first = math.ceil(item["from"] * 1000 / TICK_MS)
    last = math.floor(item["to"] * 1000 / TICK_MS)
    for tick in range(first, last + 1):
        yield Look(tick * TICK_MS, item)


def _differences(look: Look, seen: Observation, refused: bool) -> Sequence[str]:
    """Compare; that code, names and state are of one moment is expected of every look."""
    wrong = []
    if seen.error_code != sum(BITS[error] for error in seen.errors):
        wrong.append(f"error code {seen.error_code} with {sorted(seen.errors)}")
    if (seen.state == "ERROR") is not bool(seen.error_code):
        wrong.append(f"state {seen.state} with error code {seen.error_code}")
    if not _holds(look.expected, seen, refused):
        wrong.append(f"expected {look.expected}, seen {seen}, a reading refused: {refused}")
    return wrong


def _holds(expected: Mapping[str, Any], seen: Observation, refused: bool) -> bool:
    facts: Mapping[str, object] = {
        "state": seen.state,
        "errors": seen.errors,
        "error_code": seen.error_code,
        "input_rejected": refused,
    }
    for key, value in expected.items():
        if key in {"t", "from", "to"}:
            continue
        if key == "any_of":
            if not any(_holds(alternative, seen, refused) for alternative in value):
                return False
        elif facts[key] != (frozenset(value) if key == "errors" else value):
            return False
    return True
