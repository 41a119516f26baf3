import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.files.source_text import SourceText
from service.files.yaml_tree import Mapping, Scalar, read_tree


def value_of(text: str) -> Scalar:
    (root,) = read_tree(text).documents
    assert isinstance(root, Mapping)
    ((_, value),) = root.entries
    assert isinstance(value, Scalar)
    return value


def place(text: str, character: str) -> tuple[int, int]:
    """Return the place of a character of the value."""
    value = value_of(text)
    found = SourceText(text).place(value, value.text.index(character))
    return found.line, found.column


@pytest.mark.parametrize(
    ("text", "column"),
    [
        pytest.param("k: a b X\n", 8, id="plain"),
        pytest.param("k: 'a b X'\n", 9, id="in single quotes"),
        pytest.param("k: 'it''s X'\n", 11, id="a doubled quote"),
        pytest.param('k: "a b X"\n', 9, id="in double quotes"),
        pytest.param('k: "a\\tb \\x41\\u0042\\"X"\n', 22, id="escapes"),
        pytest.param("k: 'é日 X'\n", 8, id="characters, not bytes"),
        pytest.param("k: &anchor !!str 'a X'\n", 21, id="after an anchor and a tag"),
        pytest.param("{k: a X}\n", 7, id="in a flow map"),
    ],
)
def test_a_character_of_a_value_on_one_line_is_found_exactly(text: str, column: int) -> None:
    assert place(text, "X") == (1, column)


@pytest.mark.parametrize(
    "text",
    [
        "k: >\n  a b\n  X\n",
        "k: |\n  a X\n",
        "k: a b\n  X\n",
        "k: 'a b\n  X'\n",
        'k: "a b\n  X"\n',
    ],
)
def test_a_value_of_several_lines_is_found_by_its_start(text: str) -> None:
    assert place(text, "X") == (1, 4)


def test_the_end_of_a_value_is_found_too() -> None:
    value = value_of("k: 'a b'\n")

    assert SourceText("k: 'a b'\n").place(value, 3).column == 8


@given(st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Zl", "Zp")), min_size=1))
def test_any_text_in_quotes_is_found_exactly(value: str) -> None:
    text = "k: '" + value.replace("'", "''") + "'"
    scalar = value_of(text)
    assert scalar.text == value

    for index, character in enumerate(value):
        assert text[SourceText(text).place(scalar, index).column - 1] == character
