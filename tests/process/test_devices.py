"""A robot of several computers, each a process of its own, over zenoh."""

import asyncio
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.robot_of_computers import RobotOfComputers, robot_of_computers

pytest.importorskip("zenoh", reason="the extra `link` is not installed")
pytestmark = pytest.mark.timeout(180)

LATE_WITHIN_S, LOST_WITHIN_S = 0.7, 1.8
RETURN_WITHIN_S = 2.0
SEEN_S = 0.3
"""What a busy machine and the asking take on top."""
ALL_INACTIVE = {
    "actuation": ("inactive", None),
    "drive_base": ("inactive", None),
    "manipulator": ("inactive", None),
}
ALL_ACTIVE = {
    "actuation": ("active", "PERFORMANCE"),
    "drive_base": ("active", "FAST"),
    "manipulator": ("active", "STRONG"),
}


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[RobotOfComputers]:
    with robot_of_computers(tmp_path) as robot:
        yield robot


async def test_the_four_steps_of_annex_4_with_both_nodes_on_other_computers(
    robot: RobotOfComputers,
) -> None:
    """D4.8, Annex 4, 6.2.2: the same exact states as on one computer."""
    supervisor, base, arm = robot.all()
    await supervisor.until_connected("base", "arm")

    supervisor.ask("/systems/actuation/state", transition="configure")
    assert supervisor.actual() == ALL_INACTIVE

    supervisor.ask("/systems/actuation/state", transition="activate")
    assert supervisor.actual() == {
        "actuation": ("active", "__DEFAULT__"),
        "drive_base": ("active", "__DEFAULT__"),
        "manipulator": ("inactive", None),
    }

    supervisor.ask("/systems/actuation/mode", mode="PERFORMANCE")
    assert supervisor.actual() == ALL_ACTIVE

    supervisor.ask("/nodes/drive_base/mode", mode="SLOW")
    supervisor.ask("/nodes/manipulator/mode", mode="WEAK")
    assert supervisor.actual() == {
        "actuation": ("activating", "MODERATE"),
        "drive_base": ("active", "SLOW"),
        "manipulator": ("active", "WEAK"),
    }
    assert supervisor.targets() == {
        "actuation": ("active", "PERFORMANCE"),
        "drive_base": ("active", "SLOW"),
        "manipulator": ("active", "WEAK"),
    }
    # Each device sees its own part, and nothing of the other.
    assert base.actual() == {"drive_base": ("active", "SLOW")}
    assert arm.actual() == {"manipulator": ("active", "WEAK")}


async def test_a_device_that_is_killed_is_lost_in_time_and_returns_as_new(
    robot: RobotOfComputers,
) -> None:
    supervisor, _, arm = robot.all()
    await supervisor.until_connected("base", "arm")
    supervisor.ask("/systems/actuation/mode", mode="PERFORMANCE")
    before = supervisor.devices()["arm"]

    arm.kill()
    killed_at = time.monotonic()
    await supervisor.until(lambda: supervisor.device_states()["arm"] == "lost")
    lost_after_s = time.monotonic() - killed_at
    node = supervisor.get("/nodes/manipulator")

    assert lost_after_s < LOST_WITHIN_S + SEEN_S
    assert node["reachable"] is False
    assert supervisor.device_states()["base"] == "connected"

    robot.device("arm")
    await supervisor.until_connected("arm")
    after = supervisor.devices()["arm"]

    assert after["incarnation"] != before["incarnation"]
    assert after["session"] != before["session"]
    # Its target is not pursued by itself: the process is new, and so are its nodes.
    assert supervisor.actual()["manipulator"] == ("unconfigured", None)


async def test_a_supervisor_that_is_killed_and_started_again_knows_all_and_commands_nothing(
    robot: RobotOfComputers, tmp_path: Path
) -> None:
    keeps = "--data", str(tmp_path / "supervisor")
    supervisor, base, arm = robot.all(*keeps)
    await supervisor.until_connected("base", "arm")
    supervisor.ask("/systems/actuation/mode", mode="PERFORMANCE")

    supervisor.kill()
    # Meanwhile the robot is no longer what was asked for.
    arm.kill()
    arm = robot.device("arm")
    supervisor = robot.supervisor(*keeps)
    begun = time.monotonic()
    await supervisor.until_connected("base", "arm")
    took_s = time.monotonic() - begun

    assert took_s < RETURN_WITHIN_S + SEEN_S
    assert supervisor.actual()["drive_base"] == ("active", "FAST")
    assert supervisor.actual()["manipulator"] == ("unconfigured", None)
    await asyncio.sleep(1.5)  # Nothing comes: that can only be waited for.
    assert arm.actual() == {"manipulator": ("unconfigured", None)}
    assert base.actual() == {"drive_base": ("active", "FAST")}
    assert supervisor.targets()["manipulator"] == ("active", "STRONG")


