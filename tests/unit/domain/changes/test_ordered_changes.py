"""Changes whose nodes wait for each other, stop, or go back, as an operator sees them."""

from dataclasses import replace

import pytest

from domain.identifiers import ChangeId
from domain.inputs import CancelRequest, Input, ModeRequest, TransitionRequest
from domain.lifecycle import Transition
from domain.outbox import Outputs
from domain.parts.mode_settings import OnFailure
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.snapshot import ChangeStatus, Rollback
from domain.state_and_mode import DEFAULT_MODE
from domain.timebase import to_seconds
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.kept_values import KeptValues
from tests.support.models import FAST, active
from tests.support.ordered_model import IN_A_ROW, NODES, ROBOT, ordered_model

ONE_SECOND = NodeSettings(configure=0, activate=10**9, deactivate=10**9, set_parameters=0)
ENTER_FAST = ModeRequest(ROBOT, FAST)


def _robot(
    after: dict[str, list[str]] | None = None,
    on_failure: OnFailure = OnFailure.CONTINUE,
    deadline_s: float | None = None,
    node: NodeSettings = ONE_SECOND,
) -> CoreRobot:
    """Return a robot of five nodes, each of which needs one second; they are inactive."""
    model = ordered_model(IN_A_ROW if after is None else after, on_failure, deadline_s)
    robot = CoreRobot(model, nodes=dict.fromkeys(NODES, node))
    robot.read(**GOOD)
    robot.begin(TransitionRequest(ROBOT, Transition.CONFIGURE))
    robot.advance(0)
    return robot


def _took(robot: CoreRobot, change: ChangeId) -> float:
    view = robot.change(change)
    assert view.status is ChangeStatus.SUCCEEDED
    assert view.ended_at is not None
    return to_seconds(view.ended_at - view.started_at)


def _activated(robot: CoreRobot) -> list[str]:
    """Return the nodes that were asked to activate, in that order."""
    started = robot.happened("change.step_started")
    return [event["node"] for event in started if event["action"] == "activate"]


@pytest.mark.parametrize(
    ("after", "takes_s"),
    [
        (IN_A_ROW, 5),
        ({}, 1),
        ({"n2": ["n1"], "n3": ["n1"], "n4": ["n2", "n3"], "n5": ["n1"]}, 3),
    ],
    ids=["sequential", "simultaneous", "staged"],
)
def test_five_nodes_of_one_second_take_as_long_as_their_order_says(
    after: dict[str, list[str]], takes_s: float
) -> None:
    robot = _robot(after)
    change = robot.begin(ENTER_FAST)
    robot.advance(6)
    assert _took(robot, change) == takes_s


def test_going_down_the_last_goes_first() -> None:
    robot = _robot()
    robot.begin(ENTER_FAST)
    robot.advance(6)
    change = robot.begin(TransitionRequest(ROBOT, Transition.DEACTIVATE))
    robot.advance(6)
    assert _took(robot, change) == 5
    started = robot.happened("change.step_started")
    down = [event["node"] for event in started if event["action"] == "deactivate"]
    assert down == ["n5", "n4", "n3", "n2", "n1"]


def test_nodes_that_wait_are_shown_with_what_they_wait_for() -> None:
    robot = _robot()
    change = robot.begin(ENTER_FAST)
    robot.advance(1.5)
    view = robot.change(change)
    steps = [step for step in view.steps if step.action == "activate"]
    assert [(step.node, step.stage, step.after, str(step.status)) for step in steps] == [
        ("n1", 0, (), "succeeded"),
        ("n2", 1, ("n1",), "running"),
        ("n3", 2, ("n2",), "pending"),
        ("n4", 3, ("n3",), "pending"),
        ("n5", 4, ("n4",), "pending"),
    ]
    assert view.stage == 1


def test_a_dry_run_tells_how_long_all_of_it_takes_once_that_is_known() -> None:
    robot = _robot({"n2": ["n1"], "n3": ["n2"]})
    assert robot.core.plan(ENTER_FAST).expected is None
    robot.begin(ENTER_FAST)
    robot.advance(6)
    robot.begin(TransitionRequest(ROBOT, Transition.DEACTIVATE))
    robot.advance(6)
    plan = robot.core.plan(ModeRequest(ROBOT, FAST))
    assert plan.stages == 3
    assert plan.expected == 3 * 10**9


