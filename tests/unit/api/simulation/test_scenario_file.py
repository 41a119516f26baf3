import json
from pathlib import Path

import pytest

from api.http.schemas.simulation import ExpectStep, TaskStep
from api.simulation.scenario_file import InvalidScenarioError, Scenario, load_scenario, place_of
from domain.state_and_mode import PartName
from service.files.text_file import UnreadableFileError
from service.files.yaml_tree import read_tree
from tests.support.http_robot import ACTUATION

ARM = "arm: {ros__parameters: {type: node}}"
TRACK = "0,0,0\n1,0,0\n2,0,0\n"


class Folder:
    """A scenario with the files beside it."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def write(self, name: str, text: str) -> Path:
        file = self.path / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(text, encoding="utf-8")
        return file

    def load(self, text: str, model: Path | None = None, robot: Path | None = None) -> Scenario:
        return load_scenario(str(self.write("s.yaml", text)), ACTUATION, model, robot)

    def refused(self, text: str) -> list[str]:
        """Return what is wrong, as `file:line:column: code message`."""
        with pytest.raises(InvalidScenarioError) as refused:
            self.load(text)
        return [
            f"{Path(file).name}:{found.line}:{found.column}: {found.code} {found.message}"
            for file, found in refused.value.findings
        ]


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    return Folder(tmp_path)


def parts_of(scenario: Scenario) -> set[str]:
    return set(scenario.robot.supervisor.model.parts)


# --- what is read --------------------------------------------------------------------------------


def test_yaml_and_json_say_the_same(folder: Folder) -> None:
    body = {
        "title": "A story",
        "until_s": 3,
        "robot": {"signals": {"stale_after_s": 0}},
        "steps": [
            {"t_s": 0, "reading": {"estop": False, "signal_strength": "CONNECTED"}},
            {"t_s": 1, "task": None},
            {"t_s": 2, "expect": {"system_state": {"errors": []}, "task": None}},
        ],
    }
    yaml = """\
title: A story
until_s: 3
robot: {signals: {stale_after_s: 0}}
steps:
  - {t_s: 0, reading: {estop: false, signal_strength: CONNECTED}}
  - t_s: 1
    task: null
  - t_s: 2
    expect:
      system_state: {errors: []}
      task: ~
