"""The messages in examples/ros2/interfaces: they are built, and Pilothouse speaks them."""

import asyncio
import hashlib
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

import pytest

from tests.ros2.support.service import node, ros_robot
from tests.support.shared import PROJECT

# Most of it for the compiler, which is not what is tested.
pytestmark = [pytest.mark.ros2, pytest.mark.timeout(600)]

EXAMPLES = PROJECT / "examples" / "ros2"
BUILD = EXAMPLES / "build_with_wheels.sh"
CLIENT = Path(__file__).with_name("support") / "native_client.py"
# Where the wheels of the tests are, which set this themselves; the build has its own.
OF_THE_WHEELS = "LD_LIBRARY_PATH"


def sources_id() -> str:
    """Return what changes with any file that is built, and with the Python that it is for."""
    found = hashlib.sha256(sys.version.encode())
    for path in sorted([BUILD, *(EXAMPLES / "interfaces").rglob("*")]):
        if path.is_file():
            found.update(f"{path.relative_to(EXAMPLES)}\n".encode() + path.read_bytes())
    return found.hexdigest()[:12]


@pytest.fixture(scope="module")
def interfaces() -> Sequence[str]:
    """Return the variables that name the packages, which are built unless they are there."""
    missing = [tool for tool in ("cmake", "g++") if shutil.which(tool) is None]
    if missing and os.environ.get("CI") != "true":
        pytest.skip(f"the interfaces cannot be built: there is no {' and no '.join(missing)}")
    prefix = PROJECT / "build" / f"ros2-interfaces-{sources_id()}"
    if not (prefix / "setup.sh").exists():
        environment = {k: v for k, v in os.environ.items() if k != OF_THE_WHEELS}
        done = subprocess.run(
            [BUILD, prefix],
            env={**environment, "PYTHON": sys.executable},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
    packages = next(prefix.glob("lib/python3*/site-packages"))
    return [
        f"AMENT_PREFIX_PATH={prefix}",
        f"LD_LIBRARY_PATH={prefix / 'lib'}:{os.environ[OF_THE_WHEELS]}",
        f"PYTHONPATH={packages}",
    ]


async def native_client(variables: Sequence[str]) -> Any:  # noqa: ANN401
    """Return what the client printed at its end."""
    process = await asyncio.create_subprocess_exec(
        *("env", *variables, sys.executable, str(CLIENT)), stdout=subprocess.PIPE
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
