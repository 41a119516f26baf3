"""The mobile manipulator among the examples: what its README and its stories rest on."""

from pathlib import Path

import pytest
import yaml

from api.cli.command_line import main
from api.simulation.scenario_file import load_scenario
from api.simulation.simulation import Simulation
from service.files.model_file import load_model
from tests.support.shared import PROJECT

FOLDER = PROJECT / "examples" / "mobile_manipulator"
STORIES = sorted((FOLDER / "scenarios").glob("*.yaml"))
Output = pytest.CaptureFixture[str]


def test_its_model_and_its_robot_file_are_checked_without_a_finding(capsys: Output) -> None:
    model, robot = str(FOLDER / "model.yaml"), str(FOLDER / "robot.yaml")

    assert main(["check", model, "--robot", robot]) == 0

    assert capsys.readouterr().out.splitlines() == [f"{model}: valid", f"{robot}: valid"]


def test_it_has_eight_nodes_in_four_systems() -> None:
    model = load_model(FOLDER / "model.yaml").model

    assert list(model.systems) == ["porter", "mobility", "manipulation", "gripping"]
    assert len(model.nodes) == 8


def test_the_readme_names_every_story_by_what_happens() -> None:
    readme = (FOLDER / "README.md").read_text(encoding="utf-8")

    assert len(STORIES) >= 8
    assert [path.stem for path in STORIES if f"(scenarios/{path.name})" not in readme] == []


@pytest.mark.parametrize("path", STORIES, ids=lambda path: path.stem)
def test_a_story_is_of_this_robot(path: Path) -> None:
    story = yaml.safe_load(path.read_text(encoding="utf-8"))

    assert (story["model_file"], story["robot_file"]) == ("../model.yaml", "../robot.yaml")
