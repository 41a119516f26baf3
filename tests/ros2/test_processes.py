"""A service that runs the programs of its nodes: one crashes, and none outlives the service."""

import os
import signal
import sys
from pathlib import Path

import pytest

from tests.ros2.support.service import NODES, POLL_S, RosRobot, ros_robot
from tests.support.waiting import until

pytestmark = [pytest.mark.ros2, pytest.mark.timeout(240)]

BASE, ARM = "drive_base", "manipulator"
ENDS_WITHIN_S = 30.0
ROBOT = f"""\
nodes:
  {BASE}:
    on_return: restore
    process:
      command: [{sys.executable}, {NODES / "drive_base.py"}]
      environment: {{PYTHONUNBUFFERED: "1"}}
  {ARM}:
    process:
      command: [{sys.executable}, {NODES / "manipulator.py"}]
"""


@pytest.fixture
def robot_file(tmp_path: Path) -> str:
    file = tmp_path / "robot.yaml"
    file.write_text(ROBOT)
    return str(file)


async def pid_of(robot: RosRobot, node: str) -> int | None:
    pid: int | None = (await robot.get(f"/nodes/{node}/process"))["pid"]
    return pid


async def running(robot: RosRobot) -> list[int]:
    """Return the processes of both nodes, which are reachable by then."""
    await robot.until_reachable(BASE, ARM)
    return [pid for node in (BASE, ARM) if (pid := await pid_of(robot, node)) is not None]


def is_alive(pid: int) -> bool:
    try:
        return ") Z " not in Path(f"/proc/{pid}/stat").read_text()
    except FileNotFoundError:
        return False


async def test_a_node_that_crashes_is_started_again_and_restored(robot_file: str) -> None:
    async with ros_robot("--robot", robot_file, "--data", ":memory:") as robot:
        first, _ = await running(robot)
        await robot.do(f"/nodes/{BASE}/mode", mode="SLOW")

        os.kill(first, signal.SIGKILL)

        async def is_another_one() -> bool:
            return await pid_of(robot, BASE) not in (None, first)

        await until(is_another_one, POLL_S)
        await robot.until_state(BASE, "active")
        ended = (await robot.get(f"/nodes/{BASE}/process"))["exit"]
        assert (ended["signal"], ended["code"]) == ("SIGKILL", None)
        assert any("motors on" in line for line in ended["output"])
        raised = await robot.events("error.raised")
        assert "PROCESS_ENDED" in [event["data"]["error"] for event in raised]


async def test_the_nodes_end_with_the_service(robot_file: str) -> None:
    async with ros_robot("--robot", robot_file, "--data", ":memory:") as robot:
        pids = await running(robot)

        robot.process.send_signal(signal.SIGTERM)

        code, _, _ = robot.process.ended(within_s=ENDS_WITHIN_S)
        assert (code, [pid for pid in pids if is_alive(pid)]) == (0, [])
        assert len(pids) == 2


async def test_the_nodes_end_with_a_service_that_is_killed(robot_file: str) -> None:
    async with ros_robot("--robot", robot_file, "--data", ":memory:") as robot:
        pids = await running(robot)

        robot.process.kill()

        await until(lambda: not any(map(is_alive, pids)), POLL_S)
        assert len(pids) == 2
