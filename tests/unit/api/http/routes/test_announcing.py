"""Acknowledging and shelving over HTTP, as an operator does it."""

from typing import Any

import pytest

from domain.computers import DeviceState
from domain.simulation.node_settings import Fault
from tests.support.http_robot import HttpRobot
from tests.support.robot_with_devices import ARM_COMPUTER, device_robot, status

LOST = "/nodes/drive_base/errors/UNREACHABLE"
LOW = "/errors/BATTERY_LOW"
KNOWN = {"for_s": 600, "reason": "the charger is being mended"}


async def error_of(robot: HttpRobot, name: str, part: str | None = None) -> Any:  # noqa: ANN401
    """Return an error as it is listed."""
    listed = await robot.get("/errors" if part is None else f"/errors?part={part}")
    return next(item for item in listed["items"] if item["error"] == name and item["part"] == part)


async def lose_and_find(robot: HttpRobot) -> None:
    """Lose a node for 5 s."""
    robot.break_node("drive_base", Fault.DIE)
    await robot.pass_time(5)
    robot.break_node("drive_base", None)
    await robot.pass_time(5)


async def test_who_comes_late_finds_what_was_there_and_says_that_it_was_seen(
    robot: HttpRobot,
) -> None:
    await lose_and_find(robot)
    lost = await error_of(robot, "UNREACHABLE", "drive_base")
    assert (lost["state"], lost["message"]) == ("returned", "drive_base is unreachable")
    assert lost["since_at"] < lost["ended_at"]
    assert await robot.get("/errors?active=true") == {"items": []}

    answer = await robot.http.post(f"{LOST}/acknowledge")

    assert (answer.status_code, answer.json()["state"]) == (200, "normal")


async def test_an_error_of_the_robot_itself_is_acknowledged_while_it_is_on(
    robot: HttpRobot,
) -> None:
    await robot.http.post("/signals/battery_level", json={"value": 0.4})
    answer = await robot.http.post(f"{LOW}/acknowledge")
    assert answer.json()["errors"] == ["BATTERY_LOW"], "it is on as before"
    assert (await error_of(robot, "BATTERY_LOW"))["state"] == "acknowledged"
    await robot.http.post("/signals/battery_level", json={"value": 0.9})
    await robot.pass_time(1)
    assert (await error_of(robot, "BATTERY_LOW"))["state"] == "normal"


@pytest.mark.parametrize("path", [LOST, LOW])
@pytest.mark.parametrize(
    ("body", "status"),
    [('{"volatil": true}', 422), ('{"volatile": "yes"}', 422), ("[1]", 422), ("{seen", 400)],
)
async def test_an_acknowledgement_with_a_body_that_says_something_else_is_rejected(
    robot: HttpRobot, path: str, body: str, status: int
) -> None:
    answer = await robot.http.post(f"{path}/acknowledge", content=body)

    assert answer.status_code == status


@pytest.mark.parametrize("path", [LOST, LOW])
async def test_an_error_is_shelved_with_a_reason_until_its_time_is_up(
    robot: HttpRobot, path: str
) -> None:
    answer = await robot.http.put(f"{path}/shelf", json=KNOWN)
    assert answer.status_code == 200
    shelved = answer.json()
    assert shelved["shelved_until_at"].endswith("Z")
    assert (shelved["shelved_because"], shelved["state"]) == (KNOWN["reason"], "normal")
    await robot.pass_time(600)
    assert (await error_of(robot, shelved["error"], shelved["part"]))["shelved_until_at"] is None


async def test_an_error_is_taken_off_the_shelf_and_that_is_idempotent(robot: HttpRobot) -> None:
    await robot.http.put(f"{LOST}/shelf", json=KNOWN)
    for _ in range(2):
        assert (await robot.http.delete(f"{LOST}/shelf")).status_code == 204
    assert (await robot.http.delete(f"{LOW}/shelf")).status_code == 204
    assert (await error_of(robot, "UNREACHABLE", "drive_base"))["shelved_until_at"] is None


