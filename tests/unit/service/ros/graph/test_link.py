"""What runs without ROS 2: everything but the link to it, whose own tests are in `tests/ros2`."""

import json
import subprocess
import sys

import pytest

from tests.support.shared import PROJECT

# A process of its own, since this one has imported most modules already.
WITHOUT_ROS = """
import importlib, json, pkgutil, sys

class NoRos:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("rclpy", "rosidl_generator_py"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, NoRos())
failed = {}
for package in ("api", "domain", "service"):
    for module in pkgutil.walk_packages([package], f"{package}."):
        if not module.name.endswith("__main__"):
            try:
                importlib.import_module(module.name)
            except ImportError as error:
                failed[module.name] = [type(error).__name__, error.name]
print(json.dumps(failed))
"""


@pytest.fixture(scope="module")
def failed() -> dict[str, list[str]]:
    """Return what could not be imported without ROS 2, and why."""
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_ROS],
        cwd=PROJECT,
        capture_output=True,
        text=True,
        timeout=30,
        check=True,
    )
    found: dict[str, list[str]] = json.loads(done.stdout)
    return found


def test_only_the_link_needs_ros(failed: dict[str, list[str]]) -> None:
    assert set(failed) == {"service.ros.graph.link"}


def test_without_ros_the_link_says_what_is_missing(failed: dict[str, list[str]]) -> None:
    assert failed["service.ros.graph.link"] == ["ModuleNotFoundError", "rclpy"]