# --- failures ------------------------------------------------------------------------------------


def test_by_default_the_others_go_on_after_a_failure() -> None:
    robot = _robot()
    robot.fault("n2", Fault.REFUSE)
    change = robot.begin(ENTER_FAST)
    robot.advance(6)
    assert robot.change(change).status is ChangeStatus.FAILED
    assert [robot.actual(node) for node in NODES] == ["active.FAST", "inactive"] + 3 * [
        "active.FAST"
    ]


def test_stop_begins_no_further_step_and_lets_those_in_flight_arrive() -> None:
    slowly_set = replace(ONE_SECOND, set_parameters=10**9)
    robot = _robot({"n4": ["n3"], "n5": ["n4"]}, OnFailure.STOP, node=slowly_set)
    robot.fault("n3", Fault.REFUSE)
    change = robot.begin(ENTER_FAST)
    robot.advance(6)
    assert robot.change(change).status is ChangeStatus.FAILED
    done = [str(s.status) for s in robot.change(change).steps if s.node == "n1"]
    assert done == ["succeeded", "canceled"], "the parameters are set, the activation never begins"
    assert [step.status for step in robot.change(change).steps if step.node == "n5"] == [
        "canceled",
        "canceled",
    ]
    assert _activated(robot) == []


def test_after_a_rollback_the_parts_are_where_they_were() -> None:
    robot = _robot(on_failure=OnFailure.ROLLBACK)
    before = robot.core.parts()
    robot.fault("n3", Fault.ERROR)
    change = robot.begin(ENTER_FAST)
    robot.advance(2.5)
    assert robot.change(change).status is ChangeStatus.RUNNING
    robot.advance(0.7)
    robot.fault("n3", None)
    robot.advance(10)
    view = robot.change(change)
    assert (view.status, view.rollback) == (ChangeStatus.FAILED, Rollback.DONE)
    after = robot.core.parts()
    assert {n: p.target for n, p in after.items()} == {n: p.target for n, p in before.items()}
    assert {n: p.actual for n, p in after.items()} == {n: p.actual for n, p in before.items()}


def test_nodes_go_back_in_reverse_order_and_such_steps_say_so() -> None:
    robot = _robot(on_failure=OnFailure.ROLLBACK)
    robot.fault("n3", Fault.REFUSE)
    change = robot.begin(ENTER_FAST)
    robot.advance(10)
    back = [(s.node, str(s.action), s.stage) for s in robot.change(change).steps if s.rollback]
    deactivated = [entry for entry in back if entry[1] == "deactivate"]
    assert deactivated == [("n1", "deactivate", 2), ("n2", "deactivate", 1)]
    started = robot.happened("change.step_started")
    down = [event["node"] for event in started if event["action"] == "deactivate"]
    assert down == ["n2", "n1"]


def test_a_rollback_that_fails_leaves_the_change_failed_and_incomplete() -> None:
    robot = _robot(on_failure=OnFailure.ROLLBACK)
    robot.fault("n3", Fault.REFUSE)
    change = robot.begin(ENTER_FAST)
    robot.advance(1.5)
    robot.fault("n1", Fault.REFUSE)
    robot.advance(10)
    view = robot.change(change)
    assert (view.status, view.rollback) == (ChangeStatus.FAILED, Rollback.INCOMPLETE)
    assert "n1" in (view.reason or "")
    assert robot.actual("n2") == "inactive"
    assert robot.actual("n1") == "active.FAST"


def test_estop_ends_a_rollback_that_would_activate() -> None:
    robot = _robot(on_failure=OnFailure.ROLLBACK)
    robot.begin(ENTER_FAST)
    robot.advance(6)
    robot.fault("n1", Fault.REFUSE)
    change = robot.begin(TransitionRequest(ROBOT, Transition.DEACTIVATE))
    robot.advance(2.5)
    robot.read(estop=True)
    robot.advance(10)
    view = robot.change(change)
    assert (view.status, view.rollback) == (ChangeStatus.FAILED, Rollback.INCOMPLETE)
    assert robot.actual("n5") == "inactive"