async def test_shelving_hides_nothing_from_the_state_of_the_robot(robot: HttpRobot) -> None:
    await robot.http.put(f"{LOW}/shelf", json=KNOWN)
    await robot.http.post("/signals/battery_level", json={"value": 0.4})
    state = await robot.get("/system_state")
    assert (state["state"], state["error_code"], state["errors"]) == ("ERROR", 1, ["BATTERY_LOW"])


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({"for_s": 600}, "/reason"),
        ({"for_s": 600, "reason": ""}, "/reason"),
        ({"for_s": 600, "reason": "   "}, "/reason"),
        ({"for_s": 0, "reason": "noise"}, "/for_s"),
        ({"for_s": 28_801, "reason": "noise"}, "/for_s"),
        ({"reason": "noise"}, "/for_s"),
        ({"for_s": 60, "reason": "noise", "forever": True}, "/forever"),
    ],
)
async def test_a_shelving_needs_a_reason_and_a_time_of_at_most_a_shift(
    robot: HttpRobot, body: dict[str, object], pointer: str
) -> None:
    for path in (LOST, LOW):
        answer = await robot.http.put(f"{path}/shelf", json=body)
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["pointer"] == pointer


@pytest.mark.parametrize(
    ("path", "code"),
    [
        ("/errors/NO_SUCH", "UNKNOWN_ERROR"),
        ("/nodes/drive_base/errors/NO_SUCH", "UNKNOWN_ERROR"),
        ("/nodes/drive_base/errors/BATTERY_LOW", "UNKNOWN_ERROR"),
        ("/nodes/no_such/errors/UNREACHABLE", "UNKNOWN_PART"),
        ("/systems/drive_base/errors/UNREACHABLE", "UNKNOWN_PART"),
    ],
)
async def test_an_unknown_error_is_not_found(robot: HttpRobot, path: str, code: str) -> None:
    for answer in (
        await robot.http.post(f"{path}/acknowledge"),
        await robot.http.put(f"{path}/shelf", json=KNOWN),
        await robot.http.delete(f"{path}/shelf"),
    ):
        assert (answer.status_code, answer.json()["code"]) == (404, code)


async def test_an_error_that_comes_and_goes_says_what_would_calm_it(robot: HttpRobot) -> None:
    for _ in range(3):
        for value in (0.4, 0.9):
            await robot.http.post("/signals/battery_level", json={"value": value})
            await robot.pass_time(1)
    low = await error_of(robot, "BATTERY_LOW")
    assert low["chattering"] is True
    assert "clear_for_s" in low["hint"]
    told = await robot.get("/events?kind=error.chattering")
    assert len(told["items"]) == 1


async def test_the_errors_that_are_open_are_those_an_operator_may_want_to_see(
    robot: HttpRobot,
) -> None:
    await lose_and_find(robot)
    await robot.http.put(f"{LOW}/shelf", json=KNOWN)
    listed = await robot.get("/errors?open=true")
    assert {(item["error"], item["state"]) for item in listed["items"]} >= {
        ("UNREACHABLE", "returned"),
        ("BATTERY_LOW", "normal"),
    }
    assert len(listed["items"]) < 5


async def test_that_a_device_was_lost_is_acknowledged_and_shelved_as_any_other_error() -> None:
    path = "/devices/arm/errors/LOST"
    async with device_robot() as (robot, _):
        for state in (DeviceState.CONNECTED, DeviceState.LOST, DeviceState.CONNECTED):
            robot.supervisor.deliver(status(ARM_COMPUTER, state))
        assert (await error_of(robot, "LOST", "arm"))["state"] == "returned"

        answer = await robot.http.post(f"{path}/acknowledge")
        assert (answer.status_code, answer.json()["state"]) == (200, "normal")

        answer = await robot.http.put(f"{path}/shelf", json=KNOWN)
        assert answer.json()["shelved_because"] == KNOWN["reason"]
        assert (await robot.http.delete(f"{path}/shelf")).status_code == 204
        assert (await error_of(robot, "LOST", "arm"))["shelved_because"] is None


@pytest.mark.parametrize("name", ["leg", "drive_base"])
async def test_what_is_no_device_has_no_errors_of_one(name: str) -> None:
    async with device_robot() as (robot, _):
        answer = await robot.http.post(f"/devices/{name}/errors/LOST/acknowledge")

    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_PART")
    assert answer.json()["hint"] == "known: base, arm"


async def test_the_name_of_a_device_is_none_of_a_node() -> None:
    async with device_robot() as (robot, _):
        assert (await robot.http.get("/nodes/arm")).status_code == 404
        assert (await robot.http.post("/nodes/arm/errors/LOST/acknowledge")).status_code == 404
        assert (await robot.http.get("/errors?part=leg")).status_code == 404
