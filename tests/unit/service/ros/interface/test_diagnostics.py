from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from domain.findings import Blocker
from domain.identifiers import ChangeId
from domain.lifecycle import LifecycleState
from domain.snapshot import (
    Actual,
    ErrorKey,
    ErrorState,
    ErrorView,
    PartView,
    Severity,
    SignalView,
    SystemState,
    SystemStateView,
    TaskStatus,
)
from domain.state_and_mode import StateAndMode
from service.ros.interface.diagnostics import MAX_STATUSES, Level, diagnostic_array, status
from tests.support.frames import IDLE, frame, part_view, signal_view
from tests.support.manual_clock import ManualClock

ARM = part_view("manipulator", "STRONG")
BATTERY = signal_view("battery_level")


def diagnosed(
    parts: Sequence[PartView] = (),
    signals: Sequence[SignalView] = (),
    system_state: SystemStateView = IDLE,
    errors: Sequence[ErrorView] = (),
) -> list[Any]:
    """Return the statuses of a frame."""
    complete = frame(1, parts, signals, errors, full=True, system_state=system_state)
    found: list[Any] = diagnostic_array(complete, ManualClock())["status"]
    return found


def told(found: Any) -> tuple[int, str, str]:  # noqa: ANN401  # a message
    return found["level"], found["name"], found["message"]


def values(found: Any) -> dict[str, str]:  # noqa: ANN401  # a message
    return {each["key"]: each["value"] for each in found["values"]}


def error_state(*reasons: Blocker) -> SystemStateView:
    errors = tuple(reason.code for reason in reasons)
    return SystemStateView(SystemState.ERROR, 3, errors, reasons, TaskStatus.NO_TASK)


def test_a_robot_that_is_well_is_ok_in_all_its_parts_and_signals() -> None:
    statuses = diagnosed([ARM], [BATTERY])

    assert [told(each) for each in statuses] == [
        (0, "pilothouse: system state", "IDLE"),
        (0, "pilothouse: signal battery_level", "OK"),
        (0, "pilothouse: manipulator", "active.STRONG"),
    ]
    assert {each["hardware_id"] for each in statuses} == {""}


def test_a_vehicle_that_should_stand_is_an_error_of_the_robot_and_of_no_signal() -> None:
    moving = Blocker("STILL_MOVING", "the vehicle moved at 1.1 m/s", ("vehicle",))
    robot, signal = diagnosed([], [signal_view("vehicle")], replace(IDLE, reasons=(moving,)))

    assert told(robot) == (2, "pilothouse: system state", "the vehicle moved at 1.1 m/s")
    assert values(robot)["state"] == "IDLE"
    assert told(signal) == (0, "pilothouse: signal vehicle", "OK")


def test_a_robot_in_error_says_why() -> None:
    low = Blocker("BATTERY_LOW", "battery 20 % is below 50 %", ("battery_level",))
    stop = Blocker("ESTOP", "e-stop is pressed (source api)", ("estop",))
    battery = BATTERY._replace(error="BATTERY_LOW")

    robot, signal = diagnosed([], [battery], error_state(stop, low))

    message = "e-stop is pressed (source api); battery 20 % is below 50 %"
    assert told(robot) == (2, "pilothouse: system state", message)
    assert values(robot) == {
        "state": "ERROR",
        "error_code": "3",
        "errors": "ESTOP, BATTERY_LOW",
        "task_status": "NO_TASK",
        "simulated": "nodes",
    }
    assert told(signal) == (2, "pilothouse: signal battery_level", "battery 20 % is below 50 %")


@pytest.mark.parametrize(
    ("signal", "level"),
    [
        (BATTERY, Level.OK),
        (BATTERY._replace(pending_error="BATTERY_LOW"), Level.WARN),
        (BATTERY._replace(error="BATTERY_LOW"), Level.ERROR),
        (BATTERY._replace(stale=True), Level.STALE),
        (BATTERY._replace(stale=True, error="BATTERY_LOW"), Level.STALE),
    ],
)
def test_a_signal_is_as_bad_as_what_is_judged_of_it(signal: SignalView, level: Level) -> None:
    assert diagnosed([], [signal])[1]["level"] == level


def test_a_signal_that_waits_names_the_error_that_is_coming() -> None:
    signal = BATTERY._replace(pending_error="BATTERY_LOW")

    assert told(diagnosed([], [signal])[1])[2] == "BATTERY_LOW is pending"


