import asyncio
import logging

import pytest

from domain.errors import InvalidValueError
from domain.inputs import EmergencyStopRequest, ModeRequest, TaskRequest, TransitionRequest
from domain.lifecycle import Transition
from domain.simulation.node_settings import Fault
from domain.snapshot import TaskPhase
from service.ros.interface.services import carry_out
from tests.support.manual_clock import settle
from tests.support.models import ACTUATION, ARM, BASE
from tests.support.paths import straight
from tests.support.ros_robot import OPERATOR, RosRobot

SERVICES = {
    "get_state": "lifecycle_msgs/srv/GetState",
    "get_available_states": "lifecycle_msgs/srv/GetAvailableStates",
    "get_available_transitions": "lifecycle_msgs/srv/GetAvailableTransitions",
    "get_transition_graph": "lifecycle_msgs/srv/GetAvailableTransitions",
    "change_state": "lifecycle_msgs/srv/ChangeState",
}


async def state_of(robot: RosRobot, part: str) -> tuple[int, str]:
    current = (await robot.call(f"/{part}/get_state"))["current_state"]
    return current["id"], current["label"]


async def change_state(robot: RosRobot, part: str, **transition: int | str) -> bool:
    response = await robot.call(f"/{part}/change_state", {"transition": transition})
    success: bool = response["success"]
    return success


async def available(robot: RosRobot, part: str) -> list[tuple[str, int, str, str]]:
    response = await robot.call(f"/{part}/get_available_transitions")
    return [
        (
            each["transition"]["label"],
            each["transition"]["id"],
            each["start_state"]["label"],
            each["goal_state"]["label"],
        )
        for each in response["available_transitions"]
    ]


@pytest.mark.parametrize(
    ("part", "node", "of_a_node"),
    [("actuation", "actuation", False), ("drive_base", "pilothouse", True)],
)
def test_a_part_has_all_services_of_a_lifecycle_node(part: str, node: str, of_a_node: bool) -> None:
    offered = RosRobot().interface.services

    for name, type_name in SERVICES.items():
        service = offered[f"/{part}/{name}"]
        assert (service.type, service.node, service.of_a_node) == (type_name, node, of_a_node)


async def test_a_system_is_led_through_its_life_by_labels(robot: RosRobot) -> None:
    assert await state_of(robot, "actuation") == (1, "unconfigured")

    for label, state in [
        ("configure", (2, "inactive")),
        ("activate", (3, "active")),
        ("deactivate", (2, "inactive")),
        ("cleanup", (1, "unconfigured")),
        ("shutdown", (4, "finalized")),
    ]:
        assert await change_state(robot, "actuation", label=label)
        assert await state_of(robot, "actuation") == state


async def test_a_node_is_led_by_numbers(robot: RosRobot) -> None:
    assert await change_state(robot, "drive_base", id=1)
    assert await change_state(robot, "drive_base", id=3)

    assert await state_of(robot, "drive_base") == (3, "active")


@pytest.mark.parametrize("number", [5, 6, 7])
async def test_every_number_of_shutdown_shuts_down(robot: RosRobot, number: int) -> None:
    assert await change_state(robot, "actuation", id=number)

    assert await state_of(robot, "actuation") == (4, "finalized")


async def test_a_label_decides_over_a_number(robot: RosRobot) -> None:
    assert await change_state(robot, "actuation", id=7, label="configure")

    assert await state_of(robot, "actuation") == (2, "inactive")


@pytest.mark.parametrize(
    "transition", [{"label": "explode", "id": 1}, {"id": 0}, {"id": 99}, {"label": "ACTIVATE"}]
)
async def test_a_transition_that_does_not_exist_is_refused_and_logged(
    robot: RosRobot, caplog: pytest.LogCaptureFixture, transition: dict[str, int | str]
) -> None:
    caplog.set_level(logging.INFO)

    assert not await change_state(robot, "actuation", **transition)

    assert "of actuation, requested by test:operator: there is no such transition" in caplog.text
    assert await state_of(robot, "actuation") == (1, "unconfigured")


