import pytest

from domain.timebase import Duration, seconds
from service.files.extension import NAMES_OF_CPP, Setting
from service.files.parameter_file import read_parameter_file
from service.files.setting_values import InvalidSettingError, SettingValues
from service.files.smh_block import SmhBlock
from service.files.yaml_tree import read_tree


def setting(value: str) -> tuple[SmhBlock, SettingValues, Setting]:
    text = f"n: {{ros__parameters: {{type: node, mode_settings: {{x: {value}}}}}}}\n"
    (source,) = read_parameter_file(read_tree(text).documents, NAMES_OF_CPP).nodes.values()
    block = SmhBlock(source)
    return block, SettingValues(block), block.settings[0]


@pytest.mark.parametrize(
    ("value", "texts"), [("[a b, c]", ["a b", "c"]), ("a b", ["a b"]), ("['1', 'on']", ["1", "on"])]
)
def test_texts_are_a_list_or_one_text(value: str, texts: list[str]) -> None:
    _, values, line = setting(value)

    assert [text for text, _ in values.texts(line, "n", 5)] == texts


@pytest.mark.parametrize(
    ("value", "code", "column"),
    [
        pytest.param("[a, 1]", "INVALID_VALUE", 58, id="a number"),
        pytest.param("on", "INVALID_VALUE", 54, id="a word that is a boolean"),
        pytest.param("[a, [b]]", "INVALID_VALUE", 58, id="a list in the list"),
        pytest.param("[a, a, a, a, a, a]", "TOO_LARGE", 51, id="too many"),
    ],
)
def test_what_is_no_list_of_texts_is_rejected(value: str, code: str, column: int) -> None:
    block, values, line = setting(value)

    with pytest.raises(InvalidSettingError):
        values.texts(line, "n", 5)
    assert [(f.code, f.column) for f in block.findings if f.severity == "error"] == [(code, column)]


@pytest.mark.parametrize(
    ("value", "duration"),
    [("0.5", seconds(0.5)), ("2", seconds(2)), ("0", 0), ("86400", seconds(86_400))],
)
def test_a_time_is_read_in_seconds(value: str, duration: Duration) -> None:
    _, values, line = setting(value)

    assert values.duration(line, "n", zero=True) == duration


@pytest.mark.parametrize(
    "value", ["-1", "86401", ".inf", ".nan", "1e300", "true", "soon", "[1, 2]", "'1'"]
)
def test_what_is_no_time_in_range_is_rejected(value: str) -> None:
    block, values, line = setting(value)

    with pytest.raises(InvalidSettingError):
        values.duration(line, "n", zero=True)
    assert [f.code for f in block.findings] == ["INVALID_VALUE"]


def test_a_time_that_must_not_be_zero_is_rejected_when_it_is() -> None:
    block, values, line = setting("0")

    with pytest.raises(InvalidSettingError):
        values.duration(line, "n", zero=False)
    assert "more than 0" in block.findings[0].message


def test_one_of_some_words_is_that_word() -> None:
    _, values, line = setting("stop")

    assert values.choice(line, "n", ("go", "stop")) == "stop"


@pytest.mark.parametrize(
    ("value", "words"),
    [("stopp", "did you mean stop?"), ("3", "expected a text"), ("[go, stop]", "expected one")],
)
def test_what_is_none_of_the_words_is_rejected(value: str, words: str) -> None:
    block, values, line = setting(value)

    with pytest.raises(InvalidSettingError):
        values.choice(line, "n", ("go", "stop"))
    assert words in block.findings[0].message
