from collections.abc import Callable
from dataclasses import replace

from domain.changes.plan import goal_of
from domain.changes.schedule import Schedule, schedule_of
from domain.inputs import ChangeRequest, ModeRequest, ParametersRequest, TransitionRequest
from domain.lifecycle import LifecycleState, Transition
from domain.parts.mode_settings import OnFailure
from domain.parts.node_facts import NodeFacts
from domain.parts.system_model import SmhModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName
from domain.timebase import seconds
from tests.support.models import FAST, actuation_model
from tests.support.ordered_model import IN_A_ROW, NODES, ROBOT, ordered_model, settings


def _schedule(
    model: SmhModel, request: ChangeRequest, mode_of: Callable[[PartName], ModeName | None]
) -> Schedule:
    facts = {n: NodeFacts(LifecycleState.ACTIVE, reachable=True) for n in model.nodes}
    return schedule_of(model, request, goal_of(model, request, facts), mode_of)


def _nothing(_: PartName) -> None:
    return None


def test_a_change_without_settings_has_no_order_and_no_deadline() -> None:
    model = actuation_model()
    schedule = _schedule(model, ModeRequest(model.parts[0], "PERFORMANCE"), _nothing)
    assert not schedule.order.blocked
    assert (schedule.deadline, schedule.on_failure) == (None, OnFailure.CONTINUE)


def test_the_mode_that_is_entered_says_how() -> None:
    model = ordered_model(IN_A_ROW, OnFailure.STOP, 20)
    schedule = _schedule(model, ModeRequest(ROBOT, FAST), _nothing)
    assert [schedule.order.stage(node) for node in NODES] == [0, 1, 2, 3, 4]
    assert (schedule.deadline, schedule.on_failure) == (seconds(20), OnFailure.STOP)


def test_going_to_rest_takes_the_order_of_the_mode_that_is_left_in_reverse() -> None:
    model = ordered_model(IN_A_ROW)
    own = {ROBOT: {FAST: settings(IN_A_ROW), DEFAULT_MODE: settings({})}}
    model = replace(model, mode_settings=own)
    down = TransitionRequest(ROBOT, Transition.DEACTIVATE)
    of_fast = _schedule(model, down, lambda _: FAST).order
    of_default = _schedule(model, down, lambda _: DEFAULT_MODE).order
    assert [of_fast.stage(node) for node in NODES] == [4, 3, 2, 1, 0]
    assert not of_default.blocked


def test_a_change_of_parameters_has_no_order() -> None:
    model = ordered_model(IN_A_ROW, OnFailure.ROLLBACK, 20)
    schedule = _schedule(model, ParametersRequest(NODES[0], {"speed": 0.3}), _nothing)
    assert schedule.on_failure is OnFailure.CONTINUE
