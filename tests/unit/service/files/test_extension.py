import pytest

from domain.findings import Finding
from service.files.extension import (
    MAX_SETTINGS,
    NAMES_OF_CPP,
    Setting,
    is_in_extension,
    read_extensions,
)
from service.files.parameter_file import read_parameter_file
from service.files.yaml_tree import read_tree


def read(body: str) -> tuple[list[Setting], list[Finding]]:
    """Read the extensions of a node; the text of `body` begins in line 2, column 1."""
    text = "n: {ros__parameters: {type: node,\n" + body + "}}\n"
    tree = read_tree(text, is_in_extension)
    file = read_parameter_file(tree.documents, NAMES_OF_CPP)
    assert file.findings == []
    settings, findings = read_extensions(file.nodes["n"])
    return settings, [*tree.findings, *findings]


def names(body: str) -> list[str]:
    return [".".join(setting.path) for setting in read(body)[0]]


def test_nested_and_dotted_names_are_the_same() -> None:
    assert names("a: {b: {c: 1}}, d.e: 2") == ["a.b.c", "d.e"]


def test_what_the_cpp_reads_needs_no_warning() -> None:
    assert read("a: {b: 1, c: [x, y z], d: 'on'}, mode_settings: {FAST: {grace_s: 1}}")[1] == []


@pytest.mark.parametrize(
    ("body", "column"),
    [
        pytest.param("a: {b: }", 5, id="nothing"),
        pytest.param("a: {b: ~}", 8, id="a null of YAML"),
        pytest.param("a: {b: null}", 8, id="a null in words"),
        pytest.param("a: {b: [1, null]}", 12, id="a null in a list"),
        pytest.param("a: {b: []}", 8, id="an empty list"),
        pytest.param("a: {b: {}}", 5, id="an empty map"),
        pytest.param("a: {b: [{c: 1}]}", 9, id="a list of maps"),
        pytest.param("a: {b: [[1], [2]]}", 9, id="a list of lists"),
        pytest.param("a: {b: [x, 1]}", 12, id="a list of several types"),
        pytest.param("a: {b: [x, on]}", 12, id="a word that is a boolean"),
        pytest.param("a: {b: &x 1, c: *x}", 17, id="an alias"),
        pytest.param("a: {our_modes: {c: 1}}", 5, id="a name that ends as a block of the C++"),
        pytest.param("a: {house_rules: 1}", 5, id="another such name"),
        pytest.param("a: {x.modes.y: 1}", 5, id="such a name between dots"),
        pytest.param("safety_rules: {x: 1}", 1, id="such a name of a whole block"),
    ],
)
def test_what_the_cpp_rejects_or_misreads_is_a_warning(body: str, column: int) -> None:
    _, findings = read(body)

    assert [(f.severity, f.code, f.line, f.column) for f in findings] == [
        ("warning", "NOT_FOR_CPP", 2, column)
    ]


@pytest.mark.parametrize("body", ["a: {b: 'null'}", "a: {b: !!str ~}", "a: {b: ''}"])
def test_a_quoted_null_is_a_text(body: str) -> None:
    (setting,), findings = read(body)

    assert setting.value is not None
    assert findings == []


def test_a_null_says_nothing() -> None:
    (setting,), _ = read("a: {b: null}")

    assert setting.value is None


def test_a_name_twice_is_an_error_as_everywhere() -> None:
    _, (finding,) = read("a: {b: 1}, a.b: 2")

    assert (finding.severity, finding.code) == ("error", "DUPLICATE_KEY")


def test_an_alias_stands_for_what_it_names_wherever_the_anchor_is() -> None:
    (first, second), _ = read("a: {b: &x [1, 2], c: *x}")

    assert first.value is second.value


def test_an_alias_to_nothing_is_an_error() -> None:
    _, findings = read("a: {b: *x}")

    assert [finding.code for finding in findings] == ["ALIAS"]


def test_an_alias_to_what_it_is_part_of_is_an_error() -> None:
    _, findings = read("a: &x {b: *x}")

    assert [finding.code for finding in findings] == ["ALIAS"]


def test_a_small_file_does_not_expand_without_bound() -> None:
    levels = [f"a{n}: &a{n} {{x: *a{n - 1}, y: *a{n - 1}}}" for n in range(1, 60)]
    settings, findings = read(", ".join(["a0: &a0 {x: 1, y: 2}", *levels]))

    assert len(settings) == MAX_SETTINGS
    assert "TOO_LARGE" in [finding.code for finding in findings]


def test_aliases_do_not_make_a_tree_too_deep_for_who_reads_it() -> None:
    levels = [f"a{n}: &a{n} {{x: *a{n - 1}}}" for n in range(1, 2_000)]
    _, findings = read(", ".join(["a0: &a0 {x: 1}", *levels]))

    assert "TOO_DEEP" in [finding.code for finding in findings]


@pytest.mark.parametrize(
    ("keys", "is_in_one"),
    [
        (["n", "ros__parameters", "mode_settings"], True),
        (["n", "ros__parameters", "mode_settings.FAST", "requires"], True),
        (["left", "arm", "ros__parameters", "errors"], True),
        (["n", "ros__parameters", "modes", "FAST"], False),
        (["n", "ros__parameters", "modes.FAST", "ros__parameters", "errors"], False),
        (["n", "ros__parameters", "type"], False),
        (["n", "ros__parameters", ""], False),
        (["n", "ros__parameters"], False),
        (["mode_settings"], False),
    ],
)
def test_what_is_below_other_keys_of_a_part_is_in_an_extension(
    keys: list[str], is_in_one: bool
) -> None:
    assert is_in_extension(keys) is is_in_one
