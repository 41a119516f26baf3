"""Standard types in place of message types that are rarely installed.

`system_modes_msgs` and the packages of `message_sets` are in no ROS 2 distribution. If one is not
installed, its services and topics are offered with types that every installation has. A mode is
then represented as a state with a label such as `active.FAST`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from domain.health.signals import DECLARED_BIT, STALE_DATA, STALE_DATA_BIT, default_signals
from domain.lifecycle import LifecycleState
from domain.snapshot import SystemState, TaskStatus
from domain.state_and_mode import ModeName, StateAndMode
from service.ros.interface.diagnostics import Level, status
from service.ros.interface.endpoints import Fields
from service.ros.interface.message_sets import MessageSet, type_in
from service.ros.interface.services import UNKNOWN_MODE

Convert: TypeAlias = Callable[[Fields], Fields]


@dataclass(frozen=True, slots=True)
class ServiceFallback:
    """The fallback type of a service, and the conversions of its requests and responses."""

    type: str
    request: Convert
    """From the fallback type."""
    response: Convert
    """Into the fallback type."""


@dataclass(frozen=True, slots=True)
class TopicFallback:
    """The fallback type of a topic, and the conversion of its messages."""

    type: str
    message: Convert
    """Into the fallback type."""


_ACTIVE = f"{LifecycleState.ACTIVE}."
_NO_STATE: Mapping[str, object] = {"id": 0, "label": ""}
_ERRORS = {
    **{c.bit: c.error for signal in default_signals() for c in signal.bounds},
    STALE_DATA_BIT: STALE_DATA,
    DECLARED_BIT: "DECLARED",
}
"""By bit; declared errors share one bit, since the message has no field for their names."""


def _no_fields(_: Fields) -> Fields:
    return {}


def _as_it_is(fields: Fields) -> Fields:
    return fields


def _state(mode: str) -> Fields:
    """Return a mode as a state; no mode and an unknown mode become the unknown state."""
    if not mode or mode == UNKNOWN_MODE:
        return {"id": LifecycleState.UNKNOWN.id, "label": mode}
    label = StateAndMode(LifecycleState.ACTIVE, ModeName(mode)).label
    return {"id": LifecycleState.ACTIVE.id, "label": label}


def _asked_mode(fields: Fields) -> Fields:
    """Read the label `FAST` or `active.FAST`; the id is ignored, since it cannot name a mode."""
    return {"mode_name": str(fields["transition"]["label"]).removeprefix(_ACTIVE)}


def _current_mode(fields: Fields) -> Fields:
    return {"current_state": _state(fields["current_mode"])}


def _available_modes(fields: Fields) -> Fields:
    return {"available_states": [_state(mode) for mode in fields["available_modes"]]}


def _mode_event(fields: Fields) -> Fields:
    return {
        "timestamp": fields["timestamp"],
        "transition": _NO_STATE,
        "start_state": _state(fields["start_mode"]["label"]),
        "goal_state": _state(fields["goal_mode"]["label"]),
    }


def _system_state(fields: Fields) -> Fields:
    code = fields["error_code"]
    errors = ", ".join(error for bit, error in sorted(_ERRORS.items()) if code & bit)
    state = tuple(SystemState)[fields["state"]]
    level = Level.ERROR if state is SystemState.ERROR else Level.OK
    values = {"stamp": _stamp(fields), "state": state, "error_code": code, "errors": errors}
    return status(level, "system state", f"{state}: {errors}" if errors else state, values)


def _task_status(fields: Fields) -> Fields:
    name = tuple(TaskStatus)[fields["status"]]
    values = {"stamp": _stamp(fields), "status": name}
    return status(Level.OK, "task planner status", name, values)


def _stamp(fields: Mapping[str, Any]) -> str:
    stamp = fields["header"]["stamp"]
    return f"{stamp['sec']}.{stamp['nanosec']:09d}"


def _named_file(fields: Fields) -> Fields:
    """Read the only text that a request has."""
    return {"file": fields["load_namespace"]}


def _task_answer(fields: Fields) -> Fields:
    return {"success": fields["success"], "message": fields["message"] or fields["task"]}


SERVICE_FALLBACKS: Mapping[str, ServiceFallback] = {
    "system_modes_msgs/srv/ChangeMode": ServiceFallback(
        "lifecycle_msgs/srv/ChangeState", _asked_mode, _as_it_is
    ),
    "system_modes_msgs/srv/GetMode": ServiceFallback(
        "lifecycle_msgs/srv/GetState", _no_fields, _current_mode
    ),
    "system_modes_msgs/srv/GetAvailableModes": ServiceFallback(
        "lifecycle_msgs/srv/GetAvailableStates", _no_fields, _available_modes
    ),
    "pilothouse_msgs/srv/StartTask": ServiceFallback(
        "diagnostic_msgs/srv/AddDiagnostics", _named_file, _task_answer
    ),
}
"""By the native type. No standard type holds waypoints and has an answer."""

TOPIC_FALLBACKS: Mapping[str, TopicFallback] = {
    "system_modes_msgs/msg/ModeEvent": TopicFallback(
        "lifecycle_msgs/msg/TransitionEvent", _mode_event
    ),
    **{
        type_in(messages, name): TopicFallback("diagnostic_msgs/msg/DiagnosticStatus", convert)
        for messages in MessageSet
        for name, convert in (("SystemState", _system_state), ("TaskStatus", _task_status))
    },
}
"""By the native type."""
