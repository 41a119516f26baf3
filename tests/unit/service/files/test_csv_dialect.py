"""Separators and decimal marks."""

import pytest

from service.files.csv_dialect import (
    MAX_COLUMNS,
    Dialect,
    dialect_of,
    has_decimal_comma,
    is_number,
    is_text,
    number_in,
)


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ("1,2,3", "comma"),
        ("1, 2, 3", "comma"),
        ("1 ,\t2,3", "comma"),
        ("1;2;3", "semicolon"),
        ("1; 2; 3;", "semicolon"),
        ("1,5;2,5;0,1", "semicolon"),
        ('1.0;2.0;"a, b"', "semicolon"),
        ("1\t2\t3", "tab"),
        ("1,5\t2,5", "tab"),
        ("  1   2\t3 ", "blank"),
        ("1,5 2,5 0,1", "blank"),
        ("2020-01-01 10:00:00,1,2", "comma"),
        ('"1","2"', "comma"),
        ("1", "comma"),
        ("zero;1", "semicolon"),
    ],
)
def test_the_separator_is_the_one_that_makes_numbers_of_a_line(line: str, word: str) -> None:
    assert dialect_of(line).word == word


@pytest.mark.parametrize(
    ("separator", "line", "cells"),
    [
        (",", "1,2,,", ["1", "2", "", ""]),
        (" ", "  1 \t 2  ", ["1", "2"]),
        (",", '"1,5","2"', ["1,5", "2"]),
        (",", '1, "2"', ["1", "2"]),
        (" ", '"X [m]"  "Y [m]"', ["X [m]", "Y [m]"]),
        (";", '"a";1', ["a", "1"]),
    ],
)
def test_lines_are_split_at_separators_outside_of_quotes(
    separator: str, line: str, cells: list[str]
) -> None:
    assert Dialect(separator).cells(line) == cells


@pytest.mark.parametrize("line", ["1,2,3,4,5", '1,2,"3",4,5'])
def test_no_more_cells_are_made_than_asked_for(line: str) -> None:
    cells = Dialect(",").cells(line, 2)

    assert len(cells) == 3
    assert cells[:2] == ["1", "2"]


@pytest.mark.parametrize("line", ['"' + "," * 5_000, '"' + "9" * 200_000 + '",1', '"' * 9_999])
def test_quotes_without_end_are_split_somehow(line: str) -> None:
    for separator in ",; \t":
        assert len(Dialect(separator).cells(line)) <= MAX_COLUMNS + 1


@pytest.mark.parametrize(
    ("separator", "line", "cell", "column"),
    [
        (",", "1,zero", 1, 3),
        (",", "1,  zero", 1, 5),
        (",", "1,,0", 1, 3),
        (" ", "1   zero", 1, 5),
        (",", '"1","zero"', 1, 6),
        (",", "1,2", 5, 5),
    ],
)
def test_the_place_of_a_cell_is_where_its_text_begins(
    separator: str, line: str, cell: int, column: int
) -> None:
    assert Dialect(separator).place(line, cell) == column


@pytest.mark.parametrize(
    ("cell", "number"),
    [("1.5", 1.5), (" 1e3 ", 1000.0), ("1,5", 1.5), ("-1,5e-1", -0.15), ("+.5", 0.5)],
)
def test_numbers_have_a_point_or_a_comma(cell: str, number: float) -> None:
    assert number_in(cell) == number


@pytest.mark.parametrize("cell", ["", " ", "1_0", "\u0661", "1,2,3", "1.234,5", "1,", ",5", "0x1"])
def test_what_is_no_number_is_none(cell: str) -> None:
    assert not is_number(cell)


def test_a_decimal_comma_stands_between_digits() -> None:
    assert has_decimal_comma(" 1,5 ")
    assert not has_decimal_comma("1.5")


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("x,y", True),
        ("X [m];Y [m]", True),
        ("Track 5, recorded in 2020", True),
        (",x,y", True),
        ("1,2", False),
        ("x,1", False),
        ("nan,nan", False),
        ("1,5 2,5", False),
        (", ,", False),
        ("", False),
    ],
)
def test_text_has_words_and_no_number(line: str, expected: bool) -> None:
    assert is_text(line) is expected
