import json
from pathlib import Path

import pytest

from api.cli.command_line import main
from api.cli.commands.check import check

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
    assert capsys.readouterr().out.splitlines() == [
        f"{model}:6:9: error[UNKNOWN_PART]: robot in __DEFAULT__: there is no part 'arm'",
        "    6 |         arm: active",
        "      |         ^",
        f"{model}: invalid (1 error)",
    ]


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
    assert check(str(model), "text") == 2
    assert capsys.readouterr() == (
        "",
        f"pilothouse: {model} cannot be read: No such file or directory\n",
    )


GUARDED = GOOD + "    mode_settings: {STRONG: {requires: reach > 3}}\n"


def test_a_code_host_gets_the_findings_as_sarif(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model.write_text(BAD)

    assert check(str(model), "sarif") == 1
    (run,) = json.loads(capsys.readouterr().out)["runs"]
    assert [result["ruleId"] for result in run["results"]] == ["UNKNOWN_PART"]


@pytest.mark.parametrize(
    ("settings", "code", "words"),
    [
        (None, 0, "warning[UNKNOWN_SIGNAL]"),
        ("mock: true\n", 1, "error[UNKNOWN_SIGNAL]"),
        ("signals: {reach: {minimum: 0}}\n", 0, "robot.yaml: valid"),
        ("signals: {reach: {minimun: 0}}\n", 1, "error[UNKNOWN_KEY]"),
    ],
)
def test_signals_are_those_of_the_robot_file(
    settings: str | None,
    code: int,
    words: str,
    model: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    model.write_text(GUARDED)
    robot = tmp_path / "own.yaml"
    robot.write_text(settings or "")

    assert check(str(model), "text", None if settings is None else str(robot)) == code
    assert words in capsys.readouterr().out


def test_without_a_valid_model_the_robot_file_is_not_checked(
    model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model.write_text(BAD)
    robot = tmp_path / "own.yaml"
    robot.write_text("moc: true\n")

    assert check(str(model), "text", str(robot)) == 1
    assert "own.yaml" not in capsys.readouterr().out


def test_a_robot_file_that_is_not_there_is_told_in_one_line(
    model: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model.write_text(GOOD)

    assert check(str(model), "text", "gone.yaml") == 2
    assert capsys.readouterr().err == (
        "pilothouse: gone.yaml cannot be read: No such file or directory\n"
    )


def test_check_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[tuple[object, ...]] = []

    def check(*asked: object) -> int:
        given.append(asked)
        return 1

    monkeypatch.setattr("api.cli.commands.check.check", check)

    assert main(["check", "robot.yaml"]) == 1
    main(["check", "-", "--format", "json", "--robot", "own.yaml"])

    assert given == [("robot.yaml", "text", None), ("-", "json", "own.yaml")]
