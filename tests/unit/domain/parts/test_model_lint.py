from collections.abc import Mapping
from typing import TypeVar

import pytest

from domain.findings import Finding
from domain.parameters import Parameters
from domain.parts.model_lint import lint
from domain.parts.system_model import NodeModel, Rule, SmhModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from tests.support.big_model import big_model
from tests.support.models import actuation_model, nested_model

N = PartName("n")
T = TypeVar("T")


def node(**modes: Parameters) -> NodeModel:
    return NodeModel(N, _with_default(modes))


def system(name: str = "s", *rules: Rule, **modes: dict[str, str]) -> SystemModel:
    wanted: dict[str, Mapping[PartName, StateAndMode]] = {
        mode: {PartName(part): StateAndMode.parse(label) for part, label in wants.items()}
        for mode, wants in modes.items()
    }
    return SystemModel(PartName(name), _with_default(wanted), rules)


def rule(name: str, target: str, part: str, state: str, instead: str) -> Rule:
    parse = StateAndMode.parse
    return Rule(name, parse(target), (PartName(part), parse(state)), parse(instead))


def _with_default(modes: dict[str, T]) -> dict[ModeName, T]:
    return {DEFAULT_MODE if m == "default" else ModeName(m): value for m, value in modes.items()}


def told(*parts: NodeModel | SystemModel) -> list[Finding]:
    nodes = {part.name: part for part in parts if isinstance(part, NodeModel)}
    systems = {part.name: part for part in parts if isinstance(part, SystemModel)}
    return lint(SmhModel(nodes, systems))


def brief(findings: list[Finding]) -> list[tuple[str, tuple[str, ...]]]:
    assert {finding.severity for finding in findings} <= {"warning"}
    assert all(finding.part == finding.path[0] for finding in findings)
    return [(finding.code, finding.path) for finding in findings]


@pytest.mark.parametrize("model", [actuation_model(), nested_model(), big_model(100)])
def test_nothing_is_odd_about_a_model_that_says_what_is_meant(model: SmhModel) -> None:
    assert lint(model) == []


# --- modes that look alike ---


def test_two_modes_of_a_node_with_the_same_parameters_cannot_be_told_apart() -> None:
    # As in D4.8, where WEAK has the torque of the default mode.
    findings = told(node(default={"torque": 0.1}, WEAK={"torque": 0.1}, STRONG={"torque": 0.2}))

    assert brief(findings) == [("MODES_ALIKE", ("n", "modes", "WEAK"))]
    assert "WEAK is the same as __DEFAULT__" in findings[0].message


def test_parameters_of_different_types_tell_modes_apart() -> None:
    findings = told(node(default={"rate": 1}, FINE={"rate": 1.0}))

    assert "MODES_ALIKE" not in [finding.code for finding in findings]


def test_two_modes_of_a_system_that_want_the_same_cannot_be_told_apart() -> None:
    findings = told(
        system(default={"n": "active"}, SAME={"n": "active.__DEFAULT__"}, REST={"n": "inactive"}),
        node(default={"a": 1}),
    )

    assert brief(findings) == [("MODES_ALIKE", ("s", "modes", "SAME"))]


# --- parameters ---


def test_a_parameter_that_changes_its_type_is_told() -> None:
    findings = told(node(default={"speed": 0.5, "gain": 1}, FAST={"speed": 1, "gain": 2}))

    assert brief(findings) == [("TYPE_DIFFERS", ("n", "modes", "FAST", "speed"))]
    assert "speed is integer here and double in __DEFAULT__" in findings[0].message


@pytest.mark.parametrize("value", [(1.0, float("nan")), float("nan")])
def test_a_mode_with_a_value_that_is_never_found_equal_is_told_once(value: float) -> None:
    findings = told(node(default={"a": value, "b": 1}, X={"a": value, "b": 2}))

    assert brief(findings) == [("NEVER_INFERRED", ("n", "modes", "__DEFAULT__", "a"))]


def test_a_parameter_that_the_default_does_not_have_is_no_matter_of_taste() -> None:
    assert told(node(default={"a": 1}, X={"a": 2, "b": 3.0})) == []


# --- rules ---


def test_rules_that_lead_in_a_circle_are_told() -> None:
    # micro-ROS/system_modes issue #94: each of the rules undoes what the other one does.
    findings = told(
        system(
            "s",
            rule("give_up", "active", "n", "active.BAD", "active.CAREFUL"),
            rule("go_back", "active.CAREFUL", "n", "active", "active.__DEFAULT__"),
            default={"n": "active"},
            CAREFUL={"n": "active.BAD"},
        ),
        node(default={"a": 1}, BAD={"a": 2}),
    )

    assert brief(findings) == [("RULE_CIRCLE", ("s", "rules", "go_back"))]
    assert "active.__DEFAULT__ > active.CAREFUL > active.__DEFAULT__" in findings[0].message


def test_a_rule_that_leads_nowhere_else_is_a_circle_too() -> None:
    findings = told(
        system("s", rule("stay", "active", "n", "inactive", "active"), default={"n": "active"}),
        node(default={"a": 1}),
    )

    assert brief(findings) == [("RULE_CIRCLE", ("s", "rules", "stay"))]


