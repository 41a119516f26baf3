import json
from pathlib import Path

import pytest

from api.http.model_check import check, finding_line
from domain.findings import Finding

GOOD = """\
arm:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__:
        ros__parameters: {max_torque: 0.1}
      STRONG:
        ros__parameters: {max_torque: 0.2}
"""
BAD = """\
robot:
  ros__parameters:
    type: system
    modes:
      __DEFAULT__:
        arm: active
"""


@pytest.fixture
def model(tmp_path: Path) -> Path:
    return tmp_path / "robot.yaml"


def test_a_valid_model_is_said_to_be_valid(model: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model.write_text(GOOD)

    assert check(str(model), "text") == 0
    assert capsys.readouterr().out == f"{model}: valid\n"


def test_an_error_is_told_with_file_line_and_column(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model.write_text(BAD)

    assert check(str(model), "text") == 1
    first, verdict = capsys.readouterr().out.splitlines()
    assert first.startswith(f"{model}:6:9: error UNKNOWN_PART ")
    assert verdict == f"{model}: invalid (1 error)"


def test_a_warning_does_not_make_a_model_invalid(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model.write_text("{}\n")

    assert check(str(model), "text") == 0
    assert capsys.readouterr().out.splitlines()[-1] == f"{model}: valid (1 warning)"


def test_a_program_gets_the_findings_as_json(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model.write_text(BAD)

    assert check(str(model), "json") == 1
    shown = json.loads(capsys.readouterr().out)
    assert shown["valid"] is False
    assert (shown["findings"][0]["code"], shown["findings"][0]["line"]) == ("UNKNOWN_PART", 6)


def test_a_file_that_is_not_there_is_told_in_one_line(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert check(str(model), "text") == 1
    assert capsys.readouterr() == (
        "",
        f"pilothouse: {model} cannot be read: No such file or directory\n",
    )


def test_a_finding_without_a_place_points_at_the_begin_of_the_file() -> None:
    finding = Finding("error", "EMPTY", "there is nothing in it")

    assert (
        finding_line("robot.yaml", finding) == "robot.yaml:1:1: error EMPTY there is nothing in it"
    )