"""

    assert folder.load(json.dumps(body)).body == folder.load(yaml).body
    assert folder.load(json.dumps(body, indent=2)).body == folder.load(yaml).body


def test_the_robot_is_that_of_the_loaded_model_unless_the_scenario_says_otherwise(
    folder: Folder,
) -> None:
    folder.write("models/arm.yaml", ARM)

    assert parts_of(folder.load("until_s: 1")) == {"actuation", "drive_base", "manipulator"}
    assert parts_of(folder.load(f"until_s: 1\nmodel: '{ARM}'")) == {"arm"}
    assert parts_of(folder.load("until_s: 1\nmodel_file: models/arm.yaml")) == {"arm"}


def test_a_model_that_is_given_is_taken_instead(folder: Folder) -> None:
    given = folder.write("given.yaml", ARM)

    assert parts_of(folder.load("until_s: 1\nmodel_file: nothere.yaml", model=given)) == {"arm"}


def test_settings_come_from_the_robot_file(folder: Folder) -> None:
    folder.write("robot.yaml", "vehicle: {pose: {x_m: 3}}")
    given = folder.write("given.yaml", "vehicle: {pose: {x_m: 4}}")
    text = "until_s: 1\nrobot_file: robot.yaml"

    assert folder.load(text).body.robot == {"vehicle": {"pose": {"x_m": 3}}}
    assert folder.load(text, robot=given).body.robot == {"vehicle": {"pose": {"x_m": 4}}}


def test_an_empty_robot_file_sets_nothing(folder: Folder) -> None:
    folder.write("robot.yaml", "# nothing yet\n")

    assert not folder.load("until_s: 1\nrobot_file: robot.yaml").body.robot


def test_waypoints_come_from_the_file_that_a_task_names(folder: Folder) -> None:
    folder.write("track.csv", TRACK)
    scenario = folder.load(
        "until_s: 1\nsteps: [{t_s: 0, task: {file: track.csv, controller: stanley, speed_mps: 2}}]"
    )

    (step,) = scenario.body.steps
    assert isinstance(step, TaskStep)
    assert step.task is not None
    assert [point.x_m for point in step.task.waypoints] == [0, 1, 2]
    assert (step.task.controller, step.task.speed_mps) == ("stanley", 2)


def test_headings_may_be_degrees(folder: Folder) -> None:
    folder.write("track.csv", "0,0,90\n0,1,90\n")
    scenario = folder.load("until_s: 1\nsteps: [{t_s: 0, task: {file: track.csv, heading: deg}}]")

    (step,) = scenario.body.steps
    assert isinstance(step, TaskStep)
    assert step.task is not None
    assert step.task.waypoints[0].yaw_rad == pytest.approx(1.5708, abs=1e-4)


def test_columns_may_be_named(folder: Folder) -> None:
    folder.write("track.csv", "0;0;0\n1;0;1\n2;0;2\n")
    task = "{file: track.csv, columns: 's,x,y'}"
    scenario = folder.load(f"until_s: 1\nsteps: [{{t_s: 0, task: {task}}}]")

    (step,) = scenario.body.steps
    assert isinstance(step, TaskStep)
    assert step.task is not None
    assert [(point.x_m, point.y_m) for point in step.task.waypoints] == [(0, 0), (0, 1), (0, 2)]


def test_scalars_mean_what_they_mean_in_a_model(folder: Folder) -> None:
    scenario = folder.load(
        "until_s: 1\nsteps: [{t_s: 0, expect: {a: on, b: 'on', c: '1', d: null, e: 'null', f: }}]"
    )

    (step,) = scenario.body.steps
    assert isinstance(step, ExpectStep)
    assert step.expect == {"a": True, "b": "on", "c": "1", "d": None, "e": "null", "f": None}


def test_the_robot_is_ready_to_go(folder: Folder) -> None:
    robot = folder.load("until_s: 1").robot
    robot.advance_to(10**9)

    actual = robot.supervisor.core.part(PartName("drive_base")).actual
    assert actual.state_and_mode.label == "unconfigured"


# --- what is wrong -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "s.yaml:1:1: INVALID_VALUE until_s: missing key"),
        ("- 1", "s.yaml:1:1: INVALID_VALUE a scenario must have keys, at least until_s"),
        (
            "until_s: 1\nuntil_s: 2",
            "s.yaml:2:1: DUPLICATE_KEY duplicate key 'until_s'; first in line 1",
        ),
        ("until_s: soon", "s.yaml:1:1: INVALID_VALUE until_s: Input should be a valid number"),
        ("until_s: 1\nwings: 2", "s.yaml:2:1: INVALID_VALUE wings: unknown key"),
        ("until_s: 1\nfrom: live", "s.yaml:2:1: INVALID_VALUE a scenario file has no live robot"),
        (
            "until_s: 1\n--- \na: 1",
            "s.yaml:3:1: INVALID_VALUE a scenario file holds one document only",
        ),
        ("until_s: 1\nrobot:\n  wings: 2", "s.yaml:3:3: INVALID_VALUE robot.wings: "),
        ("until_s: 1\nrobot_file: no.yaml", "s.yaml:2:1: UNREADABLE_FILE "),
        ("until_s: 1\nmodel_file: no.yaml", "s.yaml:2:1: UNREADABLE_FILE "),
        ("until_s: 1\nmodel_file: 3", "s.yaml:2:1: INVALID_VALUE model_file: the path of a file"),
        (
            f"until_s: 1\nmodel: '{ARM}'\nmodel_file: a",
            "s.yaml:3:1: INVALID_VALUE model is given as well",
        ),
    ],
)
def test_what_is_wrong_is_told_with_its_place(text: str, told: str, folder: Folder) -> None:
    (finding,) = folder.refused(text)

    assert finding.startswith(told)


@pytest.mark.parametrize(
    ("step", "told"),
    [
        (
            "{t_s: 0, vehicle: silent, why: x}",
            "s.yaml:3:31: INVALID_VALUE steps.0.why: unknown key",
        ),
        ("{t_s: 0, vehicle: off}", "s.yaml:3:14: INVALID_VALUE steps.0.vehicle: "),
        (
            "{t_s: 2, vehicle: silent}",
            "s.yaml:3:6: INVALID_VALUE this is after the end of the scenario, until_s: 1",
        ),
        ("{t_s: 0, reading: {estop: }}", "s.yaml:3:24: INVALID_VALUE steps.0.reading.estop: "),
        ("{t_s: 0, node: arm}", "s.yaml:3:5: INVALID_VALUE steps.0: a node step must have"),
        ("{t_s: 0, task: {file: 3}}", "s.yaml:3:21: INVALID_VALUE file: the path of a CSV"),
        ("{t_s: 0, task: {file: no.csv}}", "s.yaml:3:21: UNREADABLE_FILE "),
        (
            "{t_s: 0, task: {file: a.csv, waypoints: []}}",
            "s.yaml:3:21: INVALID_VALUE waypoints are given as well",
        ),
        ("{t_s: 0, task: {file: a.csv, heading: up}}", "s.yaml:3:34: INVALID_VALUE heading: one"),
        ("{t_s: 0, task: {file: a.csv, columns: 3}}", "s.yaml:3:34: INVALID_VALUE columns: names"),
        ("{t_s: 0, task: {file: a.csv, columns: s}}", "s.yaml:3:34: INVALID_VALUE columns: no col"),
        (
            "{t_s: 0, expect: 'battery >= '}",
            "s.yaml:3:14: INVALID_VALUE steps.0.expect: column 11: expected a name or a value",
        ),
        (
            "{t_s: 0, expect: 'estop or batery_level >= 0.3'}",
            "s.yaml:3:14: INVALID_VALUE steps.0.expect: column 10: unknown signal 'batery_level'",
        ),
        ("{t_s: 0, task: {heading: deg}}", "s.yaml:3:21: INVALID_VALUE steps.0.task.heading"),
    ],
)
def test_what_is_wrong_in_a_step_is_told_with_its_place(
    step: str, told: str, folder: Folder
) -> None:
    assert folder.refused(f"until_s: 1\nsteps:\n  - {step}\n")[-1].startswith(told)


def test_all_faults_are_told_at_once(folder: Folder) -> None:
    text = "until_s: 1\nsteps:\n- {t_s: x, vehicle: silent}\n- {t_s: 0, vehicle: loud}\n"

    assert [finding.split(": ")[0] for finding in folder.refused(text)] == [
        "s.yaml:3:4",
        "s.yaml:4:12",
    ]


def test_waypoints_that_are_none_are_told_with_line_and_hint(folder: Folder) -> None:
    folder.write("bad.csv", "0,0,0\n1,0,x\n")
    folder.write("noise.csv", "0,0,2\n0,1,2\n0,2,2\n1,3,2\n2,3,2\n3,3,2\n4,2,2\n4,1,2\n")
    text = "until_s: 1\nsteps: [{{t_s: 0, task: {{file: {}}}}}]"

    assert (
        "bad.csv: the waypoints are invalid: line 2: " in folder.refused(text.format("bad.csv"))[0]
    )
    told = folder.refused(text.format("noise.csv"))[0]
    assert "columns: x,y" in told
    assert "heading: rad, deg or compass" in told


def test_faults_of_a_robot_file_are_placed_in_that_file(folder: Folder) -> None:
    folder.write("robot.yaml", "signals:\n  stale_after_s: 0\nvehicle:\n  wings: 2\n")

    (finding,) = folder.refused("until_s: 1\nrobot_file: robot.yaml")

    assert finding == "robot.yaml:4:3: INVALID_VALUE robot.vehicle.wings: unknown key"


@pytest.mark.parametrize(
    ("robot", "told"),
    [
        ("start_task: {file: a.csv}", "robot.yaml:1:1: INVALID_VALUE start_task has no effect in"),
        ("vehicle: [", "robot.yaml:1:11: YAML_SYNTAX "),
        ("- 1", "robot.yaml:1:1: INVALID_VALUE robot: "),
        ("5", "robot.yaml:1:1: INVALID_VALUE robot: "),
    ],
)
def test_a_robot_file_that_cannot_be_is_told(robot: str, told: str, folder: Folder) -> None:
    folder.write("robot.yaml", robot)

    (finding,) = folder.refused("until_s: 1\nrobot_file: robot.yaml")

    assert finding.startswith(told)


def test_faults_of_a_model_file_are_placed_in_that_file(folder: Folder) -> None:
    folder.write("arm.yaml", "arm:\n  ros__parameters:\n    typ: node\n")

    (finding, *_) = folder.refused("until_s: 1\nmodel_file: arm.yaml")

    assert finding.startswith("arm.yaml:")


def test_faults_of_a_model_within_the_scenario_are_placed_there(folder: Folder) -> None:
    text = "until_s: 1\nmodel: |\n  arm:\n    ros__parameters:\n      typ: node\n"

    (finding, *_) = folder.refused(text)

    assert finding.startswith("s.yaml:2:1: ")
    assert "of the model: " in finding


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(UnreadableFileError, match=r"no\.yaml cannot be read"):
        load_scenario(str(tmp_path / "no.yaml"), ACTUATION)


def test_a_given_file_that_is_not_there_is_told(folder: Folder) -> None:
    with pytest.raises(UnreadableFileError, match=r"no\.yaml cannot be read"):
        folder.load("until_s: 1", robot=folder.path / "no.yaml")


# --- places --------------------------------------------------------------------------------------


def test_a_step_and_what_it_expects_are_found_in_the_file(folder: Folder) -> None:
    scenario = folder.load(
        "until_s: 1\nsteps:\n- {t_s: 0, task: null}\n- t_s: 0\n  expect:\n    task:\n      id: t1\n"
    )

    assert [scenario.line_of(0), scenario.line_of(1)] == [3, 4]
    assert scenario.line_of(1, "task.id") == 7
    assert scenario.line_of(1, "task.status") == 6


def test_a_way_that_leads_nowhere_ends_at_the_last_thing_on_it() -> None:
    root = read_tree("a:\n  b: [1,\n    2]\n").documents[0]
    assert root is not None

    lines = [place_of(root, keys).line for keys in [(), ("c",), ("a", "b", 1), ("a", "b", 7, "x")]]

    assert lines == [1, 1, 3, 2]
