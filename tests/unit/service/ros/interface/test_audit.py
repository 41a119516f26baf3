"""Who changed something over ROS or rosbridge, and with what outcome."""

import asyncio

import pytest

from domain.errors import InvalidValueError
from tests.support.manual_clock import settle
from tests.support.ros_robot import OPERATOR, RosRobot


def written(robot: RosRobot) -> list[tuple[str, str, int, str]]:
    events = robot.supervisor.events.oldest_first()
    found = [event.data for event in events if event.kind == "audit.write"]
    return [(d["method"], d["path"], d["status"], d["address"]) for d in found]  # type: ignore[misc]


async def test_a_call_that_changes_something_is_recorded_with_its_outcome(
    robot: RosRobot,
) -> None:
    await robot.call("/drive_base/change_mode", {"mode_name": "FAST"})
    await robot.call("/drive_base/change_mode", {"mode_name": "NONE"})
    await robot.call("/drive_base/change_state", {"transition": {"label": "deactivate"}})
    await robot.call("/cancel_tasks")

    sender = OPERATOR.label
    assert written(robot) == [
        ("CALL", "/drive_base/change_mode", 200, sender),
        ("CALL", "/drive_base/change_mode", 409, sender),
        ("CALL", "/drive_base/change_state", 200, sender),
        ("CALL", "/cancel_tasks", 200, sender),
    ]


async def test_an_invalid_call_is_recorded(robot: RosRobot) -> None:
    with pytest.raises(InvalidValueError):
        await robot.call("/drive_base/change_mode", {"mode_name": 7})

    assert written(robot) == [("CALL", "/drive_base/change_mode", 422, OPERATOR.label)]


async def test_a_caller_that_does_not_wait_for_the_end_is_recorded(robot: RosRobot) -> None:
    service = robot.interface.services["/drive_base/change_mode"]
    asked = asyncio.ensure_future(service.call({"mode_name": "FAST"}, OPERATOR))
    await settle()
    asked.cancel()
    await settle()

    assert written(robot) == [("CALL", "/drive_base/change_mode", 504, OPERATOR.label)]


async def test_a_call_that_only_asks_is_not_recorded(robot: RosRobot) -> None:
    await robot.call("/drive_base/get_mode")
    await robot.call("/drive_base/get_available_modes")

    assert written(robot) == []


async def test_a_reading_that_releases_a_stop_is_recorded(robot: RosRobot) -> None:
    robot.interface.heard["/estop"].take({"enabled": True}, OPERATOR)
    robot.interface.heard["/estop"].take({"enabled": False}, OPERATOR)
    robot.interface.heard["/estop"].take({"enabled": False}, OPERATOR)

    assert written(robot) == [("READING", "/signals/estop", 200, OPERATOR.label)]
