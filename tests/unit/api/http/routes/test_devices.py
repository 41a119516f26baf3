"""`/devices`, and devices in frames, as an operator sees them."""

from collections.abc import AsyncIterator

import pytest

from domain.computers import DeviceState, PeerStop, StopId
from domain.devices.settings import LeadSettings
from domain.inputs import NodeReport, PeerStops, SupervisorStatus
from domain.supervision import SupervisionSettings
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.models import ARM
from tests.support.robot_with_devices import (
    ARM_COMPUTER,
    BASE_COMPUTER,
    DEVICES,
    ToldLink,
    device_robot,
    heard,
    status,
)


@pytest.fixture
async def robot_and_link() -> AsyncIterator[tuple[HttpRobot, ToldLink]]:
    async with device_robot() as made:
        yield made


@pytest.fixture
def robot(robot_and_link: tuple[HttpRobot, ToldLink]) -> HttpRobot:
    return robot_and_link[0]


@pytest.fixture
def link(robot_and_link: tuple[HttpRobot, ToldLink]) -> ToldLink:
    return robot_and_link[1]


async def test_a_robot_of_one_computer_has_no_devices() -> None:
    async with http_robot() as robot:
        assert await robot.get("/devices") == {"items": []}
        assert (await robot.get("/nodes/drive_base"))["device"] is None


async def test_devices_that_were_not_heard_yet_say_what_they_own_and_would_do(
    robot: HttpRobot,
) -> None:
    base, arm = (await robot.get("/devices"))["items"]

    assert base == {
        "device": "base",
        "state": "never_seen",
        "reason": "",
        "since_at": "2026-01-01T00:00:00.000Z",
        "parts": ["drive_base"],
        "heard_at": None,
        "heard_age_s": None,
        "incarnation": None,
        "session": None,
        "autonomous": False,
        "offline": {"after_s": 2.0, "target": {"drive_base": "inactive"}, "reactions": True},
        "stops": [],
        "version": None,
        "refused": "",
    }
    assert arm["offline"] == {"after_s": 2.0, "target": {}, "reactions": False}


async def test_a_device_that_is_connected_says_when_it_was_heard(
    robot: HttpRobot, link: ToldLink
) -> None:
    robot.supervisor.submit(status(BASE_COMPUTER))
    link.connections[BASE_COMPUTER] = heard(robot.clock.now())
    await robot.pass_time(0.25)

    base, _ = (await robot.get("/devices"))["items"]

    assert (base["state"], base["heard_age_s"], base["version"]) == ("connected", 0.25, "0.1.0")
    assert (base["incarnation"], base["session"]) == ("1" * 32, "2" * 32)


async def test_the_stops_that_are_engaged_on_a_device_are_named(robot: HttpRobot) -> None:
    robot.supervisor.submit(status(ARM_COMPUTER))
    stop = PeerStop(StopId("arm-7"), "anna", "smoke", robot.clock.now())
    robot.supervisor.submit(PeerStops(ARM_COMPUTER, (stop,)))

    _, arm = (await robot.get("/devices"))["items"]

    assert arm["stops"] == ["arm-7"]


async def test_a_part_says_on_which_device_it_is_and_a_lost_one_where_it_was(
    robot: HttpRobot,
) -> None:
    robot.supervisor.submit(status(ARM_COMPUTER))
    await robot.bring_to("manipulator", "STRONG")
    robot.supervisor.submit(status(ARM_COMPUTER, DeviceState.LOST, "nothing was heard for 1.5 s"))
    robot.supervisor.submit(NodeReport(ARM, reachable=False))

    part = await robot.get("/nodes/manipulator")

    assert (part["device"], part["reachable"]) == ("arm", False)
    assert part["actual"]["state"] == "unknown"
    assert part["last_known"] == {"state": "active", "mode": "STRONG"}
    assert (await robot.get("/systems/actuation"))["device"] is None


async def test_a_device_itself_says_whose_word_counts() -> None:
    settings = SupervisionSettings(lead=LeadSettings(ARM_COMPUTER, DEVICES[BASE_COMPUTER].offline))
    async with http_robot(settings=settings) as robot:
        alone = await robot.get("/devices")
        robot.supervisor.submit(SupervisorStatus(DeviceState.CONNECTED))
        led = await robot.get("/devices")

    assert alone == {
        "items": [],
        "this": {
            "device": "arm",
            "lead": "nobody",
            "supervisor": "never_seen",
            "since_at": "2026-01-01T00:00:00.000Z",
            "reason": "",
            "when_cut_off": "after 2 s: drive_base to inactive; its reactions act",
        },
    }
    assert (led["this"]["lead"], led["this"]["supervisor"]) == ("supervisor", "connected")


async def test_the_errors_of_a_device_are_listed_acknowledged_and_shelved_by_its_name(
    robot: HttpRobot,
) -> None:
    robot.supervisor.submit(status(ARM_COMPUTER))
    robot.supervisor.submit(status(ARM_COMPUTER, DeviceState.LOST, "nothing was heard for 1.5 s"))
    (lost,) = (await robot.get("/errors?part=arm&active=true"))["items"]
    assert (lost["part"], lost["error"], lost["severity"]) == ("arm", "LOST", "urgent")

    path = "/devices/arm/errors/LOST"
    seen = await robot.http.post(f"{path}/acknowledge")
    shelved = await robot.http.put(f"{path}/shelf", json={"for_s": 60, "reason": "it is mended"})

    assert (seen.status_code, seen.json()["state"]) == (200, "acknowledged")
    assert shelved.json()["shelved_until_at"] == "2026-01-01T00:01:00.000Z"
    assert (await robot.http.delete(f"{path}/shelf")).status_code == 204


async def test_a_device_that_there_is_not_is_unknown(robot: HttpRobot) -> None:
    answer = await robot.http.post("/devices/leg/errors/LOST/acknowledge")

    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_PART")
    assert "device" in answer.json()["detail"]
