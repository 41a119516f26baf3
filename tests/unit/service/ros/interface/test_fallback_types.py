import pytest

from service.ros.interface.endpoints import Fields
from service.ros.interface.fallback_types import SERVICE_FALLBACKS, TOPIC_FALLBACKS
from service.ros.interface.message_fields import mode_event

HEADER = {"stamp": {"sec": 12, "nanosec": 50_000_000}, "frame_id": ""}


@pytest.mark.parametrize("label", ["FAST", "active.FAST"])
def test_a_mode_is_asked_for_as_the_label_of_a_transition(label: str) -> None:
    carrier = SERVICE_FALLBACKS["system_modes_msgs/srv/ChangeMode"]

    assert carrier.type == "lifecycle_msgs/srv/ChangeState"
    asked = carrier.request({"transition": {"id": 3, "label": label}})
    assert asked == {"mode_name": "FAST"}
    assert carrier.response({"success": False}) == {"success": False}


@pytest.mark.parametrize(
    ("mode", "state"),
    [
        ("FAST", {"id": 3, "label": "active.FAST"}),
        ("__DEFAULT__", {"id": 3, "label": "active.__DEFAULT__"}),
        ("", {"id": 0, "label": ""}),
        ("unknown", {"id": 0, "label": "unknown"}),
    ],
)
def test_a_mode_is_read_as_a_state(mode: str, state: Fields) -> None:
    carrier = SERVICE_FALLBACKS["system_modes_msgs/srv/GetMode"]

    assert carrier.type == "lifecycle_msgs/srv/GetState"
    assert carrier.request({}) == {}
    assert carrier.response({"current_mode": mode}) == {"current_state": state}


def test_modes_are_listed_as_states() -> None:
    carrier = SERVICE_FALLBACKS["system_modes_msgs/srv/GetAvailableModes"]

    assert carrier.type == "lifecycle_msgs/srv/GetAvailableStates"
    assert carrier.response({"available_modes": ["SLOW", "FAST"]}) == {
        "available_states": [
            {"id": 3, "label": "active.SLOW"},
            {"id": 3, "label": "active.FAST"},
        ]
    }


def test_a_task_is_asked_for_by_the_only_text_of_a_request() -> None:
    carrier = SERVICE_FALLBACKS["pilothouse_msgs/srv/StartTask"]

    assert carrier.type == "diagnostic_msgs/srv/AddDiagnostics"
    assert carrier.request({"load_namespace": "loop.csv"}) == {"file": "loop.csv"}
    taken = carrier.response({"success": True, "message": "", "task": "t3"})
    assert taken == {"success": True, "message": "t3"}
    refused = carrier.response({"success": False, "message": "no such file", "task": ""})
    assert refused == {"success": False, "message": "no such file"}


def test_a_mode_event_is_a_transition_between_labels() -> None:
    carrier = TOPIC_FALLBACKS["system_modes_msgs/msg/ModeEvent"]

    assert carrier.type == "lifecycle_msgs/msg/TransitionEvent"
    assert carrier.message({**mode_event(7, None, None), "goal_mode": {"label": "FAST"}}) == {
        "timestamp": 7,
        "transition": {"id": 0, "label": ""},
        "start_state": {"id": 0, "label": ""},
        "goal_state": {"id": 3, "label": "active.FAST"},
    }


def carried(type_name: str, message: Fields) -> tuple[int, str, str, dict[str, str]]:
    """Return level, name, message and values of what carries a message."""
    carrier = TOPIC_FALLBACKS[type_name]
    assert carrier.type == "diagnostic_msgs/msg/DiagnosticStatus"
    found = carrier.message({"header": HEADER, **message})
    values = {each["key"]: each["value"] for each in found["values"]}
    return found["level"], found["name"], found["message"], values


def test_the_system_state_is_a_diagnostic_with_the_errors_by_name() -> None:
    found = carried("pilothouse_msgs/msg/SystemState", {"state": 2, "error_code": 1 + 64})

    errors = "BATTERY_LOW, STALE_DATA"
    assert found == (
        2,
        "pilothouse: system state",
        f"ERROR: {errors}",
        {"stamp": "12.050000000", "state": "ERROR", "error_code": "65", "errors": errors},
    )


def test_without_an_error_the_system_state_is_ok() -> None:
    found = carried("pilothouse_msgs/msg/SystemState", {"state": 1, "error_code": 0})

    assert found[:3] == (0, "pilothouse: system state", "RUNNING")


def test_declared_errors_share_one_name() -> None:
    *_, values = carried("pilothouse_msgs/msg/SystemState", {"state": 2, "error_code": 128})

    assert values["errors"] == "DECLARED"


def test_the_task_status_is_a_diagnostic() -> None:
    found = carried("pilothouse_msgs/msg/TaskStatus", {"status": 1})

    assert found == (
        0,
        "pilothouse: task planner status",
        "PAUSED_TASK",
        {"stamp": "12.050000000", "status": "PAUSED_TASK"},
    )
