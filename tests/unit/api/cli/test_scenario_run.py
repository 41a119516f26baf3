import io
import json
import sys
from pathlib import Path
from typing import Any

import pytest

from api.cli.scenario_run import FAILED, HELD, INVALID, simulate
from api.http.schemas.simulation import SimulationJson
from api.simulation import samples
from api.simulation.simulation import Simulation
from service.files.model_file import EXAMPLE

Output = pytest.CaptureFixture[str]

STORY = """\
title: The battery runs low
until_s: 31
robot: {signals: {stale_after_s: 0}}
steps:
  - {t_s: 1, reading: {battery_level: 0.4}}
  - t_s: 2
    expect:
      system_state:
        state: ERROR
"""


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def story(tmp_path: Path) -> Path:
    path = tmp_path / "story.yaml"
    path.write_text(STORY, encoding="utf-8")
    return path


def run(path: Path, text: str | None = None, **options: Any) -> int:  # noqa: ANN401
    if text is not None:
        path.write_text(text, encoding="utf-8")
    return simulate(str(path), options.pop("form", "text"), EXAMPLE, **options)


def test_what_happened_is_told_and_that_all_is_as_expected(story: Path, capsys: Output) -> None:
    assert run(story) == HELD

    told, complaints = capsys.readouterr()
    lines = told.splitlines()
    assert lines[0] == "The battery runs low"
    assert "     1.00 s  IDLE -> ERROR: BATTERY_LOW" in lines
    assert lines[-1].startswith(f"{story}: 1 as expected (31 s in 0.")
    assert complaints == ""


def test_a_failed_expectation_is_told_with_line_and_difference(story: Path, capsys: Output) -> None:
    assert run(story, STORY.replace("ERROR", "IDLE")) == FAILED

    assert capsys.readouterr().out.splitlines()[-4:-1] == [
        f"{story}:9: not as expected at 2 s: system_state.state",
        '    expected "IDLE"',
        '    actual   "ERROR"',
    ]


def test_a_condition_that_is_not_true_is_told_with_its_reasons(story: Path, capsys: Output) -> None:
    expected = "robot.state == IDLE and not (error.BATTERY_LOW or battery_level > 0.9)"
    text = STORY[: STORY.index("    expect:")] + f'    expect: "{expected}"\n'
    assert run(story, text) == FAILED

    lines = capsys.readouterr().out.splitlines()
    begin = lines.index(f"{story}:6: false at 2 s: {expected}")
    assert lines[begin + 1 : begin + 3] == [
        "    the robot is ERROR, needs IDLE",
        "        battery 40 % is below 50 %",
    ]
    assert "    BATTERY_LOW is active" in lines
    assert lines[-1].startswith(f"{story}: 1 not as expected")


def test_a_condition_about_one_thing_is_told_in_one_line(story: Path, capsys: Output) -> None:
    text = STORY[: STORY.index("    expect:")] + "    expect: battery_level >= 0.5\n"
    assert run(story, text) == FAILED

    assert capsys.readouterr().out.splitlines()[-3:-1] == [
        f"{story}:6: false at 2 s: battery_level >= 0.5",
        "    battery_level is 0.4, needs >= 0.5",
    ]


def test_a_member_that_is_not_there_is_told_as_such(story: Path, capsys: Output) -> None:
    assert run(story, STORY.replace("state: ERROR", "stat: ERROR")) == FAILED

    assert "    actual   (not there)\n" in capsys.readouterr().out


def test_a_long_value_is_cut(story: Path, capsys: Output) -> None:
    assert run(story, STORY.replace("ERROR", "x" * 1_000)) == FAILED

    assert max(map(len, capsys.readouterr().out.splitlines())) < 400


def test_a_refused_step_fails_with_its_line_and_hint(story: Path, capsys: Output) -> None:
    assert run(story, STORY.replace("battery_level: 0.4", "batery: 0.4")) == FAILED

    told = capsys.readouterr().out
    assert f"{story}:5: rejected at 1 s: there is no signal 'batery'\n    hint: known: " in told
    assert "1 not as expected, 1 rejected" in told


def test_failures_are_told_in_the_order_of_time(story: Path, capsys: Output) -> None:
    run(story, STORY.replace("ERROR", "IDLE") + "  - {t_s: 0, reading: {batery: 1}}\n")

    told = capsys.readouterr().out
    assert told.index(":10: rejected") < told.index(":9: not as")


