import pytest

from api.terminal_text import complain, counted, finding_line
from domain.findings import Finding


def test_a_complaint_names_the_program_on_the_standard_error(
    capsys: pytest.CaptureFixture[str],
) -> None:
    complain("no such file")

    assert capsys.readouterr() == ("", "pilothouse: no such file\n")


def test_a_finding_without_a_place_points_at_the_begin_of_the_file() -> None:
    finding = Finding("error", "EMPTY", "there is nothing in it")

    assert (
        finding_line("robot.yaml", finding) == "robot.yaml:1:1: error EMPTY there is nothing in it"
    )


def test_several_things_are_told_from_one() -> None:
    assert [counted(number, "error") for number in (0, 1, 2)] == ["0 errors", "1 error", "2 errors"]
