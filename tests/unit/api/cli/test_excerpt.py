import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from api.cli.excerpt import AFTER, BEFORE, excerpt


def shown(text: str, column: int) -> list[str]:
    return list(excerpt([text], 1, column))


def test_a_line_is_shown_with_its_number_and_a_caret_below_the_character() -> None:
    assert list(excerpt(["a:", "  b: cd"], 2, 6)) == ["    2 |   b: cd", "      |      ^"]


def test_a_caret_may_stand_after_the_end_of_a_line() -> None:
    assert shown("ab", 3) == ["    1 | ab", "      |   ^"]


def test_a_tab_is_as_wide_above_the_caret_as_below() -> None:
    assert shown("\tb: c", 2) == ["    1 |     b: c", "      |     ^"]


def test_wide_characters_take_two_columns_and_marks_none() -> None:
    assert shown("日本: x", 5)[1] == "      |       ^"
    assert shown("e\u0301: x", 5)[1] == "      |    ^"


def test_characters_that_steer_a_terminal_or_turn_a_text_round_are_escaped() -> None:
    assert shown("\x1b[2Ja\u202eb", 5)[0] == "    1 | \\x1b[2Ja\\u202eb"
    assert shown("\x1b[2Ja", 5)[1] == "      |        ^"


def test_of_a_long_line_the_piece_around_the_caret_is_shown() -> None:
    line, caret = shown("x" * 5_000 + "Y" + "z" * 5_000, 5_001)

    assert line == f"    1 | ...{'x' * BEFORE}Y{'z' * (AFTER - 1)}..."
    assert line[caret.index("^")] == "Y"


def test_a_line_that_is_not_there_is_not_shown() -> None:
    assert list(excerpt(["a"], 2, 1)) == []


@pytest.mark.parametrize("text", ["", "a"])
def test_a_short_line_is_shown_whole(text: str) -> None:
    assert shown(text, 1) == [f"    1 | {text}", "      | ^"]


@given(st.text(max_size=300), st.data())
def test_whatever_is_in_a_line_it_takes_one_printable_line_of_bounded_width(
    text: str, data: st.DataObject
) -> None:
    column = data.draw(st.integers(1, len(text) + 1))

    for line in shown(text, column):
        hidden = {c for c in line if unicodedata.category(c) in ("Cc", "Cf", "Cs", "Zl", "Zp")}
        assert not hidden
        assert sum(unicodedata.category(c) not in ("Mn", "Me") for c in line) < 130