def test_rules_that_lead_down_and_never_back_are_fine() -> None:
    findings = told(
        system(
            "s",
            rule("down", "active.HIGH", "n", "inactive", "active.LOW"),
            rule("further", "active.LOW", "n", "inactive", "active"),
            rule("straight", "active.HIGH", "n", "finalized", "active"),
            rule("off", "active", "n", "inactive", "inactive"),
            default={"n": "active"},
            LOW={"n": "active.LOW"},
            HIGH={"n": "active.HIGH"},
        ),
        node(default={"a": 1}, LOW={"a": 2}, HIGH={"a": 3}),
    )

    assert findings == []


def test_a_rule_that_gives_up_a_target_for_what_the_target_wants_undoes_the_request() -> None:
    findings = told(
        system(
            "s",
            rule("odd", "active.FAST", "n", "active.FAST", "inactive"),
            rule("idle", "inactive", "n", "inactive", "active"),
            default={"n": "active"},
            FAST={"n": "active.FAST"},
        ),
        node(default={"a": 1}, FAST={"a": 2}),
    )

    assert brief(findings) == [
        ("RULE_UNDOES_REQUEST", ("s", "rules", "odd")),
        ("RULE_UNDOES_REQUEST", ("s", "rules", "idle")),
    ]


# --- parts of several systems ---


def test_systems_that_can_want_different_things_of_a_shared_part_are_told_once() -> None:
    findings = told(
        system("drive", default={"n": "active"}, RACE={"n": "active.FAST"}),
        system("work", default={"n": "active"}, REST={"n": "inactive"}, AWAY={"n": "finalized"}),
        node(default={"a": 1}, FAST={"a": 2}),
    )

    assert brief(findings) == [("CONFLICTING_SYSTEMS", ("work", "modes", "REST", "n"))]
    assert "drive in __DEFAULT__ requires active.__DEFAULT__" in findings[0].message
    assert "work in REST requires inactive" in findings[0].message


def test_systems_that_always_want_the_same_of_a_shared_part_are_fine() -> None:
    assert (
        told(
            system("one", default={"n": "active"}),
            system("two", default={"n": "active.__DEFAULT__"}),
            node(default={"a": 1}),
        )
        == []
    )


# --- words ---


def test_what_is_told_of_modes_says_what_follows_from_it() -> None:
    (alike,) = told(node(default={"a": 1}, X={"a": 1}))
    (differs,) = told(node(default={"a": 0.5}, X={"a": 1}))
    (never,) = told(node(default={"a": 0.5}, X={"a": float("nan")}))

    assert alike.message == "n: X is the same as __DEFAULT__; inference cannot tell the two apart"
    assert differs.message == (
        "n in X: a is integer here and double in __DEFAULT__; "
        "a node accepts only one of these types"
    )
    assert never.message == (
        "n in X: a holds NaN, which never equals anything; "
        "the mode is never inferred from its parameters"
    )


def test_what_is_told_of_a_rule_that_undoes_a_request_names_both_sides() -> None:
    (undone,) = told(
        system(
            "s",
            rule("odd", "active.FAST", "n", "active.FAST", "inactive"),
            default={"n": "active"},
            FAST={"n": "active.FAST"},
        ),
        node(default={"a": 1}, FAST={"a": 2}),
    )

    assert undone.message == (
        "rule odd of s gives up active.FAST when n is active.FAST, "
        "which active.FAST itself requires"
    )


def test_each_of_several_circles_is_told() -> None:
    findings = told(
        system(
            "s",
            rule("stay", "active", "n", "inactive", "active"),
            rule("there", "active.A", "n", "finalized", "active.B"),
            rule("aside", "active.A", "n", "inactive", "inactive"),
            rule("back", "active.B", "n", "finalized", "active.A"),
            default={"n": "active"},
            A={"n": "active.A"},
            B={"n": "active.B"},
        ),
        node(default={"a": 1}, A={"a": 2}, B={"a": 3}),
    )

    assert brief(findings) == [
        ("RULE_CIRCLE", ("s", "rules", "stay")),
        ("RULE_CIRCLE", ("s", "rules", "back")),
    ]


def test_a_way_into_a_circle_is_no_part_of_it() -> None:
    findings = told(
        system(
            "s",
            rule("into", "active.HIGH", "n", "inactive", "active.LOW"),
            rule("down", "active.LOW", "n", "inactive", "active"),
            rule("up", "active", "n", "finalized", "active.LOW"),
            default={"n": "active"},
            LOW={"n": "active.LOW"},
            HIGH={"n": "active.HIGH"},
        ),
        node(default={"a": 1}, LOW={"a": 2}, HIGH={"a": 3}),
    )

    (circle,) = findings
    assert circle.message == (
        "rules of s form a cycle: active.LOW > active.__DEFAULT__ > active.LOW"
    )


def test_a_rule_for_a_target_without_wishes_undoes_nothing() -> None:
    findings = told(
        SystemModel(PartName("s"), {}, (rule("r", "active", "n", "active", "inactive"),)),
        node(default={"a": 1}),
    )

    assert findings == []
