"""The numbers of the rows, and their faults."""

import pytest

from service.files.csv_numbers import Numbers, first_rows, read_numbers
from service.files.csv_table import MAX_FINDINGS, InvalidWaypointsError, read_table

NAMES = ("x", "y", "yaw")


def numbers(text: str, *used: int) -> Numbers:
    columns = used or (0, 1, 2)
    return read_numbers(read_table(text, None), columns, NAMES[: len(columns)])


def faults(text: str) -> list[tuple[str, int | None, int | None]]:
    with pytest.raises(InvalidWaypointsError) as caught:
        numbers(text)
    return [(fault.code, fault.line, fault.column) for fault in caught.value.findings]


@pytest.mark.parametrize(
    "text",
    [
        "1,2,3\n4,5,6\n",
        "1;2;3\r\n4;5;6",
        "1\t2\t3\r4\t5\t6",
        " 1  2 3\n4 5\t6 ",
        "1,2,3,\n4,5,6\n",
        "1,2,3\n4,5,6,,\n",
        '"1","2","3"\n4,5,6',
        "1,2,3\n# between\n4,5,6\n",
        "1.0e0,2,3\n4,+5,6.",
    ],
)
def test_rows_are_numbers_however_they_are_written(text: str) -> None:
    assert numbers(text).values.tolist() == [[1, 2, 3], [4, 5, 6]]


def test_columns_are_taken_in_the_order_that_was_asked() -> None:
    assert numbers("1,2,3\n4,5,6\n", 2, 0).values.tolist() == [[3, 1], [6, 4]]


def test_each_row_knows_its_line() -> None:
    assert numbers("# a\n1,2,3\n# b\n4,5,6\n").lines == [2, 4]


def test_text_in_a_column_that_is_not_read_makes_no_difference() -> None:
    assert numbers("1,2,3,map\n4,5,6,\n").values.shape == (2, 3)


@pytest.mark.parametrize("text", ["1,5;2;3\n4;5;6,25", "1;2;3\n4;5;6,25", '"1,5",2,3\n4,5,6'])
def test_decimal_commas_are_read_where_commas_do_not_separate(text: str) -> None:
    assert numbers(text).has_decimal_comma


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("1,2,3\n\n4,5,6", [("EMPTY_LINE", 2, 1)]),
        ("1,2,3\n4,5\n", [("TOO_FEW_COLUMNS", 2, 1)]),
        ("1,2,3\n4,5,6,7\n", [("TOO_MANY_COLUMNS", 2, 1)]),
        ("1,2,3\n4,zero,6\n", [("NOT_A_NUMBER", 2, 3)]),
        ("1,2,3\n4,  zero,6\n", [("NOT_A_NUMBER", 2, 5)]),
        ("1,2,3\n4,,6\n", [("NOT_A_NUMBER", 2, 3)]),
        ("1,2,3\n , ,\n", [("NOT_A_NUMBER", 2, 2)]),
        ("1,2,3\nx,y,yaw\n4,5,6\n", [("NOT_A_NUMBER", 2, 1)]),
        ("1,2,3\n4,5_0,6\n", [("NOT_A_NUMBER", 2, 3)]),
        ("1,2,3\n4,\u0661,6\n", [("NOT_A_NUMBER", 2, 3)]),
        ("nan,0,0\n1,0,0\n", [("NOT_FINITE", 1, 1)]),
        ("0,0,-inf\n1,0,1e999\n", [("NOT_FINITE", 1, 5), ("NOT_FINITE", 2, 5)]),
        ("0,0,0\n1,-10000001,0\n", [("TOO_FAR", 2, 3)]),
        ("0,0,0\n", [("TOO_FEW_POINTS", 1, 1)]),
        ("1,5;2;3\n1.5;2;3\n", [("DECIMAL_MARKS", 2, 1)]),
        ("1.5;2;3\n1,5;2;3\n", [("DECIMAL_MARKS", 1, 1)]),
        ("1;2;3\n1.234,5;2;3\n", [("NOT_A_NUMBER", 2, 1)]),
    ],
)
def test_each_faulty_line_is_told_once_with_its_place(
    text: str, found: list[tuple[str, int, int]]
) -> None:
    assert faults(text) == found


def test_faults_of_every_kind_come_in_the_order_of_the_file() -> None:
    assert faults("0,0,0\n1,nan,0\n2,x,0\n3,0\n4,2e7,0\n") == [
        ("NOT_FINITE", 2, 3),
        ("NOT_A_NUMBER", 3, 3),
        ("TOO_FEW_COLUMNS", 4, 1),
        ("TOO_FAR", 5, 3),
    ]


@pytest.mark.parametrize("line", ["a,b,c", "1,0", "", "nan,nan,nan"])
def test_no_more_faults_are_told_than_anybody_reads(line: str) -> None:
    assert len(faults("0,0,0\n" + f"{line}\n" * 1_000 + "1,0,0\n")) == MAX_FINDINGS


def test_a_hundred_thousand_rows_are_read_and_no_more() -> None:
    assert len(numbers("0,0,0\n" * 100_000).values) == 100_000
    assert faults("# a\n" + "0,0,0\n" * 100_001) == [("TOO_MANY_POINTS", 100_002, 1)]


def test_the_first_rows_have_gaps_where_there_is_no_number() -> None:
    rows = first_rows(read_table("1,2,map\n3,x,7\n5,6,7\n", None), 2, 3)

    assert str(rows.tolist()) == "[[1.0, 2.0, nan], [3.0, nan, 7.0]]"
