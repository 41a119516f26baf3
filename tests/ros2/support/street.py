"""A vehicle in ROS 2 that `pilothouse tracker` drives: each in a process of its own."""

import asyncio
import json
import math
import os
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from service.ros.graph.graph import Lane, Message, Qos
from tests.ros2.support.links import Link, ready
from tests.ros2.support.service import NODES
from tests.support.process import COMMAND

ACTION = "/navigate_waypoints"
CLIENT = Path(__file__).with_name("goal_client.py")
SOON_S = 60.0
"""A machine that does much else starts a process in some ten seconds."""
_POLL_S = 0.02

_BOOL, _DOUBLE, _STRING, _INTEGER = 1, 3, 4, 2


async def soon(
    condition: Callable[[], bool] | Callable[[], Awaitable[bool]],
    what: str,
    told: Callable[[], str] = str,
) -> None:
    """Wait until something is so.

    Args:
        condition: Whether it is so.
        what: What is waited for.
        told: Returns what may explain why it does not come.

    Raises:
        AssertionError: It is not so in time.
    """
    try:
        async with asyncio.timeout(SOON_S):
            while True:
                found = condition()
                if found if isinstance(found, bool) else await found:
                    return
                await asyncio.sleep(_POLL_S)
    except TimeoutError as error:
        raise AssertionError(f"it took too long: {what}\n{told()}") from error


class Running:
    """A process whose output is read line by line."""

    def __init__(self, process: Process) -> None:
        self._process = process
        self.lines: list[str] = []
        """What it printed, on both outputs."""
        self._reading = asyncio.create_task(self._read(), name="output of a process")

    @property
    def text(self) -> str:
        """Return what it printed."""
        return "".join(self.lines)

    def signal(self, number: int) -> None:
        """Send it a signal."""
        self._process.send_signal(number)

    def say(self, line: str) -> None:
        """Write a line to its standard input."""
        assert self._process.stdin is not None
        self._process.stdin.write(f"{line}\n".encode())

    async def code(self) -> int:
        """Wait for its end, and return its exit code."""
        async with asyncio.timeout(SOON_S):
            return await self._process.wait()

    async def close(self) -> None:
        """End it now."""
        if self._process.returncode is None:
            self._process.kill()
        await self._process.wait()
        # To its end, also by the process that it started to publish commands.
        async with asyncio.timeout(SOON_S):
            await self._reading

    async def _read(self) -> None:
        assert self._process.stdout is not None
        while line := await self._process.stdout.readline():
            self.lines.append(line.decode())


@asynccontextmanager
async def running(*command: str, environment: Sequence[str] = ()) -> AsyncIterator[Running]:
    """Run a program as long as the context lasts.

    Args:
        command: The program and its arguments.
        environment: More variables, as `NAME=value`.
    """
    variables = dict(entry.split("=", 1) for entry in environment)
    process = await asyncio.create_subprocess_exec(
        *command,
        stdin=PIPE,
        stdout=PIPE,
        stderr=asyncio.subprocess.STDOUT,
        env={**os.environ, **variables},
    )
    made = Running(process)
    try:
        yield made
    finally:
        await made.close()


class GoalClient:
    """A client of the action."""

    def __init__(self, process: Running) -> None:
        self._process = process

    @property
    def told(self) -> list[dict[str, Any]]:
        """Return all that the client told so far."""
        return [json.loads(line) for line in self._process.lines if line.startswith("{")]

    def of(self, goal: str, key: str) -> list[Any]:
        """Return what was told of a goal under a key, in order."""
        return [told[key] for told in self.told if told.get("goal") == goal and key in told]

    def send(
        self, goal: str, length_m: float, start_index: int = 0, speed_mps: float = 2.0
    ) -> None:
        """Send a goal along the x axis, with a waypoint each meter."""
        waypoints = [[float(x), 0.0, 0.0] for x in range(round(length_m) + 1)]
        order = {
            "send": goal,
            "waypoints": waypoints,
            "start_index": start_index,
            "speed_mps": speed_mps,
        }
        self._process.say(json.dumps(order))

    def cancel(self, goal: str) -> None:
        """Cancel a goal."""
        self._process.say(json.dumps({"cancel": goal}))

    async def accepted(self, goal: str) -> bool:
        """Wait for the answer to a goal, and return it."""
        await soon(lambda: bool(self.of(goal, "accepted")), f"the answer to {goal}")
        return bool(self.of(goal, "accepted")[0])

    async def passed(self, goal: str, index: int) -> None:
        """Wait until a goal has passed a waypoint."""
        await soon(
            lambda: any(at > index for at, _ in self.of(goal, "feedback")),
            f"that {goal} passes waypoint {index}",
            lambda: str(self.told[-5:]),
        )

    async def ended(self, goal: str) -> tuple[str, str]:
        """Wait for the end of a goal; return its status and its message."""
        await soon(lambda: bool(self.of(goal, "status")), f"the end of {goal}")
        return self.of(goal, "status")[0], self.of(goal, "message")[0]


