"""Tests with real ROS 2 nodes, for `make test-ros2`; a test imports nothing of ROS at its top."""

import importlib.util
from collections.abc import AsyncIterator, Sequence

import pytest

from tests.ros2.support.interfaces import built_interfaces
from tests.ros2.support.isolation import isolate
from tests.ros2.support.links import Link, a_link


@pytest.fixture(scope="session", autouse=True)
def _isolated() -> None:
    if importlib.util.find_spec("rclpy") is None:
        pytest.skip("there is no rclpy here; see `make test-ros2`")
    isolate()


@pytest.fixture
async def link() -> AsyncIterator[Link]:
    async with a_link() as made:
        yield made


@pytest.fixture(scope="session")
def interfaces() -> Sequence[str]:
    """Return the variables that name the packages of examples/ros2/interfaces.

    The first test that needs them may wait some minutes for their compiler, and needs a timeout
    that allows it.
    """
    return built_interfaces()
