import json
from pathlib import Path

import pytest

from api.cli.command_line import main
from api.cli.commands.analyse import analyse
from tests.support.http_robot import ACTUATION

LOAD = "signals: {load: {error: OVERLOAD, above: 10}}\n"


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "model.yaml"
    path.write_text(ACTUATION)
    return path


def test_the_errors_that_stop_the_task_are_reported(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["analyse", str(model)]) == 0

    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"Fault trees of {model}"
    assert "  ESTOP (critical)" in lines


def test_errors_of_signals_of_the_robot_file_are_there_too(
    model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = tmp_path / "robot.yaml"
    robot.write_text(LOAD)

    assert main(["analyse", str(model), "--robot", str(robot), "--format", "json"]) == 0

    *_, last = json.loads(capsys.readouterr().out)["errors"]
    assert last == {
        "part": None,
        "error": "OVERLOAD",
        "severity": "critical",
        "cut_sets": [[{"part": None, "error": "OVERLOAD"}]],
        "incomplete": None,
    }


def test_an_invalid_model_is_told_as_check_does(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model.write_text(ACTUATION.replace("\ndrive_base:", "\nwheels:"))

    assert analyse(str(model), "text") == 1

    told = capsys.readouterr()
    assert told.out == ""
    assert f"{model}: invalid" in told.err


def test_a_file_that_is_not_there_is_told_in_one_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert analyse("/nowhere/model.yaml", "text") == 2
    assert capsys.readouterr().err.count("\n") == 1


CARRIER = """\
carrier:
  ros__parameters:
    type: system
    modes: {__DEFAULT__: {lidar: active, camera: active, mapper: active}}
    errors:
      BLIND: {caused_by: [mapper.LATE, camera.SILENT], need: all, severity: critical}
lidar: {ros__parameters: {type: node, errors: {SILENT: {when: "not lidar.reachable"}}}}
camera: {ros__parameters: {type: node, errors: {SILENT: {}}}}
mapper: {ros__parameters: {type: node, errors: {LATE: {caused_by: [lidar.SILENT]}}}}
"""


def test_the_errors_that_lead_to_another_one_are_reported(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model.write_text(CARRIER)

    assert analyse(str(model), "text") == 0

    assert capsys.readouterr().out.splitlines()[3:6] == [
        "carrier.BLIND (critical): 1 minimal cut set",
        "  2 errors together:",
        "    lidar.SILENT + camera.SILENT",
    ]


def test_too_many_cut_sets_are_a_failure_that_is_told(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    causes = {c: ", ".join(f"lidar.E{c}_{n}" for n in range(10)) for c in range(10)}
    errors = "\n".join(
        [
            *(f"      C{channel}: {{caused_by: [{below}]}}" for channel, below in causes.items()),
            *(f"      E{c}_{n}: {{}}" for c in range(10) for n in range(10)),
        ]
    )
    channels = ", ".join(f"lidar.C{channel}" for channel in range(10))
    model.write_text(
        f"lidar:\n  ros__parameters:\n    type: node\n    errors:\n{errors}\n"
        f"      DOWN: {{caused_by: [{channels}], need: all, severity: fatal}}\n"
    )

    assert analyse(str(model), "text") == 1
    assert "  TOO_MANY_CUT_SETS: " in capsys.readouterr().out