class Parameters:
    """Sets the parameters of nodes.

    Args:
        link: Joins the graph.
    """

    def __init__(self, link: Link) -> None:
        self._clients = link.node("setter", Lane.PARAMETERS)

    async def set(self, node: str, parameter: str, value: bool | int | float | str) -> None:
        """Set a parameter of a node, as `ros2 param set` does."""
        service = f"/{node}/set_parameters"
        client = self._clients.client(service, "rcl_interfaces/srv/SetParameters")
        await ready(client)
        asked = {"name": parameter, "value": _value(value)}
        response = await client.call({"parameters": [asked]}, SOON_S)
        assert response.results[0].successful, response.results[0].reason


class Watch:
    """Hears the vehicle and what it is commanded.

    Args:
        link: Joins the graph.
    """

    def __init__(self, link: Link) -> None:
        self.commands: list[tuple[float, float]] = []
        """Speed and yaw rate of each command, in m/s and rad/s."""
        self.pose = (math.nan, math.nan)
        """Where the vehicle is, in m."""
        self.speed_mps = math.nan
        self._node = link.node("watch", Lane.SENSORS)
        self.parameters = Parameters(link)
        self._node.subscribe(
            "/cmd_vel", "geometry_msgs/msg/Twist", Qos.EVENTS, _pick_command, self.commands.append
        )
        self._node.subscribe("/odom", "nav_msgs/msg/Odometry", Qos.SENSOR, _pick_motion, self._take)

    def _take(self, motion: tuple[float, float, float]) -> None:
        self.pose, self.speed_mps = motion[:2], motion[2]

    async def there(self) -> None:
        """Wait until the vehicle is heard."""
        await soon(lambda: not math.isnan(self.speed_mps), "odometry")

    async def drives(self, told: Callable[[], str] = str) -> None:
        """Wait until the vehicle drives, and its commands are heard.

        Args:
            told: Returns what may explain why it does not.
        """
        await soon(
            lambda: self.speed_mps > 1.0 and bool(self.commands), "that the vehicle drives", told
        )

    async def stands(self) -> None:
        """Wait until the vehicle stands."""
        await soon(lambda: abs(self.speed_mps) < 0.01, "that the vehicle stands")


def _pick_command(message: Message) -> tuple[float, float]:
    return message.linear.x, message.angular.z


def _pick_motion(message: Message) -> tuple[float, float, float]:
    place = message.pose.pose.position
    return place.x, place.y, message.twist.twist.linear.x


def _value(value: bool | int | float | str) -> dict[str, Any]:
    match value:
        case bool():
            return {"type": _BOOL, "bool_value": value}
        case int():
            return {"type": _INTEGER, "integer_value": value}
        case float():
            return {"type": _DOUBLE, "double_value": value}
    return {"type": _STRING, "string_value": value}


class Street:
    """The vehicle, the tracker and a client."""

    def __init__(self, watch: Watch, tracker: Running, client: GoalClient) -> None:
        self.watch = watch
        self.tracker = tracker
        self.client = client

    def told(self) -> str:
        """Return what the tracker and the client said."""
        return f"{self.tracker.text}\n{self.client.told[-5:]}"


def example(name: str) -> tuple[str, str]:
    """Return the command that runs an example node."""
    return sys.executable, str(NODES / f"{name}.py")


@asynccontextmanager
async def street(
    link: Link, interfaces: Sequence[str], tracker: str = "pure_pursuit"
) -> AsyncIterator[Street]:
    """Run a vehicle, a tracker and a client, which has found the action."""
    async with AsyncExitStack() as stack:
        enter = stack.enter_async_context
        robot = Path(stack.enter_context(TemporaryDirectory())) / "robot.yaml"
        # A busy machine delays messages.
        robot.write_text("driving: {pose_stale_after_s: 2.0}\n")
        await enter(running(*example("vehicle")))
        options = ("--tracker", tracker, "--robot", str(robot))
        drives = await enter(running(*COMMAND, "tracker", *options, environment=interfaces))
        client = await enter(running(sys.executable, str(CLIENT), ACTION, environment=interfaces))
        watch = Watch(link)
        await watch.there()
        await soon(lambda: '"ready"' in client.text, "the action", lambda: drives.text)
        yield Street(watch, drives, GoalClient(client))
