"""Nodes that die, and what is told of them; nodes that come back, and what is done then."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from tests.ros2.support.service import SLOW_MANIPULATOR, NodeProcess, RosRobot, node, ros_robot

pytestmark = pytest.mark.ros2

LONG_S = "60"
QUICK_S = "0"


@asynccontextmanager
async def two_nodes(
    activation_s: str, *options: str, robot_file: Path | None = None
) -> AsyncIterator[tuple[RosRobot, NodeProcess]]:
    """Run both nodes and the service; yield the service, and the manipulator to be killed."""
    settings = () if robot_file is None else ("--robot", str(robot_file))
    with node("drive_base"), node(SLOW_MANIPULATOR, activation_s, *options) as manipulator:
        async with ros_robot(*settings) as robot:
            await robot.until_reachable("drive_base", "manipulator")
            yield robot, manipulator


async def reachability(robot: RosRobot, name: str) -> list[str]:
    """Return what was told of a node's coming and going, in order."""
    events = await robot.events("node.reachable", "node.unreachable")
    return [event["kind"] for event in events if event["data"]["node"] == name]


async def test_a_node_killed_in_a_mode_change_fails_the_change_and_the_system_deviates() -> None:
    async with two_nodes(LONG_S) as (robot, manipulator):
        change = await robot.begin("/systems/actuation/mode", mode="PERFORMANCE")
        await robot.until_state("manipulator", "activating")

        manipulator.kill()
        ended = await robot.ended(change)

        assert ended["status"] in ("failed", "timed_out")
        assert ended["reason"].startswith("manipulator: activate: ")
        assert [(s["node"], s["status"]) for s in ended["steps"]] == []
        system = await robot.get("/systems/actuation")
        assert not system["converged"]
        begun = await robot.events("part.deviation_began")
        assert [(event["data"]["part"], event["data"]["reason"]) for event in begun] == []


@pytest.mark.parametrize("options", [(), ("--no-heartbeat",)], ids=["heartbeat", "polled"])
async def test_a_node_that_is_gone_is_missed_and_seen_again(options: tuple[str, ...]) -> None:
    async with two_nodes(QUICK_S, *options) as (robot, manipulator):
        manipulator.kill()
        missed = await robot.until_part("/nodes/manipulator", reachable=False)

        manipulator.start()
        back = await robot.until_part("/nodes/manipulator", reachable=True)

        assert missed["actual"]["state"] == "unknown"
        assert back["actual"]["state"] == "unconfigured"
        assert await reachability(robot, "manipulator") == [
            "node.reachable",
            "node.unreachable",
            "node.reachable",
        ]
