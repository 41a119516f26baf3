"""Whether a report ends the step that a node is at."""

import pytest

from domain.changes.plan import Action, SetParameters
from domain.changes.record import Step
from domain.changes.step_judgement import Verdict, judge_report
from domain.identifiers import ChangeId
from domain.inputs import NodeReport
from domain.lifecycle import TRANSITIONS, LifecycleState, Transition, TransitionRule
from domain.parameters import ParameterValue
from domain.parts.node_facts import NodeFacts
from domain.snapshot import StepStatus
from domain.state_and_mode import ModeName
from tests.support.models import BASE

S, T = LifecycleState, Transition
DONE = Verdict(StepStatus.SUCCEEDED)


def _step(action: Action, start: LifecycleState = S.INACTIVE, *, asked: bool = False) -> Step:
    return Step(
        ChangeId("c1"),
        BASE,
        action,
        StepStatus.RUNNING,
        started_at=0,
        start_state=start,
        facts_asked=asked,
    )


def _judge(step: Step, state: LifecycleState | None = None) -> Verdict | None:
    return judge_report(step, NodeReport(BASE, state=state), NodeFacts(state=state))


# --- transitions ---------------------------------------------------------------------------------


@pytest.mark.parametrize("rule", TRANSITIONS, ids=lambda rule: f"{rule.start}-{rule.transition}")
def test_a_transition_is_done_when_the_node_is_where_the_table_says(rule: TransitionRule) -> None:
    step = _step(rule.transition, rule.start)
    assert _judge(step, rule.via) is None
    assert _judge(step, rule.success) == DONE


def test_a_node_that_is_there_without_having_been_seen_on_the_way_is_there() -> None:
    assert _judge(_step(T.ACTIVATE), S.ACTIVE) == DONE


def test_a_report_from_before_the_node_began_ends_nothing() -> None:
    assert _judge(_step(T.ACTIVATE), S.INACTIVE) is None


def test_a_node_that_falls_back_from_the_way_has_failed() -> None:
    """The callback reported failure: ROS 2 design, "Managed nodes"."""
    step = _step(T.ACTIVATE)
    _judge(step, S.ACTIVATING)
    assert _judge(step, S.INACTIVE) == Verdict(StepStatus.FAILED, "the node went back to inactive")


def test_an_error_in_the_callback_is_a_failure() -> None:
    verdict = _judge(_step(T.ACTIVATE), S.ERROR_PROCESSING)
    assert verdict == Verdict(StepStatus.FAILED, "the node ran into an error (errorprocessing)")


@pytest.mark.parametrize("state", [S.UNCONFIGURED, S.FINALIZED, S.CLEANING_UP, S.SHUTTING_DOWN])
def test_a_node_that_somebody_else_took_elsewhere_has_failed(state: LifecycleState) -> None:
    verdict = _judge(_step(T.ACTIVATE), state)
    assert verdict == Verdict(StepStatus.FAILED, f"the node is {state} instead of active")


@pytest.mark.parametrize("state", [S.INACTIVE, S.ACTIVATING])
def test_a_node_that_is_not_there_when_asked_at_the_deadline_is_late(
    state: LifecycleState,
) -> None:
    verdict = _judge(_step(T.ACTIVATE, asked=True), state)
    assert verdict == Verdict(StepStatus.TIMED_OUT, f"the node is still {state}")


def test_a_node_that_is_there_when_asked_at_the_deadline_is_done() -> None:
    assert _judge(_step(T.ACTIVATE, asked=True), S.ACTIVE) == DONE


def test_a_report_that_says_no_state_ends_no_transition_even_at_the_deadline() -> None:
    assert _judge(_step(T.ACTIVATE, asked=True)) is None


# --- parameters ----------------------------------------------------------------------------------

WANTED: dict[str, ParameterValue] = {"max_speed": 0.9, "controller": "MPC"}


def _judge_set(
    known: dict[str, ParameterValue], *, asked: bool = False, told: bool = True
) -> Verdict | None:
    report = NodeReport(BASE, parameters=known if told else None)
    return judge_report(
        _step(SetParameters(WANTED), asked=asked), report, NodeFacts(parameters=known)
    )


def test_parameters_are_set_when_all_of_them_are_reported() -> None:
    assert _judge_set({**WANTED, "gain": 1}) == DONE


@pytest.mark.parametrize(
    "known",
    [
        {"max_speed": 0.9},
        {"max_speed": 0.9, "controller": "PID"},
        {"max_speed": 1, "controller": "MPC"},
    ],
    ids=str,
)
def test_parameters_of_which_one_is_missing_are_not_set_yet(
    known: dict[str, ParameterValue],
) -> None:
    assert _judge_set(known) is None


def test_values_of_another_type_are_other_values() -> None:
    step = _step(SetParameters({"a": 1.0}))
    report = NodeReport(BASE, parameters={"a": 1})
    assert judge_report(step, report, NodeFacts(parameters={"a": 1})) is None


def test_a_report_without_parameters_ends_no_set() -> None:
    assert _judge_set(WANTED, told=False, asked=True) is None


def test_parameters_that_are_not_there_when_asked_at_the_deadline_are_named() -> None:
    verdict = _judge_set({"max_speed": 0.2}, asked=True)
    assert verdict == Verdict(StepStatus.TIMED_OUT, "not applied: max_speed, controller")


def test_parameters_that_are_there_when_asked_at_the_deadline_are_set() -> None:
    assert _judge_set(WANTED, asked=True) == DONE


def test_a_mode_that_was_not_taken_over_is_told() -> None:
    action = SetParameters({"max_speed": 0.9}, ModeName("FAST"))
    report = NodeReport(BASE, mode=ModeName("SLOW"))
    facts = NodeFacts(S.ACTIVE, ModeName("SLOW"), parameters={"max_speed": 0.2})
    verdict = judge_report(_step(action, asked=True), report, facts)
    words = "not applied: max_speed, mode SLOW"
    assert verdict == Verdict(StepStatus.TIMED_OUT, words)
