from domain.parts.system_model import SystemModel
from domain.state_and_mode import PartName
from tests.support.lint_models import brief, node, rule, system, told


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


def test_a_rule_for_what_the_target_demands_further_down_undoes_the_request() -> None:
    findings = told(
        system(
            "top",
            rule("odd", "active.FAST", "n", "active.FAST", "inactive"),
            default={"s": "active"},
            FAST={"s": "active.FAST"},
        ),
        system("s", default={"n": "active"}, FAST={"n": "active.FAST"}),
        node(default={"a": 1}, FAST={"a": 2}),
    )

    assert brief(findings) == [("RULE_UNDOES_REQUEST", ("top", "rules", "odd"))]
