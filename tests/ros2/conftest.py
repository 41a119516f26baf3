"""Tests with real ROS 2 nodes, for `make test-ros2`; a test imports nothing of ROS at its top."""

import importlib.util

import pytest

from tests.ros2.support.isolation import isolate


@pytest.fixture(scope="session", autouse=True)
def _isolated() -> None:
    if importlib.util.find_spec("rclpy") is None:
        pytest.skip("there is no rclpy here; see `make test-ros2`")
    isolate()
