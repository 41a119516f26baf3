"""The launch file for ROS 2, with a stand-in for the package `launch`, which is in no wheel."""

import runpy
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from service.files.model_file import load_model
from service.files.robot_file import read_robot_file
from tests.support.shared import PROJECT

FOLDER = PROJECT / "examples" / "ros2"
FILE = FOLDER / "pilothouse.launch.py"


@dataclass
class Action:
    """Any action: what it was made of."""

    given: tuple[Any, ...]
    named: dict[str, Any] = field(default_factory=dict)


# Keywords that those of the package have, as its source says.
ACTIONS = {
    "DeclareLaunchArgument": {"default_value", "description"},
    "ExecuteProcess": {
        "cmd",
        "name",
        "on_exit",
        "output",
        "respawn",
        "respawn_delay",
        "sigterm_timeout",
    },
    "Shutdown": {"reason"},
}


def maker(allowed: set[str]) -> Any:  # noqa: ANN401
    def make(*given: Any, **named: Any) -> Action:  # noqa: ANN401
        assert set(named) <= allowed
        return Action(given, named)

    return make


@pytest.fixture
def description(monkeypatch: pytest.MonkeyPatch) -> list[Action]:
    """Return what is launched."""
    for name, members in {
        "launch": {"LaunchDescription": list},
        "launch.actions": {name: maker(allowed) for name, allowed in ACTIONS.items()},
        "launch.substitutions": {"LaunchConfiguration": lambda name: f"<{name}>"},
    }.items():
        module = ModuleType(name)
        vars(module).update(members)
        monkeypatch.setitem(sys.modules, name, module)
    found: list[Action] = runpy.run_path(str(FILE))["generate_launch_description"]()
    return found


def processes(description: list[Action]) -> dict[str, dict[str, Any]]:
    return {item.named["name"]: item.named for item in description if "cmd" in item.named}


def test_the_nodes_and_the_service_are_started(description: list[Action]) -> None:
    started = processes(description)

    assert set(started) == {"drive_base", "manipulator", "pilothouse"}
    assert started["pilothouse"]["cmd"] == ["pilothouse", "serve", "<model>", "--robot", "<robot>"]
    assert started["pilothouse"]["on_exit"].named == {"reason": "Pilothouse has ended"}


def test_a_node_that_ends_is_started_again_and_the_service_is_not(
    description: list[Action],
) -> None:
    started = processes(description)

    assert [name for name, own in started.items() if own.get("respawn")] == [
        "drive_base",
        "manipulator",
    ]
    for name in ("drive_base", "manipulator"):
        python, file = started[name]["cmd"]
        assert python == "python3"
        assert Path(file).is_file()


def test_its_usual_files_fit_each_other_and_run_no_node_twice(description: list[Action]) -> None:
    defaults = {
        item.given[0]: Path(item.named["default_value"])
        for item in description
        if "default_value" in item.named
    }
    model = load_model(defaults["model"]).model
    robot = read_robot_file(defaults["robot"].read_text(), model)

    assert robot.backend == "ros2"
    assert set(robot.nodes) == set(model.nodes)
    assert robot.to_process_settings() == {}