def test_a_cancel_ends_a_rollback_half_way() -> None:
    robot = _robot(on_failure=OnFailure.ROLLBACK)
    robot.fault("n3", Fault.REFUSE)
    change = robot.begin(ENTER_FAST)
    robot.advance(2.5)
    robot.give(CancelRequest(change))
    view = robot.change(change)
    assert (view.status, view.rollback) == (ChangeStatus.FAILED, Rollback.INCOMPLETE)
    robot.advance(10)
    assert robot.actual("n1") == "active.FAST"


def test_a_newer_request_ends_a_rollback_and_reaches_its_goal() -> None:
    robot = _robot(on_failure=OnFailure.ROLLBACK)
    robot.fault("n3", Fault.REFUSE)
    change = robot.begin(ENTER_FAST)
    robot.advance(2.5)
    robot.fault("n3", None)
    newer = robot.begin(ENTER_FAST)
    view = robot.change(change)
    assert (view.status, view.rollback) == (ChangeStatus.FAILED, Rollback.INCOMPLETE)
    robot.advance(20)
    assert robot.change(newer).status is ChangeStatus.SUCCEEDED


def test_of_a_superseded_change_no_later_stage_begins() -> None:
    robot = _robot()
    change = robot.begin(ENTER_FAST)
    robot.advance(0.5)
    newer = robot.begin(ModeRequest(NODES[4], FAST))
    robot.advance(10)
    assert robot.change(change).status is ChangeStatus.SUPERSEDED
    assert robot.change(newer).status is ChangeStatus.SUCCEEDED
    assert [robot.actual(node) for node in NODES[:4]] == ["active.FAST"] + 3 * ["inactive"]
    waited = {str(step.status) for step in robot.change(change).steps if step.stage in (1, 2, 3)}
    assert waited == {"superseded"}, "no step looks as if it were still to come"


def test_a_canceled_change_leaves_those_that_wait() -> None:
    robot = _robot()
    change = robot.begin(ENTER_FAST)
    robot.advance(0.5)
    robot.give(CancelRequest(change))
    robot.advance(10)
    assert robot.change(change).status is ChangeStatus.CANCELED
    assert _activated(robot) == ["n1"]
    assert {str(step.status) for step in robot.change(change).steps} == {"succeeded", "canceled"}


# --- the deadline of the whole -------------------------------------------------------------------


def test_a_change_that_is_not_done_by_its_deadline_times_out_and_begins_nothing_more() -> None:
    robot = _robot(deadline_s=2.5)
    change = robot.begin(ENTER_FAST)
    view = robot.change(change)
    assert view.deadline_at == view.started_at + 2_500_000_000
    robot.advance(10)
    view = robot.change(change)
    assert view.status is ChangeStatus.TIMED_OUT
    assert view.reason == "not done within 2.5 s: n3; n4; n5"
    assert [robot.actual(node) for node in NODES] == 3 * ["active.FAST"] + 2 * ["inactive"]


def test_at_its_deadline_a_change_goes_back_if_it_is_to_on_a_failure() -> None:
    robot = _robot(on_failure=OnFailure.ROLLBACK, deadline_s=2.5)
    change = robot.begin(ENTER_FAST)
    robot.advance(20)
    view = robot.change(change)
    assert (view.status, view.rollback) == (ChangeStatus.TIMED_OUT, Rollback.DONE)
    assert {robot.actual(node) for node in NODES} == {"inactive"}


class _KeepingRobot(CoreRobot):
    """Keeps what survives a restart."""

    def __init__(self, model: SmhModel) -> None:
        self.kept = KeptValues()
        super().__init__(model, nodes=dict.fromkeys(NODES, ONE_SECOND))

    def give(self, given: Input) -> Outputs:
        """Hand in one input."""
        return self.kept.take(super().give(given))


def test_after_a_rollback_the_targets_before_it_are_those_that_survive_a_restart() -> None:
    model = ordered_model(IN_A_ROW, OnFailure.ROLLBACK)
    robot = _KeepingRobot(model)
    robot.read(**GOOD)
    robot.begin(ModeRequest(NODES[0], DEFAULT_MODE))
    robot.advance(3)
    robot.fault("n3", Fault.REFUSE)
    robot.begin(ENTER_FAST)
    robot.advance(20)
    restarted = CoreRobot(model)
    restarted.give(robot.kept.restored())
    targets = {name: view.target for name, view in restarted.core.parts().items()}
    assert targets == {name: view.target for name, view in robot.core.parts().items()}
    assert targets[NODES[0]] == active()
    assert targets[ROBOT] is None
