"""How old the states of robot and task are for a subscriber in ROS 2, beside each other.

For `make bench-ros2`; needs ROS 2, cmake and a C++ compiler for the messages.
"""

import asyncio
import json
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from itertools import pairwise
from typing import TypeAlias

import pytest

from tests.ros2.support.interfaces import built_interfaces
from tests.ros2.support.isolation import isolate
from tests.ros2.support.service import ros_robot
from tests.support.bench import PROJECT, quantiles, report

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(find_spec("rclpy") is None, reason="needs ROS 2: make bench-ros2"),
]

CLIENT = PROJECT / "tests" / "ros2" / "support" / "task_client.py"
SECONDS = 30.0
PERIOD_S = 0.05

Heard: TypeAlias = Sequence[tuple[int, int, int]]
"""When each message was stamped and when it came, ns since 1970, and its value."""


async def heard_by_a_client() -> tuple[Heard, Heard]:
    """Return what a client in a process of its own hears of robot and task."""
    variables = built_interfaces()
    async with ros_robot(environment=variables):
        process = await asyncio.create_subprocess_exec(
            *("env", *variables, sys.executable, str(CLIENT), str(SECONDS)),
            stdout=asyncio.subprocess.PIPE,
        )
        printed, _ = await process.communicate()
        assert process.returncode == 0
    heard = json.loads(printed)["heard"]
    return heard["state"], heard["task"]


def ages_s(heard: Heard) -> dict[int, float]:
    """Return how old each message was when it came, s, by its stamp."""
    return {stamp: (came - stamp) / 1e9 for stamp, came, _ in heard}


def period_errors_s(heard: Heard) -> list[float]:
    """Return by how much each time between two messages differs from the period, s."""
    return [abs((b[1] - a[1]) / 1e9 - PERIOD_S) for a, b in pairwise(heard)]


async def test_the_states_of_robot_and_task_are_of_one_age() -> None:
    isolate()
    states, tasks = await heard_by_a_client()
    of_robot, of_task = ages_s(states), ages_s(tasks)
    both = [stamp for stamp in of_robot if stamp in of_task]
    assert both
    apart = [abs(of_robot[stamp] - of_task[stamp]) for stamp in both]
    report(
        "ros2_states",
        "States of robot and task in ROS 2",
        "A client in another process subscribes to `/system_state` and `/task_planner_status` in "
        f"the types of `pilothouse_msgs` for {SECONDS:g} s. Age: from the stamp of a message to "
        "when the middleware of the client has it. Apart: difference of the ages of two messages "
        "with one stamp. Period: deviation of the times between messages from 50 ms.",
        {
            "age of the robot's state": quantiles([*of_robot.values()]),
            "age of the task's status": quantiles([*of_task.values()]),
            "apart": {**quantiles(apart), "pairs": len(both)},
            "period of the robot's state": quantiles(period_errors_s(states)),
            "period of the task's status": quantiles(period_errors_s(tasks)),
        },
        asked="20 Hz; within 1 ms of each other's age (p99).",
        command="make bench-ros2",
    )
