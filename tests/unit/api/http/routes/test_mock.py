"""`/mock`: signals of a robot that is not there."""

import pytest

from domain.computers import ComputerName
from domain.devices.settings import DeviceSettings
from domain.inputs import Reading, Readings
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.live_robot import running


async def test_the_mock_tells_what_it_holds_and_publishes(robot: HttpRobot) -> None:
    items = (await robot.get("/mock"))["items"]

    assert {"signal": "battery_level", "value": 1.0, "publishing": True} in items
    assert len(items) == 5


async def test_another_value_is_held_and_decided_at_once(robot: HttpRobot) -> None:
    answer = await robot.http.patch("/mock/battery_level", json={"value": 0.3})

    assert answer.json() == {"signal": "battery_level", "value": 0.3, "publishing": True}
    assert (await robot.get("/system_state"))["errors"] == ["BATTERY_LOW"]


@pytest.mark.parametrize(
    ("signal", "value", "held"), [("signal_strength", 2, "LOW_SIGNAL"), ("estop", 1, True)]
)
async def test_a_value_is_held_as_its_signal_shows_it(
    signal: str, value: object, held: object, robot: HttpRobot
) -> None:
    answer = await robot.http.patch(f"/mock/{signal}", json={"value": value})
    await robot.pass_time(1)

    assert answer.json()["value"] == held
    assert (await robot.get(f"/signals/{signal}"))["value"] == held


async def test_a_signal_that_is_not_published_any_more_becomes_stale(robot: HttpRobot) -> None:
    answer = await robot.http.patch("/mock/temperature", json={"publishing": False})
    await robot.pass_time(3)

    assert answer.json()["publishing"] is False
    assert (await robot.get("/system_state"))["errors"] == ["STALE_DATA"]

    await robot.http.patch("/mock/temperature", json={"publishing": True})
    await robot.pass_time(1)

    assert (await robot.get("/system_state"))["state"] == "IDLE"


@pytest.mark.parametrize("value", [1.5, "full", True])
async def test_a_value_that_cannot_be_is_not_held_and_publishing_goes_on(
    value: object, robot: HttpRobot
) -> None:
    body = {"value": value, "publishing": False}

    answer = await robot.http.patch("/mock/battery_level", json=body)

    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == ["/value"]
    held = (await robot.get("/mock"))["items"]
    assert {"signal": "battery_level", "value": 1.0, "publishing": True} in held


async def test_a_signal_that_the_mock_does_not_have_is_not_found(robot: HttpRobot) -> None:
    answer = await robot.http.patch("/mock/mood", json={"publishing": False})

    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_SIGNAL")


async def test_where_the_mock_does_not_run_there_is_none() -> None:
    async with http_robot(mock=False) as robot:
        shown = await robot.http.get("/mock")
        changed = await robot.http.patch("/mock/battery_level", json={"value": 1})

        assert (shown.status_code, shown.json()["code"]) == (404, "NO_MOCK")
        assert (changed.status_code, changed.json()["code"]) == (404, "NO_MOCK")


async def test_the_mock_publishes_nothing_that_a_device_reads() -> None:
    base = ComputerName("base")
    own = DeviceSettings(base, (PartName("drive_base"),), ("temperature",))
    made = HttpRobot(settings=SupervisionSettings(devices={base: own}))
    assert made.backend.robot.mock is not None
    made.backend.robot.mock.leave_out(["temperature"])
    async with running(made.supervisor), made.http:
        made.supervisor.deliver(Readings((Reading("temperature", 95.0),), "can"))

        for body in ({"publishing": True}, {"value": 10}, {"value": 10, "publishing": True}):
            answer = await made.http.patch("/mock/temperature", json=body)
            assert (answer.status_code, answer.json()["code"]) == (409, "ACTS_ELSEWHERE")
        await made.pass_time(1)

        held = {item["signal"]: item for item in (await made.get("/mock"))["items"]}
        assert held["temperature"] == {"signal": "temperature", "value": 30.0, "publishing": False}
        assert (await made.get("/signals/temperature"))["value"] == 95.0
        assert (await made.get("/signals/battery_level"))["value"] == 1.0
        quiet = await made.http.patch("/mock/temperature", json={"publishing": False})
        assert quiet.status_code == 200
