"""Tests with real ROS 2 nodes, for `make test-ros2`; a test imports nothing of ROS at its top."""

import importlib.util
from collections.abc import AsyncIterator

import pytest

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