async def test_a_transition_that_is_illegal_is_refused_with_what_is_possible_in_the_log(
    robot: RosRobot, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)

    assert not await change_state(robot, "actuation", label="deactivate")

    assert "actuation is unconfigured: it cannot deactivate" in caplog.text


async def test_what_is_available_begins_where_the_part_is(robot: RosRobot) -> None:
    assert await available(robot, "actuation") == [
        ("configure", 1, "unconfigured", "inactive"),
        ("activate", 3, "unconfigured", "active"),
        ("shutdown", 5, "unconfigured", "finalized"),
    ]

    await robot.change_mode("actuation", "PERFORMANCE")

    assert await available(robot, "actuation") == [
        ("cleanup", 2, "active", "unconfigured"),
        ("deactivate", 4, "active", "inactive"),
        ("shutdown", 7, "active", "finalized"),
    ]


async def test_the_graph_has_what_may_be_asked_from_every_state(robot: RosRobot) -> None:
    response = await robot.call("/actuation/get_transition_graph")

    edges = {
        (each["start_state"]["label"], each["transition"]["label"], each["goal_state"]["label"])
        for each in response["available_transitions"]
    }
    assert edges == {
        ("unconfigured", "configure", "inactive"),
        ("unconfigured", "activate", "active"),
        ("unconfigured", "shutdown", "finalized"),
        ("inactive", "activate", "active"),
        ("inactive", "cleanup", "unconfigured"),
        ("inactive", "shutdown", "finalized"),
        ("active", "deactivate", "inactive"),
        ("active", "cleanup", "unconfigured"),
        ("active", "shutdown", "finalized"),
    }


async def test_all_states_of_the_standard_are_available(robot: RosRobot) -> None:
    response = await robot.call("/actuation/get_available_states")

    numbers = [state["id"] for state in response["available_states"]]
    assert numbers == [0, 1, 2, 3, 4, 10, 11, 12, 13, 14, 15]


async def test_a_system_of_which_nothing_was_heard_is_unknown() -> None:
    response = await RosRobot().interface.services["/actuation/get_state"].call({}, OPERATOR)

    assert response == {"current_state": {"id": 0, "label": "unknown"}}


@pytest.mark.parametrize("name", SERVICES)
async def test_a_field_that_does_not_exist_is_refused(robot: RosRobot, name: str) -> None:
    with pytest.raises(InvalidValueError, match="'force'"):
        await robot.call(f"/actuation/{name}", {"force": True})


@pytest.mark.parametrize(
    ("part", "node"), [("actuation", "actuation"), ("drive_base", "pilothouse")]
)
def test_a_part_has_the_services_of_the_mode_manager(part: str, node: str) -> None:
    offered = RosRobot().interface.services

    for name, type_name in [
        ("get_mode", "system_modes_msgs/srv/GetMode"),
        ("change_mode", "system_modes_msgs/srv/ChangeMode"),
        ("get_available_modes", "system_modes_msgs/srv/GetAvailableModes"),
    ]:
        service = offered[f"/{part}/{name}"]
        assert (service.type, service.node, service.of_a_node) == (type_name, node, False)


async def test_a_mode_is_entered_and_read_back(robot: RosRobot) -> None:
    changed = await robot.call("/actuation/change_mode", {"mode_name": "PERFORMANCE"})

    assert changed == {"success": True}
    assert await robot.call("/actuation/get_mode") == {"current_mode": "PERFORMANCE"}
    assert await robot.call("/drive_base/get_mode") == {"current_mode": "FAST"}


async def test_a_part_that_is_in_no_mode_has_none(robot: RosRobot) -> None:
    await robot.call("/actuation/change_state", {"transition": {"label": "configure"}})

    assert await robot.call("/actuation/get_mode") == {"current_mode": ""}


async def test_of_a_part_that_was_never_heard_of_the_mode_is_unknown() -> None:
    response = await RosRobot().interface.services["/actuation/get_mode"].call({}, OPERATOR)

    assert response == {"current_mode": "unknown"}


