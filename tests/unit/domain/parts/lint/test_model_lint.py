import pytest

from domain.parts.system_model import SmhModel
from tests.support.big_model import big_model
from tests.support.lint_models import guarded, lint_of, model_of, node, rule, system, told
from tests.support.models import actuation_model, nested_model


@pytest.mark.parametrize("model", [actuation_model(), nested_model(), big_model(100)])
def test_nothing_is_odd_about_a_model_that_says_what_is_meant(model: SmhModel) -> None:
    assert lint_of(model) == []


def test_all_subjects_are_looked_at() -> None:
    findings = told(
        system("s", rule("stay", "active", "n", "inactive", "active"), default={"n": "active"}),
        system("t", default={"n": "active"}, REST={"n": "inactive"}),
        node(default={"a": 1}, TWIN={"a": 1}, OTHER={"a": 2.0}, NEVER={"a": float("nan")}),
        node("task", default={"a": 1}),
        n={
            "OTHER": guarded("battery_level > 1 and battery_level < 1"),
            "TWIN": guarded("n.mode == TWIN"),
        },
    )

    assert [finding.code for finding in findings] == [
        "MODES_ALIKE",
        "TYPE_DIFFERS",
        "TYPE_DIFFERS",
        "NEVER_INFERRED",
        "RULE_CIRCLE",
        "CONFLICTING_SYSTEMS",
        "UNREACHABLE_MODE",
        "GUARD_NEVER_HOLDS",
        "RESERVED_WORD",
    ]


def test_a_model_without_conditions_needs_no_other_names() -> None:
    assert lint_of(model_of(node("task", default={"a": 1}))) == []