def test_a_signal_shows_its_value_unit_and_source() -> None:
    pressed = signal_view("estop")._replace(value=True, source="panel")
    never = signal_view("temperature")._replace(value=None, source=None, unit="°C")

    _, estop, temperature = diagnosed([], [pressed, never])

    assert values(estop) == {"value": "true", "source": "panel"}
    assert values(temperature) == {"unit": "°C"}


INACTIVE = Actual(LifecycleState.INACTIVE)
UNDECIDABLE = Actual(LifecycleState.UNKNOWN, undecidable=True, reason="lidar is unknown")


@pytest.mark.parametrize(
    ("part", "level", "message"),
    [
        (ARM, Level.OK, "active.STRONG"),
        (
            replace(ARM, actual=INACTIVE, converged=False, change=ChangeId("c1")),
            Level.OK,
            "changing to active.STRONG",
        ),
        (replace(ARM, target=None, change=ChangeId("c1")), Level.OK, "changing"),
        (
            replace(ARM, actual=INACTIVE, converged=False),
            Level.WARN,
            "target active.STRONG, actual inactive",
        ),
        (
            replace(ARM, converged=False, deviation_reason="hand is inactive, target active"),
            Level.WARN,
            "active.STRONG: hand is inactive, target active",
        ),
        (replace(ARM, target=None, actual=UNDECIDABLE), Level.WARN, "unknown: lidar is unknown"),
        (replace(ARM, reachable=False), Level.ERROR, "is unreachable"),
        (
            replace(ARM, reachable=False, kind="system"),
            Level.ERROR,
            "has unreachable nodes",
        ),
        (
            replace(ARM, actual=Actual(LifecycleState.ERROR_PROCESSING), change=ChangeId("c1")),
            Level.ERROR,
            "changing to active.STRONG",
        ),
    ],
)
def test_a_part_says_what_is_wrong_with_it(part: PartView, level: Level, message: str) -> None:
    assert told(diagnosed([part])[1]) == (level, "pilothouse: manipulator", message)


def error(severity: Severity, state: ErrorState = ErrorState.ACTIVE) -> ErrorView:
    key = ErrorKey(ARM.name, "LATE")
    return ErrorView(key, severity, state, True, "its map is late", None, None, 0, 1)


@pytest.mark.parametrize(
    ("severity", "level"),
    [
        (Severity.WARNING, Level.WARN),
        (Severity.URGENT, Level.ERROR),
        (Severity.CRITICAL, Level.ERROR),
        (Severity.FATAL, Level.ERROR),
    ],
)
def test_a_part_is_as_bad_as_its_worst_error(severity: Severity, level: Level) -> None:
    found = diagnosed([ARM], errors=[error(severity)])[1]
    assert told(found) == (level, "pilothouse: manipulator", "LATE: its map is late")
    assert values(found)["errors"] == "LATE"


def test_an_error_that_is_over_is_no_problem_of_its_part() -> None:
    found = diagnosed([ARM], errors=[error(Severity.FATAL, ErrorState.RETURNED)])[1]
    assert told(found) == (Level.OK, "pilothouse: manipulator", "active.STRONG")


def test_a_part_shows_what_it_is_and_should_be() -> None:
    part = replace(
        ARM, target=StateAndMode(LifecycleState.ACTIVE), actual=INACTIVE, change=ChangeId("c7")
    )

    assert values(diagnosed([part])[1]) == {
        "kind": "node",
        "actual": "inactive",
        "target": "active",
        "change": "c7",
    }


def test_of_thousands_of_parts_those_with_something_wrong_are_told_first() -> None:
    parts = [part_view(f"node_{number}") for number in range(2_000)]
    parts[1_500] = replace(parts[1_500], reachable=False)

    robot, signal, first, *others = diagnosed(parts, [BATTERY])

    assert len(others) + 3 == MAX_STATUSES
    assert signal["name"] == "pilothouse: signal battery_level"
    assert first["name"] == "pilothouse: node_1500"
    assert others[0]["name"] == "pilothouse: node_0"
    assert values(robot)["left_out"] == str(2_001 - (MAX_STATUSES - 1))


def test_nothing_is_left_out_of_a_small_robot_and_nothing_said_of_it() -> None:
    assert "left_out" not in values(diagnosed([ARM], [BATTERY])[0])


def test_what_a_string_of_ros_cannot_hold_is_replaced() -> None:
    found = status(Level.OK, "signal estop", "fire\0!", {"source": "half \ud800 a pair"})

    assert found["message"] == "fire?!"
    assert values(found) == {"source": "half ? a pair"}