async def test_a_mode_that_does_not_exist_is_not_entered(robot: RosRobot) -> None:
    response = await robot.call("/actuation/change_mode", {"mode_name": "WARP"})

    assert response == {"success": False}


async def test_the_modes_of_a_part_are_those_of_the_model(robot: RosRobot) -> None:
    response = await robot.call("/drive_base/get_available_modes")

    assert response == {"available_modes": ["__DEFAULT__", "SLOW", "FAST"]}


@pytest.mark.parametrize("name", ["get_mode", "change_mode", "get_available_modes"])
async def test_the_older_form_that_names_the_node_is_refused(robot: RosRobot, name: str) -> None:
    with pytest.raises(InvalidValueError, match="'node_name'"):
        await robot.call(f"/drive_base/{name}", {"node_name": "drive_base"})


async def test_a_request_is_a_success_once_every_node_is_there(robot: RosRobot) -> None:
    asked = asyncio.create_task(
        carry_out(robot.supervisor, ModeRequest(ACTUATION, "PERFORMANCE", OPERATOR))
    )
    await robot.clock.advance(0.3)
    assert not asked.done()

    await robot.clock.advance(1.0)

    assert await asked is True
    actual = robot.supervisor.core.part(ACTUATION).actual
    assert actual.state_and_mode.label == "active.PERFORMANCE"


async def test_a_request_that_is_met_already_is_a_success_at_once(robot: RosRobot) -> None:
    await robot.change_mode("drive_base", "FAST")

    assert await carry_out(robot.supervisor, ModeRequest(BASE, "FAST", OPERATOR)) is True


async def test_a_refusal_is_no_success_and_its_reason_is_logged(
    robot: RosRobot, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)
    robot.supervisor.submit(EmergencyStopRequest(engaged=True, reason="fire"))

    assert await carry_out(robot.supervisor, ModeRequest(BASE, "FAST", OPERATOR)) is False

    assert "'FAST' of drive_base, requested by test:operator" in caplog.text
    assert "emergency stop is engaged" in caplog.text


async def test_a_mode_that_does_not_exist_is_refused(
    robot: RosRobot, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)

    assert await carry_out(robot.supervisor, ModeRequest(BASE, "WARP", OPERATOR)) is False
    assert "there is no mode of drive_base 'WARP'" in caplog.text


async def test_a_change_that_fails_is_no_success_and_its_reason_is_logged(
    robot: RosRobot, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)
    robot.fault("manipulator", Fault.FAIL)
    request = TransitionRequest(ARM, Transition.ACTIVATE, OPERATOR)
    asked = asyncio.create_task(carry_out(robot.supervisor, request))

    await robot.clock.advance(2.0)

    assert await asked is False
    assert "failed: manipulator" in caplog.text


async def test_a_change_that_runs_on_after_a_minute_is_no_success(
    robot: RosRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.ros.interface.services.MAX_WAIT_S", 5.0)
    robot.fault("manipulator", Fault.SILENT)
    request = TransitionRequest(ARM, Transition.ACTIVATE, OPERATOR)
    asked = asyncio.create_task(carry_out(robot.supervisor, request))

    await robot.clock.advance(4.9)
    assert not asked.done()
    await robot.clock.advance(0.2)
    await settle()

    assert await asked is False


async def test_the_task_is_canceled(robot: RosRobot) -> None:
    robot.supervisor.submit(TaskRequest(straight(), 0, "pure_pursuit", 1.0))

    assert await robot.call("/cancel_tasks") == {}

    (task,) = robot.supervisor.core.driving.tasks()
    assert task.status is TaskPhase.CANCELED
    requested = [e for e in robot.supervisor.events.oldest_first() if "cancel_req" in e.kind]
    assert [event.actor for event in requested] == [OPERATOR]


async def test_without_a_task_nothing_happens(robot: RosRobot) -> None:
    assert await robot.call("/cancel_tasks") == {}


async def test_it_takes_no_fields(robot: RosRobot) -> None:
    with pytest.raises(InvalidValueError, match="'task'"):
        await robot.call("/cancel_tasks", {"task": "t1"})
