import math

import pytest

from service.files.parameter_file import ParameterFile, plain_value, read_parameter_file
from service.files.yaml_tree import read_tree


def read(text: str) -> ParameterFile:
    tree = read_tree(text)
    assert tree.findings == []
    return read_parameter_file(tree.documents)


def values(text: str) -> dict[str, dict[str, object]]:
    file = read(text)
    assert file.findings == []
    return {name: {p.name: p.value for p in node.parameters} for name, node in file.nodes.items()}


def faults(text: str) -> list[tuple[str, int | None, int | None]]:
    return [(finding.code, finding.line, finding.column) for finding in read(text).findings]


# --- scalars: get_value in rcl_yaml_param_parser, parse.c ---


@pytest.mark.parametrize("word", ["y", "Y", "yes", "Yes", "YES", "true", "True", "TRUE"])
def test_words_of_consent_are_true(word: str) -> None:
    assert plain_value(word) is True


@pytest.mark.parametrize("word", ["n", "N", "no", "No", "NO", "off", "Off", "OFF", "False"])
def test_words_of_refusal_are_false(word: str) -> None:
    assert plain_value(word) is False


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0", 0),
        ("-7", -7),
        ("+5", 5),
        ("0x10", 16),
        ("-0X1f", -31),
        ("010", 8),
        ("9223372036854775807", 2**63 - 1),
        ("-9223372036854775808", -(2**63)),
    ],
)
def test_integers_are_those_of_strtoll(text: str, value: int) -> None:
    assert type(plain_value(text)) is int
    assert plain_value(text) == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1.0", 1.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("1e3", 1000.0),
        ("-2.5E-1", -0.25),
        ("08", 8.0),
        ("9223372036854775808", 2.0**63),
        ("0x1.8p1", 3.0),
        (".inf", math.inf),
        ("-.INF", -math.inf),
        ("Infinity", math.inf),
        ("0e0", 0.0),
    ],
)
def test_other_numbers_are_those_of_strtod(text: str, value: float) -> None:
    assert type(plain_value(text)) is float
    assert plain_value(text) == value


@pytest.mark.parametrize("text", [".nan", ".NaN", "nan", "NAN"])
def test_not_a_number_is_a_double(text: str) -> None:
    number = plain_value(text)

    assert isinstance(number, float)
    assert math.isnan(number)


@pytest.mark.parametrize(
    "text",
    [
        "~",
        "null",
        "yEs",
        "tRUE",
        "1_000",
        "0o10",
        "1e",
        "1 2",
        "1e400",
        "1e-400",
        "0x",
        "٣",
        ".",
        "+",
    ],
)
def test_everything_else_is_text(text: str) -> None:
    assert plain_value(text) == text


def test_a_number_of_any_length_is_read_in_no_time() -> None:
    assert plain_value("9" * 100_000) == "9" * 100_000


def test_quotes_and_the_tag_of_strings_make_text() -> None:
    assert values("n: {ros__parameters: {a: 'on', b: \"5\", c: !!str 7, d: ''}}") == {
        "n": {"a": "on", "b": "5", "c": "7", "d": ""}
    }


# --- names ---


def test_maps_and_dots_make_the_same_names() -> None:
    assert values("n: {ros__parameters: {a: {b: {c: 1}, d.e: 2}, f: 3}}") == {
        "n": {"a.b.c": 1, "a.d.e": 2, "f": 3}
    }


def test_a_namespace_is_a_map_or_part_of_the_name() -> None:
    text = """
left: {arm: {ros__parameters: {a: 1}}, front: {leg: {ros__parameters: {a: 2}}}}
right/arm: {ros__parameters: {a: 3}}
/mast: {ros__parameters: {a: 4}}
"""

    assert values(text) == {
        "left/arm": {"a": 1},
        "left/front/leg": {"a": 2},
        "right/arm": {"a": 3},
        "mast": {"a": 4},
    }


def test_all_documents_of_a_file_count() -> None:
    assert values("a: {ros__parameters: {x: 1}}\n---\nb: {ros__parameters: {x: 2}}\n") == {
        "a": {"x": 1},
        "b": {"x": 2},
    }


def test_a_node_may_be_the_namespace_of_another_that_stands_before_its_parameters() -> None:
    assert values("a: {b: {ros__parameters: {x: 1}}, ros__parameters: {x: 2}}") == {
        "a/b": {"x": 1},
        "a": {"x": 2},
    }


def test_lists_of_one_type_are_values() -> None:
    assert values("n: {ros__parameters: {a: [1, 2], b: [x, '1'], c: [on]}}") == {
        "n": {"a": (1, 2), "b": ("x", "1"), "c": (True,)}
    }


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        pytest.param("n:\n  type: node\n", ("MISSING_ROS_PARAMETERS", 2, 3), id="no parameters"),
        pytest.param("n: {}\n", ("MISSING_ROS_PARAMETERS", 1, 1), id="nothing"),
        pytest.param("---\n", ("NOT_A_BLOCK", 2, 1), id="an empty document"),
        pytest.param("- 1\n", ("NOT_A_BLOCK", 1, 1), id="a list at the top"),
        pytest.param("n:\n  ros__parameters: 1\n", ("NOT_A_BLOCK", 2, 3), id="a value instead"),
        pytest.param("ros__parameters: {a: 1}\n", ("MISPLACED_KEY", 1, 1), id="no name above"),
        pytest.param(
            "n:\n  ros__parameters: {a: 1}\n  m: {ros__parameters: {a: 1}}\n",
            ("MISPLACED_KEY", 3, 3),
            id="a node after parameters, of which C++ loses the namespace",
        ),
        pytest.param("my-node: {ros__parameters: {a: 1}}\n", ("INVALID_NAME", 1, 1), id="a dash"),
        pytest.param("/**: {ros__parameters: {a: 1}}\n", ("INVALID_NAME", 1, 1), id="a wildcard"),
        pytest.param("a//b: {ros__parameters: {a: 1}}\n", ("INVALID_NAME", 1, 1), id="two slashes"),
        pytest.param(
            "/n: {ros__parameters: {a: 1}}\n---\nn: {ros__parameters: {a: 1}}\n",
            ("DUPLICATE_KEY", 3, 1),
            id="a node twice",
        ),
        pytest.param(
            "n:\n  ros__parameters:\n    a: {b: 1}\n    a.b: 2\n",
            ("DUPLICATE_KEY", 4, 5),
            id="a parameter twice, once with a dot",
        ),
        pytest.param("n: {ros__parameters: {a: }}\n", ("EMPTY_VALUE", 1, 26), id="no value"),
        pytest.param("n: {ros__parameters: {a: []}}\n", ("EMPTY_VALUE", 1, 26), id="an empty list"),
        pytest.param("n: {ros__parameters: {a: {}}}\n", ("EMPTY_VALUE", 1, 23), id="an empty map"),
        pytest.param(
            "n: {ros__parameters: {a: [1, 2.0]}}\n", ("INVALID_ARRAY", 1, 30), id="mixed types"
        ),
        pytest.param(
            "n: {ros__parameters: {a: [on, x]}}\n",
            ("INVALID_ARRAY", 1, 31),
            id="a name that is true",
        ),
        pytest.param(
            "n: {ros__parameters: {a: [[1]]}}\n", ("INVALID_ARRAY", 1, 27), id="a list in a list"
        ),
    ],
)
def test_what_rcl_refuses_or_misreads_is_an_error(text: str, fault: tuple[str, int, int]) -> None:
    assert faults(text) == [fault]
