"""Comments, headers and rows."""

import pytest

from service.files.csv_table import CsvTable, InvalidWaypointsError, Names, read_table


def names_x(names: Names) -> bool:
    return "x" in names


def table(text: str) -> CsvTable:
    return read_table(text, names_x)


def refused(text: str) -> tuple[str, int | None]:
    with pytest.raises(InvalidWaypointsError) as caught:
        table(text)
    return caught.value.findings[0].code, caught.value.findings[0].line


@pytest.mark.parametrize(
    ("text", "line", "names"),
    [
        ("x,y\n1,2", 1, ("x", "y")),
        ("# x,y\n1,2", 1, ("x", "y")),
        ("#x; y\n1;2", 1, ("x", "y")),
        ("% x,y\n1,2", 1, ("x", "y")),
        ("# made by hand\n# x,y\n1,2", 2, ("x", "y")),
        ("# x,y\n# made by hand\n1,2", 1, ("x", "y")),
        ("\n\n x , y \n\n1,2", 3, ("x", "y")),
        ("x y\n1,2", 1, ("x", "y")),
        ("# x, y\n1 2", 1, ("x", "y")),
        ("Track of Monday\nx,y\n1,2", 2, ("x", "y")),
        ("sep=;\nx;y\n1;2", 2, ("x", "y")),
        ('"x","y"\n1,2', 1, ("x", "y")),
        ("\ufeffx,y\r\n1,2\r\n", 1, ("x", "y")),
        ("x,y,\n1,2,\n", 1, ("x", "y", "")),
        ("x,y\n1,2,\n", 1, ("x", "y")),
    ],
)
def test_a_line_before_the_rows_names_the_columns(text: str, line: int, names: Names) -> None:
    header = table(text).header

    assert header is not None
    assert (header.line, header.names) == (line, names)


@pytest.mark.parametrize(
    "text", ["1,2", "# from here to there\n1,2", "# x,y,z\n1,2", "# x\n1,2\n# x,y\n"]
)
def test_a_comment_that_names_another_number_of_columns_is_no_header(text: str) -> None:
    assert (table(text).header, table(text).title) == (None, None)


@pytest.mark.parametrize(
    ("text", "title"), [("a,b\n1,2", 0), ("x,y,z\n1,2", 0), ("x,y\nm,m\n1,2", 1)]
)
def test_a_line_of_text_that_is_no_header_is_told(text: str, title: int) -> None:
    assert (table(text).header, table(text).title) == (None, title)


def test_blanks_before_a_unit_separate_nothing() -> None:
    header = read_table("x [m]  y (m)\n1   2", lambda names: names[0].startswith("x")).header

    assert header is not None
    assert header.names == ("x[m]", "y(m)")


def test_no_header_is_looked_for_where_none_is_needed() -> None:
    assert read_table("x,y\nm,m\n1,2", None).header is None


def test_comments_are_left_out_of_the_rows_and_empty_lines_are_not() -> None:
    rows = list(table("# a\n1,2\n # b\n\n% c\n3,4\n\n\n").rows())

    assert rows == [(2, "1,2"), (4, ""), (6, "3,4")]


@pytest.mark.parametrize(
    ("line", "width"), [("1,2", (2, 2)), ("1,2,", (2, 3)), ("1,2,,", (2, 4)), ("1 2 ", (2, 2))]
)
def test_empty_cells_at_the_end_of_the_first_row_may_be_left_out(
    line: str, width: tuple[int, int]
) -> None:
    # A file that ends there would lose its last separators.
    found = table(f"{line}\n3,4")

    assert (found.least, found.most) == width


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        ("", "EMPTY_FILE", 1),
        ("\n \r\n", "EMPTY_FILE", 1),
        ("\ufeff", "EMPTY_FILE", 1),
        ("# x,y\n# z\n", "EMPTY_FILE", 1),
        ("\nx,y\n", "NO_NUMBERS", 2),
        ("one\n" * 1_000 + "1,2\n", "NO_NUMBERS", 1),
        ("1,2\n3,\0 4\n", "NOT_TEXT", 2),
        ("," * 2_000, "TOO_MANY_COLUMNS", 1),
        ("\n" * 200_000 + "1,2", "TOO_MANY_POINTS", 200_001),
        ("1,2\r" * 400_001, "TOO_MANY_POINTS", 200_001),
    ],
)
def test_what_is_no_table_is_refused_with_its_line(text: str, code: str, line: int) -> None:
    assert refused(text) == (code, line)
