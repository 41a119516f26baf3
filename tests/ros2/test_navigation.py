"""External controllers in processes of their own: each is told, and the robot stands."""

from collections.abc import AsyncIterator, Sequence
from contextlib import ExitStack, asynccontextmanager
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest

from tests.ros2.support.service import NodeProcess, RosRobot, node, ros_robot
from tests.support.waiting import until

# Most of it for the interfaces, which are built by the first test that needs them.
pytestmark = [pytest.mark.ros2, pytest.mark.timeout(600)]

CONTROLLER = Path(__file__).with_name("support") / "controller.py"
POLL_S = 0.02
LENGTH_M = 100
# The machine of the tests may be busy: what is late here is not wrong.
ROBOT = """
driving: {pose_stale_after_s: 2}
ros2:
  odometry: {topic: /odom}
  command: {topic: /stop_cmd, type: geometry_msgs/msg/Twist}
  navigation:
    action: /navigate_waypoints
    accepted_within_s: 5
    silent_for_s: 2
    taken_back_within_s: 2
"""


class DrivenRobot:
    """A robot, and the process of its controller."""

    def __init__(self, robot: RosRobot, controller: NodeProcess) -> None:
        self.robot = robot
        self.controller = controller

    async def submit(self, length_m: int = LENGTH_M, speed_mps: float = 2.0) -> None:
        waypoints = [{"x_m": x, "y_m": 0, "yaw_rad": 0} for x in range(length_m + 1)]
        body = {"waypoints": waypoints, "speed_mps": speed_mps}
        answer = await self.robot.http.post("/tasks", json=body)
        assert answer.is_success, answer.text

    async def until_passed(self, index: int) -> None:
        async def is_there() -> bool:
            return bool((await self.task())["target_index"] > index)

        await until(is_there, POLL_S)

    async def until_stands(self) -> None:
        async def is_so() -> bool:
            return bool(abs((await self.robot.get("/vehicle"))["speed_mps"]) < 0.05)

        await until(is_so, POLL_S)

    async def until_held(self, words: str = "") -> None:
        async def is_held() -> bool:
            return words in (await self.holds()).get("navigation", "no hold")

        await until(is_held, POLL_S)

    async def until_not_held(self) -> None:
        async def is_free() -> bool:
            return not await self.holds()

        await until(is_free, POLL_S)

    async def until_status(self, status: str) -> None:
        async def is_so() -> bool:
            return bool((await self.task())["status"] == status)

        await until(is_so, POLL_S)

    async def until_later(self, by_s: float) -> None:
        """Wait until the vehicle has reported for so long."""
        begun = await self.reported_at()

        async def is_later() -> bool:
            return (await self.reported_at() - begun).total_seconds() > by_s

        await until(is_later, POLL_S)

    async def reported_at(self) -> datetime:
        return datetime.fromisoformat((await self.robot.get("/vehicle"))["at"])

    async def task(self) -> Any:  # noqa: ANN401
        return (await self.robot.get("/tasks"))["items"][0]

    async def holds(self) -> dict[str, str]:
        items = (await self.robot.get("/holds"))["items"]
        return {hold["owner"]: hold["reason"] for hold in items}

    async def place_m(self) -> float:
        return float((await self.robot.get("/vehicle"))["pose"]["x_m"])


@asynccontextmanager
async def driven(
    manners: str, folder: Path, interfaces: Sequence[str]
) -> AsyncIterator[DrivenRobot]:
    """Run vehicle, multiplexer, controller and service, until no hold is left."""
    file = folder / "robot.yaml"
    file.write_text(ROBOT, encoding="utf-8")
    with ExitStack() as nodes:
        for name in ("vehicle", "multiplexer"):
            nodes.enter_context(node(name))
        controller = node(CONTROLLER, manners, environment=interfaces)
        process = nodes.enter_context(controller)
        options = ("--robot", str(file))
        async with ros_robot(*options, environment=interfaces) as robot:
            made = DrivenRobot(robot, process)
            await made.until_not_held()
            yield made


async def test_a_goal_is_taken_back_by_a_hold_and_goes_on_from_where_it_was(
    tmp_path: Path, interfaces: Sequence[str]
) -> None:
    async with driven("honest", tmp_path, interfaces) as robot:
        await robot.submit(length_m=15)
        await robot.until_passed(4)
        await robot.robot.http.put("/holds/operator", json={"reason": "lunch"})
        await robot.until_status("PAUSED")
        reached = (await robot.task())["target_index"]
        assert reached < 15
        await robot.robot.http.delete("/holds/operator")
        await robot.until_status("SUCCEEDED")

        started = await robot.robot.events("task.started", "task.resumed")
        assert [event["data"]["goal"] for event in started] == [1, 2]
        assert started[1]["data"]["target_index"] == reached
        assert await robot.place_m() == pytest.approx(15, abs=0.5)


async def test_a_controller_that_ignores_that_its_goal_is_taken_back_is_told_and_stopped(
    tmp_path: Path, interfaces: Sequence[str]
) -> None:
    async with driven("ignores", tmp_path, interfaces) as robot:
        await robot.submit()
        await robot.until_passed(4)
        await robot.robot.http.put("/emergency_stop", json={"engaged": True, "reason": "a child"})
        await robot.until_stands()
        await robot.until_held("did not confirm the end of a goal")
        place_m = await robot.place_m()
        await robot.until_later(3.0)

        assert await robot.place_m() == pytest.approx(place_m, abs=0.05)
        await robot.until_held("did not confirm the end of a goal")


async def test_a_controller_that_is_killed_is_told_and_its_successor_goes_on(
    tmp_path: Path, interfaces: Sequence[str]
) -> None:
    async with driven("honest", tmp_path, interfaces) as robot:
        await robot.submit(length_m=15)
        await robot.until_passed(4)
        robot.controller.kill()
        await robot.until_held("gave no feedback for 2 s")
        await robot.until_stands()
        await robot.until_held("and did not confirm")
        assert (await robot.task())["status"] == "PAUSED"
        robot.controller.start()
        await robot.until_not_held()
        await robot.until_status("SUCCEEDED")

        assert await robot.place_m() == pytest.approx(15, abs=0.5)


async def test_a_controller_that_lies_about_its_progress_is_told_and_stopped(
    tmp_path: Path, interfaces: Sequence[str]
) -> None:
    async with driven("lies", tmp_path, interfaces) as robot:
        await robot.submit()
        await robot.until_status("ABORTED")
        await robot.until_stands()

        assert "ahead of the vehicle" in (await robot.task())["reason"]
        assert await robot.place_m() < 15


async def test_a_controller_that_says_falsely_that_it_arrived_is_told_and_stopped(
    tmp_path: Path, interfaces: Sequence[str]
) -> None:
    async with driven("arrives", tmp_path, interfaces) as robot:
        await robot.submit()
        await robot.until_status("ABORTED")
        assert "from the last waypoint" in (await robot.task())["reason"]
        await robot.until_held("drives without a goal")
        await robot.until_stands()

        assert await robot.place_m() < 15
