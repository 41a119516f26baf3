"""The mobile robot among the examples: what its README and its stories rest on."""

from pathlib import Path

import pytest
import yaml

from api.cli.command_line import main
from service.files.model_file import load_model
from tests.support.shared import PROJECT

FOLDER = PROJECT / "examples" / "mobile_robot"
STORIES = sorted((FOLDER / "scenarios").glob("*.yaml"))
Output = pytest.CaptureFixture[str]


def test_its_model_and_its_robot_file_are_checked_without_a_finding(capsys: Output) -> None:
    model, robot = str(FOLDER / "model.yaml"), str(FOLDER / "robot.yaml")

    assert main(["check", model, "--robot", robot]) == 0

    assert capsys.readouterr().out.splitlines() == [f"{model}: valid", f"{robot}: valid"]


def test_it_has_a_lidar_a_camera_a_mapper_a_planner_and_two_drives() -> None:
    model = load_model(FOLDER / "model.yaml").model

    assert list(model.systems) == ["rover", "base"]
    assert list(model.nodes) == [
        "lidar",
        "camera",
        "mapper",
        "planner",
        "left_drive",
        "right_drive",
    ]


def test_the_readme_names_every_error_and_every_story() -> None:
    readme = (FOLDER / "README.md").read_text(encoding="utf-8")
    declared = load_model(FOLDER / "model.yaml").model.errors

    errors = [f"`{part}.{error}`" for part, own in declared.items() for error in own]
    of_signals = {"`lidar.SCAN_STALE`"}
    assert [name for name in errors if name not in readme and name not in of_signals] == []
    assert len(STORIES) >= 6
    assert [path.stem for path in STORIES if f"(scenarios/{path.name})" not in readme] == []


@pytest.mark.parametrize("path", STORIES, ids=lambda path: path.stem)
def test_a_story_is_of_this_robot(path: Path) -> None:
    story = yaml.safe_load(path.read_text(encoding="utf-8"))

    assert (story["model_file"], story["robot_file"]) == ("../model.yaml", "../robot.yaml")
