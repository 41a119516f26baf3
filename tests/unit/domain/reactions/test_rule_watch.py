"""When a rule matches."""

import pytest

from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from domain.parts.system_model import NodeModel, Rule, SmhModel
from domain.reactions.rule_watch import RuleWatch
from domain.state_and_mode import ModeName, PartName, StateAndMode
from tests.support.models import ACTUATION, ARM, BASE, active, actuation_model, inactive

S = LifecycleState
LIDAR = PartName("lidar")


def model_with_lidar() -> SmhModel:
    """Return the robot of D4.8 and a node beside it, without modes."""
    model = actuation_model()
    return SmhModel({**model.nodes, LIDAR: NodeModel(LIDAR)}, model.systems)


def watch(
    if_target: StateAndMode,
    part: PartName,
    pair: StateAndMode,
    new: StateAndMode | None = None,
) -> RuleWatch:
    inference = ModeInference(model_with_lidar())
    rule = Rule("rule", if_target, (part, pair), new or active("MODERATE"))
    return RuleWatch(ACTUATION, rule, 0, inference)


def ask(rule: RuleWatch, target: StateAndMode) -> None:
    rule.inference.set_targets({ACTUATION: target})


def report(rule: RuleWatch, node: PartName, state: S, mode: str | None = None) -> None:
    named = None if mode is None else ModeName(mode)
    rule.inference.report(NodeReport(node, state, named, reachable=True))


def test_target_and_part_must_both_be_as_the_rule_says() -> None:
    rule = watch(active("PERFORMANCE"), ARM, inactive())
    report(rule, ARM, S.INACTIVE)
    assert not rule.matches(), "nothing is asked of the system"
    ask(rule, active("MODERATE"))
    assert not rule.matches()
    ask(rule, active("PERFORMANCE"))
    assert rule.matches()
    report(rule, ARM, S.ACTIVE, "STRONG")
    assert not rule.matches()


def test_a_part_that_is_where_the_target_wants_it_deviates_from_nothing() -> None:
    rule = watch(active(), ARM, inactive())
    ask(rule, active())
    report(rule, ARM, S.INACTIVE)
    report(rule, BASE, S.UNCONFIGURED)

    assert rule.has_cause()
    assert not rule.matches()


def test_of_a_part_that_the_target_says_nothing_about_the_system_has_to_deviate() -> None:
    rule = watch(active("PERFORMANCE"), LIDAR, inactive())
    ask(rule, active("PERFORMANCE"))
    report(rule, LIDAR, S.INACTIVE)
    report(rule, ARM, S.ACTIVE, "STRONG")
    report(rule, BASE, S.ACTIVE, "FAST")
    assert not rule.matches()
    report(rule, BASE, S.ACTIVE, "SLOW")
    assert rule.matches()


def test_active_without_a_mode_means_the_default_mode() -> None:
    rule = watch(active("PERFORMANCE"), BASE, StateAndMode(S.ACTIVE))
    report(rule, BASE, S.ACTIVE, "SLOW")
    assert not rule.has_cause()
    report(rule, BASE, S.ACTIVE, "__DEFAULT__")
    assert rule.has_cause()


def test_of_a_node_without_modes_any_active_one_is_meant() -> None:
    rule = watch(active("PERFORMANCE"), LIDAR, StateAndMode(S.ACTIVE))
    report(rule, LIDAR, S.ACTIVE)

    assert rule.has_cause()


def test_an_unknown_part_is_neither_a_cause_nor_a_cause_that_is_gone() -> None:
    rule = watch(active("PERFORMANCE"), ARM, StateAndMode(S.UNKNOWN))

    assert not rule.has_cause()
    assert not rule.is_cause_gone()


def test_a_cause_is_gone_when_the_part_is_known_to_be_otherwise() -> None:
    rule = watch(active("PERFORMANCE"), ARM, inactive())
    report(rule, ARM, S.INACTIVE)
    assert not rule.is_cause_gone()
    report(rule, ARM, S.ACTIVE, "WEAK")
    assert rule.is_cause_gone()


@pytest.mark.parametrize(
    ("new", "may_act"),
    [
        (active("MODERATE"), True),
        (inactive(), True),
        (active("PERFORMANCE"), False),
        (StateAndMode(S.ACTIVATING), False),
        (StateAndMode(S.UNKNOWN), False),
    ],
    ids=lambda value: value.label if isinstance(value, StateAndMode) else "",
)
def test_a_rule_acts_only_towards_another_target_in_which_a_system_can_rest(
    new: StateAndMode, may_act: bool
) -> None:
    assert watch(active("PERFORMANCE"), ARM, inactive(), new).may_act is may_act


def test_the_cause_is_told_in_words() -> None:
    assert watch(active(), BASE, active("SLOW")).reason == "drive_base is active.SLOW"
