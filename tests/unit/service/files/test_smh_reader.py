import pytest

from domain.findings import Finding
from domain.lifecycle import LifecycleState
from domain.state_and_mode import DEFAULT_MODE, PartName, StateAndMode
from service.files.parameter_file import read_parameter_file
from service.files.smh_reader import SmhParts, read_parts
from service.files.source_text import SourceText
from service.files.yaml_tree import read_tree

NODES = """
a:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {speed: 0.1, gain: 1}}
      FAST: {ros__parameters: {speed: 0.9}}
bare:
  ros__parameters:
    type: node
"""
NODE_LINES = NODES.count("\n")


def read(text: str) -> SmhParts:
    nodes = read_parameter_file(read_tree(text).documents).nodes
    return read_parts(nodes, SourceText(text))


def system(*lines: str) -> SmhParts:
    head = "s:\n  ros__parameters:\n    type: system\n"
    return read(NODES + head + "".join(f"    {line}\n" for line in lines))


def told(findings: list[Finding]) -> list[tuple[str, str, int]]:
    """Return severity, code and the line of the system, its name being in line 1."""
    return [(f.severity, f.code, (f.line or 0) - NODE_LINES) for f in findings]


def test_a_mode_of_a_node_takes_over_what_it_does_not_set() -> None:
    node = read(NODES).nodes[PartName("a")]

    assert node.modes == {
        "__DEFAULT__": {"speed": 0.1, "gain": 1},
        "FAST": {"speed": 0.9, "gain": 1},
    }


def test_a_mode_of_a_system_takes_over_what_it_does_not_say() -> None:
    parts = system(
        "modes:", "  __DEFAULT__: {bare: inactive, a: active}", "  FAST: {a: active.FAST}"
    )

    modes = parts.systems[PartName("s")].modes
    assert {mode: {p: w.label for p, w in wants.items()} for mode, wants in modes.items()} == {
        "__DEFAULT__": {"bare": "inactive", "a": "active.__DEFAULT__"},
        "FAST": {"bare": "inactive", "a": "active.FAST"},
    }
    assert list(modes[DEFAULT_MODE]) == ["bare", "a"]


def test_the_default_mode_may_come_last() -> None:
    parts = system(
        "modes:", "  FAST: {a: active.FAST}", "  __DEFAULT__: {bare: inactive, a: active}"
    )

    assert parts.findings == []
    assert list(parts.systems[PartName("s")].modes) == ["FAST", "__DEFAULT__"]
    assert "bare" in parts.systems[PartName("s")].modes[DEFAULT_MODE]


@pytest.mark.parametrize("want", ["active", "active.__DEFAULT__"])
def test_a_part_without_modes_is_wanted_active_and_no_more(want: str) -> None:
    parts = system(f"modes: {{__DEFAULT__: {{bare: {want}}}}}")

    wanted = parts.systems[PartName("s")].modes[DEFAULT_MODE]
    assert wanted == {"bare": StateAndMode(LifecycleState.ACTIVE, None)}


def test_a_mode_may_be_written_with_dots() -> None:
    parts = read("a: {ros__parameters: {type: node, modes.__DEFAULT__.ros__parameters.x.y: 1}}")

    assert parts.findings == []
    assert parts.nodes[PartName("a")].modes == {"__DEFAULT__": {"x.y": 1}}


def test_a_system_without_modes_is_there_and_consists_of_nothing() -> None:
    parts = system()

    assert parts.systems[PartName("s")].parts == ()
    assert told(parts.findings) == [("warning", "NO_PARTS", 1)]


@pytest.mark.parametrize("names", ["[a, bare]", "a bare", "[/bare, a]", "a, bare"])
def test_a_list_of_parts_in_any_order_and_form_is_fine(names: str) -> None:
    parts = system(f"parts: {names}", "modes: {__DEFAULT__: {bare: inactive, a: active}}")

    assert parts.findings == []


@pytest.mark.parametrize(
    ("lines", "finding"),
    [
        pytest.param(
            ("parts: [a, c]", "modes: {__DEFAULT__: {a: active}}"),
            ("warning", "PARTS_DIFFER", 4),
            id="a list of parts that differs",
        ),
        pytest.param(
            ("modes: {__DEFAULT__: {a: active}, X: {bare: active}}",),
            ("warning", "PART_NOT_IN_DEFAULT", 4),
            id="a mode that names a part which the default does not",
        ),
        pytest.param(
            ("modes: {__DEFAULT__: {/a: active}}",),
            ("warning", "LEADING_SLASH", 4),
            id="a slash, with which C++ finds no part",
        ),
        pytest.param(
            ("modes:", "  __DEFAULT__:", "    a: active", "    /a: active"),
            ("error", "DUPLICATE_KEY", 7),
            id="a part twice",
        ),
        pytest.param(
            ("modes: {__DEFAULT__: {a: active}, X.Y: {a: active}}",),
            ("error", "DOTTED_NAME", 4),
            id="a mode with a dot, which C++ cuts off",
        ),
        pytest.param(
            ("modes: {__DEFAULT__: {left: {a: active}}}",),
            ("error", "DOTTED_NAME", 4),
            id="a namespace as a map in a mode",
        ),
        pytest.param(
            ("modes: {__DEFAULT__: {ros__parameters: {a: 1}}}",),
            ("error", "PARAMETERS_OF_A_SYSTEM", 4),
            id="a system with parameters",
        ),
    ],
)
def test_what_is_odd_or_wrong_in_a_system_is_told(
    lines: tuple[str, ...], finding: tuple[str, str, int]
) -> None:
    findings = [f for f in system(*lines).findings if f.code != "LEADING_SLASH"]

    assert told(findings or system(*lines).findings) == [finding]


@pytest.mark.parametrize(
    ("body", "finding"),
    [
        pytest.param(
            "modes: {__DEFAULT__: {ros__parameters: {a: 1}}, X: {ros__parameters: {b: 1}}}",
            ("error", "PARAMETER_NOT_IN_DEFAULT"),
            id="a parameter that the default does not have",
        ),
        pytest.param(
            "modes: {__DEFAULT__: {a: 0.2}}",
            ("error", "MISSING_ROS_PARAMETERS"),
            id="parameters that C++ reads as states of parts",
        ),
        pytest.param(
            "modes: {__DEFAULT__: {ros__parameters: {a: 1}}, X.Y: {ros__parameters: {a: 1}}}",
            ("error", "DOTTED_NAME"),
            id="a mode with a dot",
        ),
        pytest.param(
            "rules: {r: {if_target: active}}",
            ("warning", "RULES_OF_A_NODE"),
            id="rules that nothing follows",
        ),
    ],
)
def test_what_is_odd_or_wrong_in_a_node_is_told(body: str, finding: tuple[str, str]) -> None:
    parts = read(f"n: {{ros__parameters: {{type: node, {body}}}}}")

    assert [(f.severity, f.code) for f in parts.findings] == [finding]


def test_modes_that_would_unfold_to_millions_of_lines_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("service.files.smh_reader.MAX_LINES", 4)

    parts = system("modes: {__DEFAULT__: {a: active}, X: {a: active.FAST}}")

    assert ("error", "TOO_LARGE", 1) in told(parts.findings)
    assert parts.nodes[PartName("a")].modes, "what is small enough is read"
