"""Nodes that die, and what is told of them; nodes that come back, and what is done then."""

from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from tests.ros2.support.service import SLOW_MANIPULATOR, NodeProcess, RosRobot, node, ros_robot

pytestmark = pytest.mark.ros2

FOR_EVER_S = "600"
AT_ONCE_S = "0"


@pytest.fixture
def robot_file(tmp_path: Path) -> Path:
    path = tmp_path / "robot.yaml"
    path.write_text("changes: {transition_deadline_s: 3.0}\n", encoding="utf-8")
    return path


def restore(robot_file: Path) -> None:
    """Let the manipulator be brought to its target when it returns."""
    with robot_file.open("a", encoding="utf-8") as file:
        file.write("nodes: {manipulator: {on_return: restore}}\n")


@pytest.fixture
def drive_base() -> Iterator[NodeProcess]:
    with node("drive_base") as process:
        yield process


@asynccontextmanager
async def two_nodes(
    robot_file: Path, activation_s: str, *options: str
) -> AsyncIterator[tuple[RosRobot, NodeProcess]]:
    """Run the manipulator and the service; yield the service, and the manipulator to be killed."""
    with node(SLOW_MANIPULATOR, activation_s, *options) as manipulator:
        async with ros_robot("--robot", str(robot_file)) as robot:
            await robot.until_reachable("drive_base", "manipulator")
            yield robot, manipulator


async def kill_in_a_mode_change(robot: RosRobot, manipulator: NodeProcess) -> None:
    """Kill it while the system goes to PERFORMANCE, and see what is told of that."""
    change = await robot.begin("/systems/actuation/mode", mode="PERFORMANCE")
    await robot.until_state("manipulator", "activating")

    manipulator.kill()

    ended = await robot.ended(change)
    assert ended["status"] == "timed_out"
    assert ended["reason"] == "manipulator: activate: the node is unreachable"
    assert [step["node"] for step in ended["steps"] if step["status"] != "succeeded"] == [
        "manipulator"
    ]


async def assert_it_deviates_since(robot: RosRobot, node: str) -> None:
    """See that the system deviates and says because of which node."""
    system = await robot.get("/systems/actuation")
    assert (system["converged"], system["reachable"]) == (False, False)
    assert system["target"] == {"state": "active", "mode": "PERFORMANCE"}
    assert system["actual"]["reason"] == f"{node} is unreachable"


@pytest.mark.usefixtures("drive_base")
async def test_a_node_killed_in_a_mode_change_fails_it_and_is_left_when_it_is_back(
    robot_file: Path,
) -> None:
    async with two_nodes(robot_file, FOR_EVER_S) as (robot, manipulator):
        await kill_in_a_mode_change(robot, manipulator)
        await assert_it_deviates_since(robot, "manipulator")

        with node(SLOW_MANIPULATOR, AT_ONCE_S):
            await robot.until_reachable("manipulator")

            assert (await robot.actual())["manipulator"] == ("unconfigured", None)
            assert (await robot.actual())["drive_base"] == ("active", "FAST")
            assert not (await robot.get("/systems/actuation"))["converged"]
            assert [c["id"] for c in (await robot.get("/changes"))["items"]] == ["c1"]


@pytest.mark.usefixtures("drive_base")
async def test_a_node_killed_in_a_mode_change_is_brought_there_when_it_is_back(
    robot_file: Path,
) -> None:
    restore(robot_file)
    async with two_nodes(robot_file, FOR_EVER_S) as (robot, manipulator):
        await kill_in_a_mode_change(robot, manipulator)
        await assert_it_deviates_since(robot, "manipulator")

        with node(SLOW_MANIPULATOR, AT_ONCE_S):
            await robot.until_part("/systems/actuation", converged=True)

            assert (await robot.actual())["actuation"] == ("active", "PERFORMANCE")
            restored = (await robot.get("/changes"))["items"][0]
            assert (restored["part"], restored["status"]) == ("manipulator", "succeeded")


@pytest.mark.usefixtures("drive_base")
@pytest.mark.parametrize("options", [(), ("--no-heartbeat",)], ids=["heartbeat", "polled"])
async def test_a_node_that_dies_is_missed_and_seen_again(
    robot_file: Path, options: tuple[str, ...]
) -> None:
    async with two_nodes(robot_file, AT_ONCE_S, *options) as (robot, manipulator):
        manipulator.kill()
        missed = await robot.until_part("/nodes/manipulator", reachable=False)
        assert missed["actual"]["reason"] == "manipulator is unreachable"

        manipulator.start()
        back = await robot.until_part("/nodes/manipulator", reachable=True)
        assert back["actual"]["state"] == "unconfigured"
        told = await robot.events("node.reachable", "node.unreachable")
        assert [event["kind"] for event in told if event["data"]["node"] == "manipulator"] == [
            "node.reachable",
            "node.unreachable",
            "node.reachable",
        ]


@pytest.mark.usefixtures("drive_base")
async def test_a_node_that_starts_only_after_it_was_asked_for_is_brought_there(
    robot_file: Path,
) -> None:
    restore(robot_file)
    async with ros_robot("--robot", str(robot_file)) as robot:
        await robot.until_reachable("drive_base")
        change = await robot.begin("/systems/actuation/mode", mode="MODERATE")
        assert (await robot.ended(change))["reason"] == "manipulator is unreachable"

        with node("manipulator"):
            await robot.until_part("/systems/actuation", converged=True)

            assert (await robot.actual())["actuation"] == ("active", "MODERATE")
