from rich.text import Text

from api.cli.monitor.lines import counted, cut, wrapped
from api.cli.monitor.rows import Chosen, PartRow
from tests.support.monitor import console, part


def test_a_long_text_goes_on_indented() -> None:
    lines = wrapped("the arm is not where it should be", console(12), indent=2)

    assert [line.plain for line in lines] == ["the arm is", "  not where", "  it should", "  be"]


def test_a_short_text_is_one_line() -> None:
    assert [line.plain for line in wrapped("calm", console(12), indent=2)] == ["calm"]


def test_lines_that_do_not_fit_are_counted() -> None:
    lines = [Text(name) for name in "abcd"]

    assert [line.plain for line in cut(lines, 3)] == ["a", "b", "  ... and 2 more lines"]
    assert cut(lines, 4) is lines


def test_rows_that_do_not_fit_are_counted_with_those_that_need_attention() -> None:
    rows = (PartRow(part("arm")),)

    assert counted(Chosen(rows), "parts") == []
    assert [line.plain for line in counted(Chosen(rows, 4), "parts")] == ["  ... and 4 more parts"]
    assert [line.plain for line in counted(Chosen(rows, 4, 2), "parts")] == [
        "  ... and 4 more parts, 2 of them marked"
    ]
