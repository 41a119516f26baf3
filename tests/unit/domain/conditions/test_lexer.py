import pytest

from domain.conditions.lexer import MAX_LENGTH, ConditionSyntaxError, TokenKind, number_of, tokens


def _texts(text: str) -> list[str]:
    return [token.text for token in tokens(text)]


def test_a_condition_is_cut_into_words_numbers_and_signs() -> None:
    assert _texts("part('left/arm').mode != A") == (
        ["part", "(", "left/arm", ")", ".", "mode", "!=", "A", ""]
    )
    assert [token.kind for token in tokens("x >= .5")][:3] == (
        [TokenKind.WORD, TokenKind.SIGN, TokenKind.NUMBER]
    )


def test_columns_count_characters_and_not_bytes() -> None:
    assert [token.column for token in tokens("  größe\t< 'ü' ")] == [3, 9, 11, 14]


@pytest.mark.parametrize(
    ("text", "value"),
    [("7", 7), ("0", 0), ("0.30", 0.3), (".5", 0.5), ("5.", 5.0), ("1e3", 1000.0), ("1_000", 1000)],
)
def test_numbers_are_those_of_python(text: str, value: float) -> None:
    number = number_of(next(tokens(text)))

    assert (number, type(number)) == (value, type(value))


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        ("x < 007", 5, "'007' is neither a number nor a word"),
        ("x < 0x1F", 5, "'0x1F' is neither"),
        ("x < 3m", 5, "'3m' is neither"),
        ("x < 1__0", 5, "'1__0' is neither"),
        ("x < 1e", 5, "'1e' is neither"),
        ("x < 5j", 5, "'5j' is neither"),
        ("x = 3", 3, "write == to compare"),
        ("!x", 1, "write not"),
        ("x && y", 3, "write and"),
        ("x | y", 3, "write or"),
        ("x * 2 < 3", 3, "does not calculate"),
        ("x == 'a", 6, "the quote is not closed"),
        (r"x == 'a\'b'", 6, "the quote is not closed"),
        ("x\nand y", 2, "a condition is one line"),
        ("x < 1 # low", 7, "'#' is not allowed here"),
        ("x := 1", 3, "':' is not allowed here"),
        ("x == \x00", 6, r"'\\x00' is not allowed here"),
        ("x == 'a\x00'", 8, r"'\\x00' is not allowed in quotes"),
        ("x == '\ud800'", 7, r"'\\ud800' is not allowed in quotes"),
        ("x\u00a0< 1", 2, r"'\\xa0' is not allowed here"),
        ("x" * (MAX_LENGTH + 1), MAX_LENGTH + 1, "at most 500 characters, not 501"),
    ],
)
def test_what_no_condition_holds_is_named_with_its_column(
    text: str, column: int, message: str
) -> None:
    with pytest.raises(ConditionSyntaxError, match=message) as caught:
        list(tokens(text))

    assert caught.value.column == column


def test_a_number_that_no_float_can_hold_is_too_large() -> None:
    for text in ("1e999", "9" * 400):
        with pytest.raises(ConditionSyntaxError, match="too large"):
            number_of(next(tokens(text)))


def test_blanks_around_a_condition_and_the_line_end_of_a_block_do_not_count() -> None:
    assert _texts("\n  estop  \n") == ["estop", ""]
