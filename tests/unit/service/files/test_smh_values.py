import pytest

from domain.lifecycle import LifecycleState
from domain.parts.system_model import Rule
from domain.state_and_mode import PartName, StateAndMode
from service.files.parameter_file import read_parameter_file
from service.files.smh_block import SmhBlock
from service.files.smh_values import fitted, read_part_name, read_rule, read_want
from service.files.yaml_tree import Scalar, read_tree

PLACE = Scalar(7, 3, "")


def block_of(text: str = "s: {ros__parameters: {type: system}}") -> SmhBlock:
    (source,) = read_parameter_file(read_tree(text).documents).nodes.values()
    return SmhBlock(source)


def told(block: SmhBlock) -> list[tuple[str, str]]:
    return [(finding.severity, finding.code) for finding in block.findings]


@pytest.mark.parametrize(
    ("text", "label"),
    [
        ("active", "active"),
        ("active.FAST", "active.FAST"),
        ("active.", "active"),
        ("inactive", "inactive"),
        ("unconfigured", "unconfigured"),
        ("finalized", "finalized"),
    ],
)
def test_a_want_is_a_state_and_perhaps_a_mode(text: str, label: str) -> None:
    block = block_of()
    want = read_want(block, "s in X: n", text, PLACE)

    assert want is not None
    assert want.label == label
    assert block.findings == []


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("ACTIVE", "'ACTIVE'; did you mean active?"),
        ("ACTIVE.FAST", "'ACTIVE'; did you mean active?"),
        ("actve", "'actve'; did you mean active?"),
        ("banana", "'banana'; known: active"),
        ("active.A.B", "'active.A'"),
        (True, "True; known: active"),
        (0.2, "0.2; known: active"),
        (("active",), "('active',)"),
    ],
)
def test_a_state_that_there_is_not_is_an_error_with_a_hint(value: object, words: str) -> None:
    block = block_of()

    assert read_want(block, "s in X: n", value, PLACE) is None  # type: ignore[arg-type]
    assert told(block) == [("error", "UNKNOWN_STATE")]
    assert words in block.findings[0].message
    assert (block.findings[0].line, block.findings[0].column) == (7, 3)


def test_a_mode_of_an_inactive_part_has_no_effect_and_is_told() -> None:
    block = block_of()

    want = read_want(block, "s in X: n", "inactive.FAST", PLACE)

    assert want == StateAndMode(LifecycleState.INACTIVE, None)
    assert told(block) == [("warning", "INERT_MODE")]


def test_a_state_in_which_nothing_rests_can_hardly_be_meant() -> None:
    block = block_of()

    assert read_want(block, "s in X: n", "activating", PLACE) is not None
    assert told(block) == [("warning", "TRANSITIONAL_STATE")]


def test_a_slash_before_a_name_is_dropped_and_told() -> None:
    block = block_of()

    assert read_part_name(block, "s in X", "/left/arm", PLACE) == "left/arm"
    assert told(block) == [("warning", "LEADING_SLASH")]


@pytest.mark.parametrize(
    ("mode", "part", "expected"),
    [
        (None, "with", "active.__DEFAULT__"),
        ("__DEFAULT__", "with", "active.__DEFAULT__"),
        ("FAST", "with", "active.FAST"),
        (None, "without", "active"),
        ("__DEFAULT__", "without", "active"),
        ("FAST", "without", "active.FAST"),
    ],
)
def test_active_means_the_default_mode_where_there_are_modes(
    mode: str | None, part: str, expected: str
) -> None:
    pair = StateAndMode(LifecycleState.ACTIVE, mode)  # type: ignore[arg-type]

    assert fitted(pair, PartName(part), {PartName("with")}).label == expected


def rule(text: str) -> tuple[SmhBlock, Rule | None]:
    block = block_of(f"s: {{ros__parameters: {{type: system, rules: {{r: {text}}}}}}}")
    return block, read_rule(block, "r", {PartName("s"), PartName("arm")})


def test_a_rule_says_what_to_pursue_instead_while_a_part_is_in_a_state() -> None:
    block, read = rule("{if_target: active.A.B, if_part: [arm, active], new_target: active}")

    assert block.findings == []
    assert read is not None
    assert read.name == "r"
    assert read.if_target.label == "active.A.B", "rules are cut at the first dot, as in C++"
    assert (read.if_part[0], read.if_part[1].label) == ("arm", "active.__DEFAULT__")
    assert read.new_target.label == "active.__DEFAULT__"


@pytest.mark.parametrize(
    ("text", "findings"),
    [
        pytest.param(
            "{if_target: active.X}", [("error", "INCOMPLETE_RULE")], id="C++ never follows it"
        ),
        pytest.param(
            "{if_target: active, if_part: [arm, inactive], new_target: inactive, when: now}",
            [("error", "UNKNOWN_RULE_KEY")],
            id="a key too many",
        ),
        pytest.param(
            "{if_target: active, if_part: arm, new_target: inactive}",
            [("error", "INVALID_RULE")],
            id="a part without a state",
        ),
        pytest.param(
            "{if_target: active, if_part: [arm], new_target: inactive}",
            [("error", "INVALID_RULE")],
            id="one item, on which C++ crashes",
        ),
        pytest.param(
            "{if_target: active, if_part: [arm, inactive, FAST], new_target: inactive}",
            [("warning", "INVALID_RULE")],
            id="items that C++ ignores",
        ),
        pytest.param(
            "{if_target: on, if_part: [arm, off], new_target: sleepy}",
            [("error", "UNKNOWN_STATE"), ("error", "UNKNOWN_STATE")],
            id="no states at all",
        ),
        pytest.param(
            "{if_part: nd}",
            [("error", "INCOMPLETE_RULE"), ("error", "INVALID_RULE")],
            id="several faults at once",
        ),
    ],
)
def test_what_is_odd_or_wrong_in_a_rule_is_told(text: str, findings: list[tuple[str, str]]) -> None:
    block, _ = rule(text)

    assert told(block) == findings