def test_a_step_that_may_be_refused_is_as_expected(story: Path, capsys: Output) -> None:
    step = "  - {t_s: 3, reading: {batery: 1}, refused: true}\n"

    assert run(story, STORY + step) == HELD
    assert "2 as expected" in capsys.readouterr().out


def test_a_step_that_should_have_been_refused_fails(story: Path, capsys: Output) -> None:
    step = "  - {t_s: 3, reading: {battery_level: 1}, refused: true}\n"

    assert run(story, STORY + step) == FAILED
    assert f"{story}:10: not rejected at 3 s, although" in capsys.readouterr().out


def test_a_scenario_without_expectations_only_tells_what_happens(
    story: Path, capsys: Output
) -> None:
    assert run(story, "until_s: 3\n") == HELD

    lines = capsys.readouterr().out.splitlines()
    assert "     0.00 s  drive_base is reachable" in lines
    assert lines[-1].startswith(f"{story}: no expectations (3 s in ")


@pytest.mark.parametrize(("text", "code"), [(STORY, HELD), (STORY.replace("ERROR", "x"), FAILED)])
def test_as_json_it_is_the_answer_of_the_interface(
    text: str, code: int, story: Path, capsys: Output
) -> None:
    assert run(story, text, form="json") == code

    told = SimulationJson.model_validate_json(capsys.readouterr().out)
    assert len(told.samples) == 32
    assert (told.expectations[0].differences == []) is (code == HELD)


def test_an_invalid_file_is_told_with_line_and_column_and_ends_with_two(
    story: Path, capsys: Output
) -> None:
    assert run(story, "until_s: 1\nwings: 2\nlegs: 4\n") == INVALID

    told, complaints = capsys.readouterr()
    assert told == ""
    assert complaints.splitlines() == [
        f"{story}:2:1: error[INVALID_VALUE]: wings: unknown key",
        f"{story}:3:1: error[INVALID_VALUE]: legs: unknown key",
    ]


def test_a_file_that_is_not_there_ends_with_two(tmp_path: Path, capsys: Output) -> None:
    assert run(tmp_path / "no.yaml") == INVALID
    assert capsys.readouterr().err.startswith("pilothouse: ")


def test_too_much_to_be_told_ends_with_two(
    story: Path, capsys: Output, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(samples, "MAX_EVENTS", 3)

    assert run(story) == INVALID
    assert "too complex: more than 3 events" in capsys.readouterr().err


def test_the_standard_input_is_read(
    story: Path, capsys: Output, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("api.simulation.scenario_file._STANDARD_INPUT", story)

    assert run(Path("-")) == HELD
    assert "-: 1 as expected" in capsys.readouterr().out


def test_other_files_than_those_of_the_scenario_may_be_given(
    story: Path, tmp_path: Path, capsys: Output
) -> None:
    model, robot = tmp_path / "arm.yaml", tmp_path / "robot.yaml"
    model.write_text("arm: {ros__parameters: {type: node}}")
    robot.write_text("signals: {battery_level: {threshold: 0.3}, stale_after_s: 0}")

    assert run(story, model=model, robot=robot) == FAILED

    told = capsys.readouterr().out
    assert "arm is reachable" in told
    assert '    actual   "IDLE"' in told


def test_a_terminal_shows_how_far_it_is_and_is_left_clean(
    story: Path, monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)

    assert run(story) == HELD

    shown = terminal.getvalue()
    assert shown.startswith("\r\x1b[2K0.0 s of 31 s (0%)")
    assert shown.endswith("\r\x1b[2K")
    assert "\x1b" not in capsys.readouterr().out


def test_an_interruption_leaves_the_terminal_clean(
    story: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)

    def interrupted(_: Simulation, progress: Any) -> None:  # noqa: ANN401
        progress(1.0)
        raise KeyboardInterrupt

    monkeypatch.setattr(Simulation, "run", interrupted)

    with pytest.raises(KeyboardInterrupt):
        run(story)
    assert terminal.getvalue().endswith("\r\x1b[2K")


def test_json_of_a_posted_body_runs_as_it_is(story: Path) -> None:
    body = {"until_s": 1, "model": None, "steps": [{"t_s": 0, "task": None}]}

    assert run(story, json.dumps(body)) == HELD
