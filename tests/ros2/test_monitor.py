"""`pilothouse monitor --ros2` beside a service, without one, and beside another mode manager."""

import asyncio
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from service.ros.graph.graph import Lane, Qos
from tests.ros2.support.links import POLL_S, Link
from tests.ros2.support.monitor import MODEL, Monitor, monitor, table_of
from tests.ros2.support.service import NodeProcess, RosRobot, Shown, node, ros_robot
from tests.support.process import run

# Several processes start one after the other, each of which imports rclpy.
pytestmark = [pytest.mark.ros2, pytest.mark.timeout(180)]

LIFECYCLE_TOOL = Path(__file__).parent / "support" / "lifecycle_tool.py"
PERFORMANCE: Shown = {
    "actuation": ("active", "PERFORMANCE"),
    "drive_base": ("active", "FAST"),
    "manipulator": ("active", "STRONG"),
}


@pytest.fixture
def nodes() -> Iterator[dict[str, NodeProcess]]:
    names = ("drive_base", "manipulator")
    with ExitStack() as running:
        yield {name: running.enter_context(node(name)) for name in names}


async def lifecycle(*command: str) -> str:
    """Use a node as `ros2 lifecycle` does, and return what that prints."""
    done = await asyncio.to_thread(
        subprocess.run,
        [sys.executable, str(LIFECYCLE_TOOL), *command],
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


async def ran(*command: str) -> tuple[int, str, str]:
    return await asyncio.to_thread(run, *command, within_s=60.0)


async def shows_the_same(watching: Monitor, robot: RosRobot) -> None:
    """Wait until the monitor shows what the service shows, actual and target."""
    actual = await robot.actual()
    targets = await robot.targets()
    await watching.until(lambda seen: (seen.actual(), seen.targets()) == (actual, targets))


async def test_beside_a_service_it_shows_the_same_and_goes_on_without_it(
    nodes: dict[str, NodeProcess],
) -> None:
    async with ros_robot() as robot, monitor() as watching:
        await robot.until_reachable(*nodes)
        await robot.do("/systems/actuation/state", transition="configure")
        await shows_the_same(watching, robot)

        await robot.do("/systems/actuation/state", transition="activate")
        await shows_the_same(watching, robot)

        await robot.do("/systems/actuation/mode", mode="PERFORMANCE")
        await shows_the_same(watching, robot)
        assert watching.actual() == watching.targets() == PERFORMANCE

        await robot.do("/nodes/drive_base/mode", mode="SLOW")
        await robot.do("/nodes/manipulator/mode", mode="WEAK")
        await shows_the_same(watching, robot)
        assert watching.actual()["actuation"] == ("activating", "MODERATE")

        robot.process.kill()
        assert await lifecycle("set", "/drive_base", "deactivate") == "Transitioning successful"
        await watching.until(lambda seen: seen.actual()["drive_base"] == ("inactive", None))
        assert watching.targets()["actuation"] == ("active", "PERFORMANCE")
        assert watching.actual()["actuation"] == ("activating", None)

        nodes["manipulator"].kill()
        await watching.until(lambda seen: not seen.is_reachable("manipulator"))

        assert await watching.interrupt() == (0, "")


async def test_one_picture_has_the_table_that_a_monitor_of_the_service_has(
    nodes: dict[str, NodeProcess],
) -> None:
    async with ros_robot() as robot:
        await robot.until_reachable(*nodes)
        await robot.do("/systems/actuation/mode", mode="PERFORMANCE")
        await robot.do("/nodes/drive_base/mode", mode="SLOW")
        code, of_ros, complaints = await ran("monitor", "--ros2", MODEL, "--once")
        _, of_service, _ = await ran("monitor", robot.process.url, "--once")

    assert (code, complaints) == (0, "")
    assert of_ros.startswith(" System Modes Monitor - ")
    assert f" Model: {MODEL}"[:70] in of_ros
    assert table_of(of_ros) == table_of(of_service)
    assert any("activating(*)" in line for line in table_of(of_ros))


async def test_a_mode_manager_that_latches_nothing_is_heard(
    nodes: dict[str, NodeProcess], link: Link
) -> None:
    # As that of system_modes, which sends no time stamps either; its package is not installed here,
    # and so the mode is in the label of a state.
    manager = link.node("mode_manager", Lane.GATEWAY)
    topic, kind = "/actuation/mode_request_info", "lifecycle_msgs/msg/TransitionEvent"
    requests = manager.publisher(topic, kind, Qos.EVENTS)

    async def request_forever() -> None:
        while True:
            requests.publish({"goal_state": {"id": 3, "label": "active.PERFORMANCE"}})
            await asyncio.sleep(POLL_S)

    async with monitor() as watching:
        requesting = asyncio.create_task(request_forever())
        await watching.until(
            lambda seen: seen.targets() == {"actuation": ("active", "PERFORMANCE")}
        )
        requesting.cancel()


async def test_without_any_node_there_is_no_picture() -> None:
    code, output, complaints = await ran("monitor", "--ros2", MODEL, "--once")

    assert (code, output) == (2, "")
    assert "no node of" in complaints
