"""The example nodes whose values and faults are parameters, as an operator sets them."""

from collections.abc import Sequence

import httpx
import pytest

from tests.ros2.support.links import Link
from tests.ros2.support.service import RosRobot, node, ros_robot
from tests.ros2.support.street import Parameters, example, running, soon
from tests.support.process import COMMAND, service

# Most of it for the interfaces, which are built by the first test that needs them.
pytestmark = [pytest.mark.ros2, pytest.mark.timeout(600)]

MANIPULATOR = ("--ros-args", "-r", "__node:=manipulator", "-p", "max_torque:=0.1")


async def test_each_signal_is_a_parameter_and_can_fall_silent(
    link: Link, interfaces: Sequence[str]
) -> None:
    parameters = Parameters(link)
    with service("--backend", "ros2", command=("env", *interfaces, *COMMAND)) as process:
        async with (
            running(*example("signals"), environment=interfaces),
            httpx.AsyncClient(base_url=process.url, timeout=60) as http,
        ):

            async def has(*errors: str) -> None:
                async def is_so() -> bool:
                    answer = (await http.get("/system_state")).json()
                    return bool(answer["errors"] == [*errors])

                await soon(is_so, f"the errors {errors}")

            await has()
            await parameters.set("signals", "battery_level", 0.1)
            await has("BATTERY_LOW")
            await parameters.set("signals", "battery_level", 0.8)
            await parameters.set("signals", "estop", True)
            await has("ESTOP")
            await parameters.set("signals", "estop", False)
            await parameters.set("signals", "temperature", 60.0)
            await has("TEMPERATURE_HIGH")
            await parameters.set("signals", "temperature", 30.0)
            await parameters.set("signals", "publish.gps_accuracy", False)
            await has("STALE_DATA")


async def test_a_faulty_node_is_slow_refuses_and_dies_as_its_parameters_say(link: Link) -> None:
    parameters = Parameters(link)
    async with running(*example("faulty_node"), *MANIPULATOR):
        with node("drive_base"):
            async with ros_robot() as robot:
                await robot.until_reachable("drive_base", "manipulator")

                await parameters.set("manipulator", "refuse", "configure")
                failed = await _activated(robot)
                assert failed["status"] == "failed"
                assert failed["reason"].startswith("manipulator: configure")

                await parameters.set("manipulator", "refuse", "")
                await parameters.set("manipulator", "slow", 0.5)
                done = await _activated(robot)
                assert done["status"] == "succeeded", done["reason"]

                await parameters.set("manipulator", "die", "activate")
                await robot.begin("/systems/actuation/mode", mode="PERFORMANCE")
                await robot.until_part("/nodes/manipulator", reachable=False)


async def _activated(robot: RosRobot) -> dict[str, str]:
    """Ask for the transition of the system, and return the change at its end."""
    change = await robot.begin("/systems/actuation/state", transition="activate")
    ended: dict[str, str] = await robot.ended(change)
    return ended
