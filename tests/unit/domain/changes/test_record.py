"""A change while it runs and after it ended."""

import pytest

from domain.actor import Actor
from domain.changes.plan import Action, NodeGoal, SetParameters
from domain.changes.record import Change, Pursuit, Step, StepTable
from domain.changes.settings import ChangeSettings
from domain.identifiers import ChangeId
from domain.inputs import ModeRequest
from domain.lifecycle import LifecycleState, Transition
from domain.plans.durations import Durations
from domain.plans.order import Order
from domain.snapshot import ChangeStatus, ChangeView, StepStatus, StepView
from domain.timebase import seconds
from tests.support.models import ACTUATION, ARM, BASE

C1 = ChangeId("c1")
GOAL = NodeGoal(LifecycleState.ACTIVE)
CONFIGURE, ACTIVATE = Transition.CONFIGURE, Transition.ACTIVATE
SET = SetParameters({"max_speed": 0.9})


def _pursuit(*actions: Action) -> Pursuit:
    pursuit = Pursuit(C1, BASE, GOAL)
    pursuit.plan(actions)
    return pursuit


def test_the_deadlines_of_the_brief_are_the_defaults() -> None:
    """10 s a transition, 2 s parameters."""
    settings = ChangeSettings()
    assert settings.transition_deadline == seconds(10)
    assert settings.parameters_deadline == seconds(2)


@pytest.mark.parametrize(
    ("action", "name"), [(CONFIGURE, "configure"), (SET, "set_parameters")], ids=["state", "set"]
)
def test_a_step_is_shown_with_its_action_its_times_and_its_end(action: Action, name: str) -> None:
    step = Step(C1, BASE, action)
    (before,) = StepTable([step], Order(), Durations())
    assert before == StepView(BASE, name, StepStatus.PENDING, None, None, None)  # type: ignore[arg-type]
    step.status, step.started_at = StepStatus.RUNNING, 5
    step.end(StepStatus.FAILED, 7, "refused")
    (after,) = StepTable([step], Order(), Durations())
    assert after == StepView(BASE, name, StepStatus.FAILED, 5, 7, "refused")  # type: ignore[arg-type]
    assert step.action_name == name


def test_steps_come_one_after_the_other() -> None:
    pursuit = _pursuit(CONFIGURE, SET, ACTIVATE)
    done = []
    while (step := pursuit.next_step()) is not None:
        done.append(step.action)
        step.end(StepStatus.SUCCEEDED, 1)
    assert done == [CONFIGURE, SET, ACTIVATE]


def test_the_same_plan_again_keeps_the_steps_that_wait() -> None:
    pursuit = _pursuit(CONFIGURE, ACTIVATE)
    before = list(pursuit.steps)
    pursuit.plan((CONFIGURE, ACTIVATE))
    assert all(one is other for one, other in zip(before, pursuit.steps, strict=True))


def test_another_plan_replaces_what_waits_and_keeps_what_was_done() -> None:
    pursuit = _pursuit(CONFIGURE, ACTIVATE)
    pursuit.steps[0].end(StepStatus.SUCCEEDED, 1)
    pursuit.plan((SET, ACTIVATE))
    assert [(step.action, step.status) for step in pursuit.steps] == [
        (CONFIGURE, StepStatus.SUCCEEDED),
        (SET, StepStatus.PENDING),
        (ACTIVATE, StepStatus.PENDING),
    ]
    assert {(step.change, step.node) for step in pursuit.steps} == {(C1, BASE)}


def test_steps_that_will_not_be_begun_end_and_others_stay() -> None:
    pursuit = _pursuit(CONFIGURE, SET, ACTIVATE)
    pursuit.steps[0].end(StepStatus.SUCCEEDED, 1)
    pursuit.steps[1].status = StepStatus.RUNNING
    pursuit.drop_pending(StepStatus.CANCELED, 9)
    assert [(step.status, step.ended_at, step.error) for step in pursuit.steps] == [
        (StepStatus.SUCCEEDED, 1, None),
        (StepStatus.RUNNING, None, None),
        (StepStatus.CANCELED, 9, None),
    ]


def _change() -> Change:
    request = ModeRequest(ACTUATION, "PERFORMANCE", Actor("alice"))
    return Change(C1, ACTUATION, request, {}, started_at=5, cause=3)


def test_a_change_is_shown_with_the_steps_of_all_nodes_in_their_order() -> None:
    change = _change()
    change.set_out({BASE: GOAL, ARM: GOAL})
    for node in (BASE, ARM):
        change.pursue(node).plan((CONFIGURE, ACTIVATE))
    view = change.view()
    assert [(step.node, step.action) for step in view.steps] == [
        (BASE, CONFIGURE),
        (BASE, ACTIVATE),
        (ARM, CONFIGURE),
        (ARM, ACTIVATE),
    ]


def test_a_table_of_steps_is_read_as_any_sequence() -> None:
    steps = [Step(C1, node, action) for node in (BASE, ARM) for action in (CONFIGURE, ACTIVATE)]
    table = StepTable(steps, Order(), Durations())
    assert (len(table), table[-1].node, table[1].action) == (4, ARM, ACTIVATE)
    assert [step.node for step in table[1:3]] == [BASE, ARM]
    assert table == tuple(table)
    assert table != tuple(table)[:3]
    with pytest.raises(IndexError):
        table[4]


def test_a_node_is_shown_in_its_place_whenever_its_turn_comes() -> None:
    change = _change()
    change.set_out({BASE: GOAL, ARM: GOAL})
    change.pursue(ARM).plan((CONFIGURE,))
    assert [step.node for step in change.view().steps] == [ARM]
    change.pursue(BASE).plan((CONFIGURE,))
    assert [step.node for step in change.view().steps] == [BASE, ARM]
    assert (change.open, change.node_count) == ({BASE, ARM}, 2)


def test_a_packed_change_is_shown_as_before() -> None:
    change = _change()
    change.pursuits[BASE] = _pursuit(CONFIGURE, ACTIVATE)
    before = change.view()
    change.pack()
    assert change.view() == before
    assert not change.pursuits


def test_a_change_that_ended_is_shown_with_its_status_its_reason_and_its_time() -> None:
    change = _change()
    change.status, change.reason, change.ended_at = ChangeStatus.FAILED, "arm is finalized", 9
    assert change.view() == ChangeView(
        C1, ACTUATION, change.request, ChangeStatus.FAILED, "arm is finalized", (), 5, 9, 3
    )


def test_reasons_are_told_apart_by_how_nodes_ended() -> None:
    change = _change()
    for node, outcome in ((BASE, StepStatus.FAILED), (ARM, StepStatus.TIMED_OUT)):
        change.pursuits[node] = Pursuit(C1, node, GOAL, outcome=outcome, error=f"{node} why")
    assert change.errors_of(StepStatus.FAILED) == ["drive_base why"]
    assert change.errors_of(StepStatus.TIMED_OUT) == ["manipulator why"]
    assert change.errors_of(StepStatus.SUCCEEDED) == []
