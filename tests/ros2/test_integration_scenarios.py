"""The two integration scenarios of smart_polaris, with everything in processes of its own.

Planner: `pilothouse serve`. Controller: `pilothouse tracker`, an action server. Vehicle and
signals: example nodes. An error before and during the drive: the goal is taken back, speed 0 is
commanded, and the task goes on from its target index, with one goal each time.

Source: smart_polaris, `gem_integration_tests`, tests 01 and 02.
"""

import re
from collections.abc import AsyncIterator, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from service.ros.graph.graph import Lane, Qos
from tests.ros2.support.links import Link
from tests.ros2.support.street import ACTION, Running, Watch, example, running, soon
from tests.support.process import COMMAND, ServiceProcess, service

# Most of it for the interfaces, which are built by the first test that needs them.
pytestmark = [pytest.mark.ros2, pytest.mark.timeout(600)]

MODEL = "robot: {ros__parameters: {type: node}}\n"
ROBOT = f"""\
backend: ros2
# A busy machine delays messages.
driving: {{pose_stale_after_s: 2.0}}
ros2:
  odometry: {{topic: /odom}}
  command: {{topic: /cmd_vel, type: geometry_msgs/msg/Twist}}
  navigation: {{action: {ACTION}, accepted_within_s: 5.0, silent_for_s: 5.0}}
"""
ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED = 1, 2, 3, 4, 5
"""Of a goal; source: action_msgs/msg/GoalStatus."""
IS_ACTIVE = {ACCEPTED, EXECUTING, CANCELING}


class Robot:
    """The robot as its operator and a ROS client see it."""

    def __init__(
        self, link: Link, planner: ServiceProcess, http: httpx.AsyncClient, tracker: Running
    ) -> None:
        self.watch = Watch(link)
        self.planner = planner
        self._http = http
        self._tracker = tracker
        self.goals: tuple[int, ...] = ()
        """Status of each goal that the action server knows."""
        link.node("goals", Lane.SENSORS).subscribe(
            f"{ACTION}/_action/status",
            "action_msgs/msg/GoalStatusArray",
            Qos.LATCHED,
            lambda message: tuple(each.status for each in message.status_list),
            self._take_goals,
        )

    def _take_goals(self, goals: tuple[int, ...]) -> None:
        self.goals = goals

    @property
    def start_indices(self) -> list[int]:
        """Return the waypoint at which each goal began that the controller got."""
        return [int(index) for index in re.findall(r"waypoints from (\d+) on", self._tracker.text)]

    async def serve(self, length_m: float) -> None:
        """Submit a task along the x axis."""
        waypoints = [{"x_m": float(x), "y_m": 0.0, "yaw_rad": 0.0} for x in range(int(length_m))]
        answer = await self._http.post("/tasks", json={"waypoints": waypoints, "speed_mps": 2.0})
        assert answer.is_success, answer.text

    async def get(self, path: str) -> Any:  # noqa: ANN401
        """Return what a GET answers."""
        return (await self._http.get(path)).json()

    async def becomes(self, state: str, task: str) -> None:
        """Wait for a state of the robot and of its task."""
        seen: dict[str, Any] = {}

        async def is_so() -> bool:
            seen.update(await self.get("/system_state"))
            return (seen["state"], seen["task_status"]) == (state, task)

        await soon(is_so, f"{state} and {task}", lambda: f"{seen}\n{self.told()}")

    def told(self) -> str:
        """Return what the controller said, and how the vehicle moves."""
        watch = self.watch
        return f"{self._tracker.text}\n{watch.pose} {watch.speed_mps} {watch.commands[-5:]}"

    async def has_active_goals(self, count: int) -> None:
        """Wait until the controller has so many goals that have not ended."""
        await soon(
            lambda: sum(status in IS_ACTIVE for status in self.goals) == count,
            f"{count} active goals",
            self.told,
        )

    async def press_estop(self, *, pressed: bool) -> None:
        """Press or release the emergency stop."""
        await self.watch.parameters.set("signals", "estop", pressed)


