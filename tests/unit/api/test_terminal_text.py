import pytest

from api.terminal_text import complain, counted, finding_line, say, visible
from domain.findings import Finding


def test_a_complaint_names_the_program_on_the_standard_error(
    capsys: pytest.CaptureFixture[str],
) -> None:
    complain("no such file")

    assert capsys.readouterr() == ("", "pilothouse: no such file\n")


def test_a_line_cannot_steer_the_terminal_and_is_one_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    say("arm\x1b[2J\n")
    complain("two\nlines \x1b")

    told = capsys.readouterr()
    assert told.out == "arm\\x1b[2J\\n\n"
    assert told.err == "pilothouse: two\nlines \\x1b\n"


def test_a_finding_without_a_place_points_at_the_begin_of_the_file() -> None:
    finding = Finding("error", "EMPTY", "there is nothing in it")

    assert (
        finding_line("robot.yaml", finding)
        == "robot.yaml:1:1: error[EMPTY]: there is nothing in it"
    )


def test_several_things_are_told_from_one() -> None:
    assert [counted(number, "error") for number in (0, 1, 2)] == ["0 errors", "1 error", "2 errors"]


def test_characters_that_steer_a_terminal_or_turn_a_text_round_are_escaped() -> None:
    finding = Finding("error", "ODD", "\x1b[2Jodd\u202e", line=2, column=3)

    assert finding_line("a\nb", finding) == "a\\nb:2:3: error[ODD]: \\x1b[2Jodd\\u202e"
    assert visible("a\x00\U000e0001e\u0301é日") == "a\\x00\\U000e0001e\u0301é日"
