"""Reports of errors over HTTP, as a driver sends them."""

from collections.abc import AsyncIterator
from typing import Any

import pytest

from domain.computers import ComputerName
from domain.devices.settings import DeviceSettings
from domain.inputs import ErrorReport
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from tests.support.good import GOOD
from tests.support.http_robot import HttpRobot, http_robot

MODEL = """\
vehicle:
  ros__parameters:
    type: system
    modes: {__DEFAULT__: {left/arm: active}}
    errors:
      STUCK: {caused_by: [left/arm.JAMMED], severity: critical}
left/arm:
  ros__parameters:
    type: node
    errors:
      JAMMED: {severity: urgent, message: the gripper does not move, hint: open it by hand}
      SILENT: {when: "not part('left/arm').reachable"}
"""
JAMMED = "/nodes/left/arm/errors/JAMMED"


@pytest.fixture
async def arm() -> AsyncIterator[HttpRobot]:
    """Return a robot with an arm that can jam, which is well."""
    async with http_robot(MODEL, mock=False) as robot:
        await robot.http.post("/signals", json=GOOD)
        yield robot


async def report(robot: HttpRobot, path: str, **body: object) -> Any:  # noqa: ANN401
    return (await robot.http.post(path, json=body)).json()


async def test_what_a_driver_finds_is_an_error_until_it_says_that_it_is_over(
    arm: HttpRobot,
) -> None:
    found = await report(arm, JAMMED, active=True, message="current 9 A", value=9)

    assert (found["state"], found["severity"], found["root_cause"]) == ("active", "urgent", True)
    assert (found["message"], found["value"], found["hint"]) == (
        "current 9 A",
        9.0,
        "open it by hand",
    )
    stuck = (await arm.get("/systems/vehicle/errors?active=true"))["items"]
    assert [item["error"] for item in stuck] == ["STUCK"]
    assert stuck[0]["caused_by"] == stuck[0]["roots"] == [{"part": "left/arm", "error": "JAMMED"}]
    state = await arm.get("/system_state")
    assert (state["state"], state["error_code"], state["errors"]) == (
        "ERROR",
        128,
        ["vehicle.STUCK"],
    )
    assert state["reasons"][0]["path"] == ["vehicle"]

    over = await report(arm, JAMMED, active=False)

    assert over["state"] != "active"
    assert (await arm.get("/system_state"))["state"] == "IDLE"


async def test_without_a_message_that_of_the_model_file_is_shown(arm: HttpRobot) -> None:
    assert (await report(arm, JAMMED, active=True))["message"] == "the gripper does not move"


@pytest.mark.parametrize(
    ("path", "status", "code"),
    [
        ("/nodes/left/arm/errors/SILENT", 409, "NOT_REPORTED"),
        ("/nodes/left/arm/errors/UNREACHABLE", 409, "NOT_REPORTED"),
        ("/systems/vehicle/errors/STUCK", 409, "NOT_REPORTED"),
        ("/errors/BATTERY_LOW", 409, "NOT_REPORTED"),
        ("/nodes/left/arm/errors/JAMED", 404, "UNKNOWN_ERROR"),
        ("/errors/JAMMED", 404, "UNKNOWN_ERROR"),
        ("/nodes/arm/errors/JAMMED", 404, "UNKNOWN_PART"),
    ],
)
async def test_what_cannot_be_reported_is_rejected(
    arm: HttpRobot, path: str, status: int, code: str
) -> None:
    answer = await arm.http.post(path, json={"active": True})

    assert (answer.status_code, answer.json()["code"]) == (status, code)


@pytest.mark.parametrize(
    "body", [{}, {"active": "yes"}, {"active": True, "value": [1]}, {"active": True, "since": 1}]
)
async def test_a_report_that_says_nothing_clear_is_rejected(
    arm: HttpRobot, body: dict[str, object]
) -> None:
    assert (await arm.http.post(JAMMED, json=body)).status_code == 422


async def test_an_error_of_a_node_of_a_device_is_reported_there() -> None:
    base = ComputerName("base")
    devices = {base: DeviceSettings(base, (PartName("left/arm"),))}
    async with http_robot(MODEL, mock=False, settings=SupervisionSettings(devices=devices)) as arm:
        arm.supervisor.deliver(ErrorReport(PartName("left/arm"), "JAMMED", active=True))

        answer = await arm.http.post(JAMMED, json={"active": False})

        assert (answer.status_code, answer.json()["code"]) == (409, "ACTS_ELSEWHERE")
        assert answer.json()["detail"].startswith("left/arm.JAMMED is reported on device base")
        assert (await arm.get("/nodes/left/arm/errors?active=true"))["items"]