@asynccontextmanager
async def robot(
    link: Link, interfaces: Sequence[str], folder: Path, tracker: str
) -> AsyncIterator[Robot]:
    """Run planner, controller, vehicle and signals; the robot is IDLE."""
    model, settings = folder / "model.yaml", folder / "robot.yaml"
    model.write_text(MODEL)
    settings.write_text(ROBOT)
    async with AsyncExitStack() as stack:
        enter = stack.enter_async_context
        await enter(running(*example("vehicle")))
        await enter(running(*example("signals"), environment=interfaces))
        options = (str(model), "--robot", str(settings))
        controller = await enter(
            running(*COMMAND, "tracker", "--tracker", tracker, *options, environment=interfaces)
        )
        planner = stack.enter_context(service(*options, command=("env", *interfaces, *COMMAND)))
        http = await enter(httpx.AsyncClient(base_url=planner.url, timeout=60))
        made = Robot(link, planner, http, controller)
        await made.watch.there()
        await made.becomes("IDLE", "NO_TASK")
        yield made


async def test_a_task_that_is_served_in_error_waits_and_is_driven_when_the_error_clears(
    link: Link, interfaces: Sequence[str], tmp_path: Path
) -> None:
    async with robot(link, interfaces, tmp_path, "pure_pursuit") as on:
        await on.press_estop(pressed=True)
        await on.becomes("ERROR", "NO_TASK")

        await on.serve(40)

        await on.becomes("ERROR", "PAUSED_TASK")
        assert on.start_indices == []
        assert all(speed == 0.0 for speed, _ in on.watch.commands)

        await on.press_estop(pressed=False)

        await on.becomes("RUNNING", "RUNNING_TASK")
        await on.has_active_goals(1)
        await on.watch.drives(on.told)
        assert on.start_indices == [0], "one goal"


async def test_an_error_during_the_drive_stops_the_vehicle_and_the_task_goes_on_after_it(
    link: Link, interfaces: Sequence[str], tmp_path: Path
) -> None:
    async with robot(link, interfaces, tmp_path, "stanley") as on:
        await on.serve(25)
        await on.becomes("RUNNING", "RUNNING_TASK")
        await on.has_active_goals(1)
        await soon(lambda: on.watch.pose[0] > 5.0, "that the vehicle is on its way", on.told)

        await on.press_estop(pressed=True)

        await on.becomes("ERROR", "PAUSED_TASK")
        await on.has_active_goals(0)
        await on.watch.stands()
        assert on.goals == (CANCELED,)
        assert on.watch.commands[-1][0] == 0.0
        stopped = len(on.watch.commands)
        reached = (await on.get("/tasks/current"))["target_index"]
        assert reached == int(on.watch.pose[0]) + 1, "the first waypoint not yet passed"
        assert [hold["owner"] for hold in (await on.get("/holds"))["items"]] == ["error"]
        assert on.start_indices == [0]

        await on.press_estop(pressed=False)

        await on.becomes("RUNNING", "RUNNING_TASK")
        await on.has_active_goals(1)
        await on.watch.drives(on.told)
        assert on.start_indices == [0, reached], "one goal each"
        driven = next(i for i, (speed, _) in enumerate(on.watch.commands[stopped:]) if speed)
        assert {speed for speed, _ in on.watch.commands[stopped : stopped + driven]} <= {0.0}

        await on.becomes("IDLE", "NO_TASK")
        await on.watch.stands()
        assert on.watch.pose == pytest.approx((24.0, 0.0), abs=0.5)
        assert SUCCEEDED in on.goals
        [done] = (await on.get("/tasks?limit=1"))["items"]
        assert done["status"] == "SUCCEEDED"


async def test_a_planner_that_is_killed_leaves_no_vehicle_driving(
    link: Link, interfaces: Sequence[str], tmp_path: Path
) -> None:
    async with robot(link, interfaces, tmp_path, "pure_pursuit") as on:
        await on.serve(200)
        await on.has_active_goals(1)
        await on.watch.drives(on.told)

        on.planner.kill()

        await on.has_active_goals(0)
        await on.watch.stands()
        assert "no word of the supervisor for 5 s" in on.told()
