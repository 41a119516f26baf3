"""The robot as `diagnostic_msgs/msg/DiagnosticArray`, for diagnostics tools.

Names of statuses: `pilothouse: drive_base` for a part, `pilothouse: signal estop` for a signal,
`pilothouse: system state` for the robot.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import IntEnum
from typing import TypeVar

from domain.lifecycle import LifecycleState
from domain.parts.convergence import is_there
from domain.snapshot import (
    ErrorView,
    PartView,
    Severity,
    SignalView,
    SystemState,
    SystemStateView,
)
from domain.state_and_mode import PartName
from service.clock import Clock
from service.frame_feed import Frame
from service.ros.interface.endpoints import Fields
from service.ros.interface.message_fields import header

ViewT = TypeVar("ViewT")

MAX_STATUSES = 500
"""Most statuses in one message; those with problems come first."""


class Level(IntEnum):
    """The levels of `diagnostic_msgs/msg/DiagnosticStatus`."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


_LEVELS = {
    Severity.WARNING: Level.WARN,
    Severity.URGENT: Level.ERROR,
    Severity.CRITICAL: Level.ERROR,
    Severity.FATAL: Level.ERROR,
}


def diagnostic_array(frame: Frame, clock: Clock) -> Fields:
    """Return a complete frame as a `diagnostic_msgs/msg/DiagnosticArray`."""
    signals = tuple(frame.signals.values())
    parts = tuple(frame.parts.values())
    room = MAX_STATUSES - 1
    listed_signals = _most_urgent(signals, _signal_level, room)
    errors = _errors_by_part(frame)

    def part_level(view: PartView) -> Level:
        return max(_part_level(view), _worst(errors.get(view.name, ())))

    listed_parts = _most_urgent(parts, part_level, room - len(listed_signals))
    left_out = len(signals) + len(parts) - len(listed_signals) - len(listed_parts)
    reasons = _reasons(frame.system_state)
    return {
        "header": header(clock, frame.at),
        "status": [
            _robot_status(frame, left_out),
            *(_signal_status(signal, reasons.get(signal.signal, "")) for signal in listed_signals),
            *(_part_status(part, errors.get(part.name, ())) for part in listed_parts),
        ],
    }


def status(level: Level, what: str, message: str, values: Mapping[str, object]) -> Fields:
    """Return a `diagnostic_msgs/msg/DiagnosticStatus`.

    Args:
        level: Severity.
        what: Its name, without `pilothouse: `.
        message: One sentence.
        values: Facts by name; those that are None are left out.
    """
    return {
        "level": int(level),
        "name": f"pilothouse: {what}",
        "message": _sendable(message),
        "hardware_id": "",
        "values": [
            {"key": key, "value": _sendable(str(value))}
            for key, value in values.items()
            if value is not None
        ],
    }


def _sendable(text: str) -> str:
    """Replace characters that a ROS string cannot hold: clients write reasons and sources."""
    return text.encode(errors="replace").decode().replace("\0", "?")


def _most_urgent(
    views: Sequence[ViewT], level: Callable[[ViewT], Level], room: int
) -> Sequence[ViewT]:
    """Return at most `room` views, those that are not OK first."""
    if len(views) <= room:
        return views
    return sorted(views, key=lambda view: level(view) is Level.OK)[:room]


def _reasons(view: SystemStateView) -> dict[str, str]:
    """Return the reasons of the active errors, by signal."""
    found: dict[str, list[str]] = {}
    for reason in (reason for reason in view.reasons if reason.code in view.errors):
        found.setdefault(reason.path[-1], []).append(reason.message)
    return {signal: "; ".join(messages) for signal, messages in found.items()}


def _robot_status(frame: Frame, left_out: int) -> Fields:
    view = frame.system_state
    # Without errors, the reason is a vehicle that should stand and does not.
    level = Level.ERROR if view.state is SystemState.ERROR or view.reasons else Level.OK
    message = "; ".join(reason.message for reason in view.reasons) or str(view.state)
    values = {
        "state": view.state,
        "error_code": view.error_code,
        "errors": ", ".join(view.errors),
        "task_status": view.task_status,
        "simulated": ", ".join(frame.simulated),
        "left_out": left_out or None,
    }
    return status(level, "system state", message, values)


def _signal_level(view: SignalView) -> Level:
    if view.stale:
        return Level.STALE
    if view.error is not None:
        return Level.ERROR
    return Level.OK if view.pending_error is None else Level.WARN


def _signal_status(view: SignalView, reasons: str) -> Fields:
    level = _signal_level(view)
    message = reasons
    if not message:
        message = "OK" if view.pending_error is None else f"{view.pending_error} is pending"
    values = {
        "value": str(view.value).lower() if isinstance(view.value, bool) else view.value,
        "unit": view.unit or None,
        "source": view.source,
        "error": view.error,
        "pending_error": view.pending_error,
    }
    return status(level, f"signal {view.signal}", message, values)


def _part_level(view: PartView) -> Level:
    if not view.reachable or view.actual.state is LifecycleState.ERROR_PROCESSING:
        return Level.ERROR
    if view.change is not None:
        return Level.OK
    return Level.WARN if view.actual.undecidable or not view.converged else Level.OK


def _errors_by_part(frame: Frame) -> Mapping[PartName, Sequence[ErrorView]]:
    """Return the errors of parts that are on; what silences an error leaves it as it is."""
    found: dict[PartName, list[ErrorView]] = {}
    for view in frame.errors.values():
        if view.key.part is not None and view.state.is_on:
            found.setdefault(view.key.part, []).append(view)
    return found


def _worst(errors: Iterable[ErrorView]) -> Level:
    return max((_LEVELS[view.severity] for view in errors), default=Level.OK)


def _part_status(view: PartView, errors: Sequence[ErrorView]) -> Fields:
    actual, target = view.actual, view.target
    level, message = _part_level(view), _part_message(view)
    if (worst := _worst(errors)) > level:
        bad = (error for error in errors if _LEVELS[error.severity] is worst)
        level, message = worst, "; ".join(f"{error.key.error}: {error.message}" for error in bad)
    values = {
        "kind": view.kind,
        "actual": actual.state_and_mode.label,
        "target": target.label if target else None,
        "change": view.change,
        "errors": ", ".join(error.key.error for error in errors) or None,
    }
    return status(level, view.name, message, values)


def _part_message(view: PartView) -> str:
    actual = view.actual.state_and_mode.label
    why = f": {view.actual.reason}" if view.actual.reason else ""
    if not view.reachable:
        what = "is unreachable" if view.kind == "node" else "has unreachable nodes"
        return f"{what}{why}"
    if view.change is not None:
        return f"changing to {view.target.label}" if view.target else "changing"
    if view.converged:
        return f"{actual}{why}"
    if view.target is None or is_there(view.actual, view.target):
        return f"{actual}: {view.deviation_reason}"
    return f"target {view.target.label}, actual {actual}{why}"
