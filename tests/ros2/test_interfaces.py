"""The messages in examples/ros2/interfaces: they are built, and Pilothouse speaks them."""

import asyncio
import json
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

import pytest

from tests.ros2.support.service import node, ros_robot

# Most of it for the compiler, which is not what is tested.
pytestmark = [pytest.mark.ros2, pytest.mark.timeout(600)]

CLIENT = Path(__file__).with_name("support") / "native_client.py"


async def native_client(variables: Sequence[str]) -> Any:  # noqa: ANN401
    """Return what the client printed at its end."""
    process = await asyncio.create_subprocess_exec(
        *("env", *variables, sys.executable, str(CLIENT)), stdout=asyncio.subprocess.PIPE
    )
    printed, _ = await process.communicate()
    assert process.returncode == 0
    return json.loads(printed)


async def test_pilothouse_speaks_the_types_that_were_built(interfaces: Sequence[str]) -> None:
    with node("drive_base"), node("manipulator"):
        async with ros_robot(environment=interfaces) as robot:
            await robot.until_reachable("drive_base", "manipulator")

            told = await native_client(interfaces)

            assert (await robot.actual())["actuation"] == ("active", "PERFORMANCE")
    assert told["success"]
    assert told["mode"] == "PERFORMANCE"
    assert told["modes"] == ["__DEFAULT__", "MODERATE", "PERFORMANCE"]
    assert told["heard"][-1] == ["", "PERFORMANCE"]
    idle = {tuple(state[1:]) for state in told["states_before"]}
    assert idle == {(0, 0)}
    assert told["state_at_last"] == [2, 2]
    stamps = [state[0] for state in told["states_before"]]
    # Each tick, of which there are 20 a second; a slow machine skips some.
    assert median(after - before for before, after in pairwise(stamps)) < 0.1
