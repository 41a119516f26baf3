"""The mobile manipulator among the examples: what its README and its stories rest on."""

from pathlib import Path

import httpx
import pytest
import yaml

from api.cli.command_line import main
from api.robot_app import create_robot_app
from api.simulation.scenario_file import load_scenario
from domain.timebase import seconds
from service.files.model_file import load_model
from service.worker import InlineJobs
from tests.support.shared import PROJECT

FOLDER = PROJECT / "examples" / "mobile_manipulator"
STORIES = sorted((FOLDER / "scenarios").glob("*.yaml"))
MODE = "/systems/porter/mode"
READINGS = {
    "battery_level": 0.9,
    "estop": False,
    "temperature": 35,
    "drive_temperature": 40,
    "payload": 5,
    "gripper_pressure": 6,
}
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

    assert len(STORIES) >= 9
    assert [path.stem for path in STORIES if f"(scenarios/{path.name})" not in readme] == []


@pytest.mark.parametrize("path", STORIES, ids=lambda path: path.stem)
def test_a_story_is_of_this_robot(path: Path) -> None:
    story = yaml.safe_load(path.read_text(encoding="utf-8"))

    assert (story["model_file"], story["robot_file"]) == ("../model.yaml", "../robot.yaml")


@pytest.mark.parametrize("mode", ["TRANSPORT", "PICK", "LIMP"])
async def test_the_nodes_begin_stage_by_stage_as_the_dry_run_said(mode: str) -> None:
    robot = load_scenario(str(FOLDER / "scenarios" / "start_up_in_order.yaml"), "").robot
    robot.advance_to(seconds(0.5))
    transport = httpx.ASGITransport(create_robot_app(robot.supervisor, InlineJobs()))
    async with httpx.AsyncClient(transport=transport, base_url="http://simulation") as http:
        await http.post("/signals", json=READINGS)
        asked = (await http.post(f"{MODE}?dry_run=true", json={"mode": mode})).json()
        change = (await http.post(MODE, json={"mode": mode})).json()
        for at_s in range(1, 12):  # A guard holds only while its reading is fresh.
            robot.advance_to(seconds(at_s))
            await http.post("/signals", json=READINGS)
        ended = (await http.get(f"/changes/{change['id']}")).json()

    planned = {(step["node"], step["action"]): step["stage"] for step in asked["steps"]}
    by_begin = sorted(ended["steps"], key=lambda step: step["started_at"])
    stages = [planned[step["node"], step["action"]] for step in by_begin]
    assert ended["status"] == "succeeded"
    assert len(stages) == len(planned)
    assert stages == sorted(stages)
    assert set(stages) == set(range(asked["stages"]))
