"""The example scenarios: each holds, by the same code as `pilothouse simulate`."""

from pathlib import Path

import pytest

from api.cli.command_line import main
from tests.support.shared import PROJECT

EXAMPLES = sorted((PROJECT / "examples").glob("**/scenarios/*.yaml"))
Output = pytest.CaptureFixture[str]


def test_there_are_the_stories_of_the_operator_and_the_steps_of_annex_4() -> None:
    assert len(EXAMPLES) >= 27
    assert sum(path.name.startswith("annex4_step") for path in EXAMPLES) == 4


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_goes_as_it_says(path: Path, capsys: Output) -> None:
    code = main(["simulate", str(path)])

    told = capsys.readouterr()
    assert (code, told.err) == (0, ""), told.out
    assert f"{path}: " in told.out
    assert "as expected" in told.out


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_has_a_title_a_comment_and_expectations(path: Path) -> None:
    text = path.read_text(encoding="utf-8")

    assert text.startswith("# ")
    assert "\ntitle: " in text
    assert "expect:" in text


def test_an_example_that_expects_something_else_fails_and_says_where(
    tmp_path: Path, capsys: Output
) -> None:
    text = (PROJECT / "examples" / "scenarios" / "battery.yaml").read_text(encoding="utf-8")
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(
        text.replace("reading: {battery_level: 0.49}", "reading: {battery_level: 0.5}")
    )
    place = next(
        number for number, line in enumerate(text.split("\n"), 1) if "t_s: 2.0, expect" in line
    )

    assert main(["simulate", str(wrong)]) == 1

    lines = capsys.readouterr().out.splitlines()
    at = lines.index(f"{wrong}:{place}: not as expected at 2 s: system_state.state")
    assert lines[at + 1 : at + 3] == ['    expected "ERROR"', '    actual   "IDLE"']
