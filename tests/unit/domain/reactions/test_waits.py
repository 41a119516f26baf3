"""Conditions of rules that must last."""

from domain.parts.mode_inference import ModeInference
from domain.parts.system_model import Rule
from domain.reactions.rule_watch import RuleWatch
from domain.reactions.waits import Waits
from tests.support.models import ACTUATION, ARM, active, actuation_model, inactive

GRACE = 10
RULE = RuleWatch(
    ACTUATION,
    Rule("degrade", active("PERFORMANCE"), (ARM, inactive()), active()),
    0,
    ModeInference(actuation_model()),
)


def waiting(since: int = 5) -> Waits[RuleWatch]:
    waits: Waits[RuleWatch] = Waits()
    waits.note(RULE, since, GRACE, holds=True, record=lambda: 7)
    return waits


def test_a_wait_is_over_when_its_condition_has_lasted_and_not_before() -> None:
    waits = waiting()
    assert waits.wake_at() == 15
    waits.pass_time(14)
    assert waits.over() == []
    waits.pass_time(15)

    ((rule, wait),) = waits.over()
    assert (rule, wait.since, wait.cause) == (RULE, 5, 7)
    assert waits.wake_at() is None


def test_a_condition_that_goes_on_does_not_begin_anew() -> None:
    waits = waiting()
    waits.note(RULE, 9, GRACE, holds=True, record=lambda: 99)

    assert waits.wake_at() == 15


def test_a_condition_that_ceases_is_forgotten() -> None:
    waits = waiting()
    waits.note(RULE, 9, GRACE, holds=False, record=lambda: 99)
    waits.pass_time(100)

    assert (waits.wake_at(), waits.over()) == (None, [])


def test_a_wait_can_be_over_later() -> None:
    waits = waiting()
    waits.pass_time(15)
    waits.postpone(RULE, 40)
    assert (waits.over(), waits.wake_at()) == ([], 40)
    waits.pass_time(40)
    assert len(waits.over()) == 1


def test_nothing_follows_from_an_idle_wait() -> None:
    waits = waiting()
    waits.pass_time(15)
    ((_, wait),) = waits.over()
    wait.is_idle = True

    assert waits.over() == []


def test_a_wait_remembers_that_estop_was_active() -> None:
    waits = waiting()
    waits.stop()
    waits.pass_time(15)

    assert [wait.was_stopped for _, wait in waits.over()] == [True]


def test_a_rule_that_does_not_wait_needs_no_thought() -> None:
    waits: Waits[RuleWatch] = Waits()
    waits.end(RULE)

    assert waits.over() == []