async def test_of_two_processes_of_one_device_the_first_stays_and_the_second_is_refused(
    robot: RobotOfComputers,
) -> None:
    supervisor, _, arm = robot.all()
    await supervisor.until_connected("base", "arm")
    supervisor.ask("/systems/actuation/mode", mode="PERFORMANCE")
    incumbent = supervisor.devices()["arm"]["incarnation"]

    newcomer = robot.device("arm")
    await supervisor.until(lambda: "DEVICE_CONFLICT" in supervisor.active_errors())
    await newcomer.until(lambda: newcomer.get("/devices")["this"]["supervisor"] == "conflict")

    assert supervisor.devices()["arm"]["incarnation"] == incumbent
    assert supervisor.actual() == ALL_ACTIVE
    assert arm.actual() == {"manipulator": ("active", "STRONG")}
    assert newcomer.actual() == {"manipulator": ("unconfigured", None)}
    supervisor.ask("/nodes/manipulator/mode", mode="WEAK")
    assert newcomer.actual() == {"manipulator": ("unconfigured", None)}


async def test_a_second_supervisor_is_refused_and_says_so(robot: RobotOfComputers) -> None:
    first = robot.supervisor()
    arm = robot.device("arm")
    await first.until_connected("arm")

    second = robot.supervisor("--link", "tcp/127.0.0.1:0")
    await second.until(lambda: second.device_states()["arm"] == "conflict")

    second.ask("/nodes/manipulator/state", status=409, transition="configure")
    assert arm.actual() == {"manipulator": ("unconfigured", None)}
    first.ask("/nodes/manipulator/state", transition="configure")
    assert arm.actual() == {"manipulator": ("inactive", None)}


async def test_whoever_asks_at_the_page_of_a_device_is_sent_to_the_supervisor(
    robot: RobotOfComputers,
) -> None:
    supervisor = robot.supervisor()
    arm = robot.device("arm")
    await supervisor.until_connected("arm")
    supervisor.ask("/nodes/manipulator/mode", mode="WEAK")

    problem = arm.ask("/nodes/manipulator/mode", status=409, mode="STRONG")
    assert problem["code"] == "OWNED_BY_SUPERVISOR"
    arm.ask("/nodes/manipulator/state", transition="deactivate")
    assert arm.actual() == {"manipulator": ("inactive", None)}


async def test_a_stop_at_a_device_stops_the_robot_and_one_at_the_supervisor_the_device(
    robot: RobotOfComputers,
) -> None:
    supervisor, base, arm = robot.all()
    await supervisor.until_connected("base", "arm")

    arm.ask("/emergency_stop", method="PUT", engaged=True, reason="a hand in the arm")
    for other in (supervisor, base):
        await other.until(lambda other=other: other.get("/emergency_stop")["engaged"])

    supervisor.ask("/emergency_stop", method="PUT", engaged=False)
    for each in (supervisor, base, arm):
        await each.until(lambda each=each: not each.get("/emergency_stop")["engaged"])


async def test_the_stop_of_a_device_that_is_gone_outlives_a_release_and_the_supervisor(
    robot: RobotOfComputers, tmp_path: Path
) -> None:
    keeps = [("--data", str(tmp_path / name)) for name in ("supervisor", "arm")]
    supervisor, arm = robot.supervisor(*keeps[0]), robot.device("arm", *keeps[1])
    await supervisor.until_connected("arm")
    arm.ask("/emergency_stop", method="PUT", engaged=True, reason="a hand in the arm")
    await supervisor.until(lambda: supervisor.get("/emergency_stop")["engaged"])
    arm.kill()
    await supervisor.until(lambda: supervisor.device_states()["arm"] == "lost")

    left = supervisor.ask("/emergency_stop", method="PUT", engaged=False)
    assert ([stop["device"] for stop in left["stops"]], "arm" in left["not_heard"]) == (
        ["arm"],
        True,
    )
    supervisor.kill()
    supervisor = robot.supervisor(*keeps[0])
    assert supervisor.get("/emergency_stop")["stops"][0]["id"] == left["stops"][0]["id"]

    robot.device("arm", *keeps[1])
    await supervisor.until_connected("arm")
    assert supervisor.get("/emergency_stop")["engaged"], "nobody released it since it is back"
    supervisor.ask("/emergency_stop", method="PUT", engaged=False)
    await supervisor.until(lambda: not supervisor.get("/emergency_stop")["engaged"])
