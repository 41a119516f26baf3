"""Whatever a robot looks like, its parts change in the declared order, and go back on a failure.

`make soak` plays 1,000 robots of each kind, `make test` 60.
"""

import os
from collections.abc import Iterable

import hypothesis.strategies as st
from hypothesis import given, settings

from domain.inputs import ModeRequest, TransitionRequest
from domain.lifecycle import Transition
from domain.parts.mode_settings import OnFailure
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault
from domain.snapshot import ChangeStatus, Rollback, StepView
from domain.state_and_mode import DEFAULT_MODE, PartName
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import FAST
from tests.support.random_plans import ROOT, node_times, planned_models, waits

EXAMPLES = 1_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 60
FAULTS = st.sampled_from([Fault.REFUSE, Fault.FAIL, Fault.ERROR, Fault.SILENT])


def _robot(model: SmhModel, data: st.DataObject) -> CoreRobot:
    robot = CoreRobot(model, nodes=data.draw(node_times(model)))
    robot.read(**GOOD)
    return robot


def _spans(robot: CoreRobot, change: str) -> dict[str, tuple[int, int]]:
    """Return the event ids with which each node began its first step and ended its last."""
    spans: dict[str, tuple[int, int]] = {}
    for recorded in robot.events:
        if not recorded.event.kind.startswith("change.step_"):
            continue
        data = recorded.event.data()
        if data["change"] == change:
            node = str(data["node"])
            first, _ = spans.get(node, (recorded.id, 0))
            spans[node] = (first, recorded.id)
    return spans


def _assert_in_order(robot: CoreRobot, change: str, *, is_reversed: bool = False) -> None:
    spans, below = _spans(robot, change), robot.model.nodes_below
    for later, earlier in waits(robot.model):
        first, then = (later, earlier) if is_reversed else (earlier, later)
        ends = [spans[node][1] for node in below(first) if node in spans]
        begins = [spans[node][0] for node in below(then) if node in spans]
        if ends and begins:
            assert max(ends) < min(begins), f"{then} began before {first} was done"


@settings(max_examples=EXAMPLES, deadline=None)
@given(planned_models(), st.data())
def test_parts_begin_in_the_declared_order_and_go_down_in_reverse(
    model: SmhModel, data: st.DataObject
) -> None:
    robot = _robot(model, data)
    up = robot.begin(ModeRequest(ROOT, FAST))
    robot.advance(60)
    assert robot.change(up).status is ChangeStatus.SUCCEEDED
    _assert_in_order(robot, up)
    down = robot.begin(TransitionRequest(ROOT, Transition.DEACTIVATE))
    robot.advance(60)
    assert robot.change(down).status is ChangeStatus.SUCCEEDED
    _assert_in_order(robot, down, is_reversed=True)


@settings(max_examples=EXAMPLES, deadline=None)
@given(planned_models(OnFailure.ROLLBACK), st.data())
def test_after_a_rollback_that_is_done_all_is_as_it_was(
    model: SmhModel, data: st.DataObject
) -> None:
    robot = _robot(model, data)
    if data.draw(st.booleans(), label="in a mode before"):
        robot.begin(ModeRequest(data.draw(st.sampled_from(model.parts)), DEFAULT_MODE))
        robot.advance(60)
    before = {name: (view.target, view.actual) for name, view in robot.core.parts().items()}
    node = data.draw(st.sampled_from(sorted(model.nodes)))
    robot.fault(node, data.draw(FAULTS))
    change = robot.begin(ModeRequest(ROOT, FAST))
    robot.advance(data.draw(st.sampled_from([0.0, 0.5, 2.0])))
    robot.fault(node, None)
    robot.advance(120)
    view = robot.change(change)
    assert view.status.is_final, "every change ends"
    after = {name: (view.target, view.actual) for name, view in robot.core.parts().items()}
    if view.rollback is Rollback.DONE:
        assert view.status is ChangeStatus.FAILED
        assert after == before
    elif view.rollback is None:
        assert view.status is ChangeStatus.SUCCEEDED
        assert {pair[1].state_and_mode.label for pair in after.values()} == {"active.FAST"}
    else:
        assert {n: pair[0] for n, pair in after.items()} == {n: p[0] for n, p in before.items()}


@settings(max_examples=EXAMPLES, deadline=None)
@given(planned_models(), st.data())
def test_a_dry_run_foresees_what_the_change_does(model: SmhModel, data: st.DataObject) -> None:
    robot = _robot(model, data)
    plan = robot.core.plan(ModeRequest(ROOT, FAST))
    change = robot.begin(ModeRequest(ROOT, FAST))
    robot.advance(60)
    steps = robot.change(change).steps

    for node in model.nodes:
        assert _of(node, plan.steps) == _of(node, steps)


def _of(node: PartName, steps: Iterable[StepView]) -> list[tuple[str, int, tuple[str, ...]]]:
    return [(str(step.action), step.stage, step.after) for step in steps if step.node == node]
