"""A change of very many nodes is started in portions, so that no turn takes long."""

import pytest

from domain.actor import Actor
from domain.changes.changes import MAX_IN_FLIGHT, STARTS_AT_ONCE
from domain.commands import AskParameters, AskTransition
from domain.events.changes import StepStarted
from domain.identifiers import ChangeId
from domain.inputs import (
    CancelRequest,
    ModeRequest,
    NodeReport,
    Reading,
    Readings,
    TimePassed,
)
from domain.lifecycle import LifecycleState
from domain.outbox import Outputs
from domain.snapshot import ChangeStatus, StepStatus
from domain.state_and_mode import PartName
from tests.support.big_model import FAST, SLOW, big_model
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD

NODES = 10 * STARTS_AT_ONCE
PILOT = Actor("pilot")


@pytest.fixture
def robot() -> CoreRobot:
    robot = CoreRobot(big_model(NODES))
    robot.read(**GOOD)
    return robot


def asked(outputs: Outputs) -> int:
    """Return how many nodes are asked for something."""
    return sum(isinstance(c, AskTransition | AskParameters) for c in outputs.commands)


def request(robot: CoreRobot, mode: str) -> Outputs:
    """Ask the core for a mode of the whole robot, and let nothing follow yet."""
    return robot.give(ModeRequest(robot.model.parts[0], mode, PILOT))


def test_each_turn_starts_a_bounded_number_of_nodes(robot: CoreRobot) -> None:
    turns = [asked(request(robot, FAST))]
    while robot.core.wake_at() == robot.now:
        turns.append(asked(robot.give(TimePassed())))
    telling = turns.count(0)
    assert turns[1 : 1 + telling] == [0] * telling, "deviations are told before further nodes start"
    assert turns[:1] + turns[1 + telling :] == [STARTS_AT_ONCE] * 10


def test_all_targets_are_in_force_before_the_first_node_moves(robot: CoreRobot) -> None:
    request(robot, FAST)
    for part in robot.core.parts().values():
        assert part.target is not None
        assert not part.converged
        assert part.change == "c1"


def test_an_input_in_between_is_not_delayed_by_the_rest(robot: CoreRobot) -> None:
    request(robot, FAST)
    outputs = robot.give(Readings((Reading("estop", value=True),), "button"))
    assert outputs.system_state
    assert asked(outputs) == 0


def test_later_portions_are_consequences_of_the_request(robot: CoreRobot) -> None:
    request(robot, FAST)
    while (
        not (events := robot.give(TimePassed()).events) or events[0].kind != "change.step_started"
    ):
        assert {event.kind for event in events} <= {"part.actual_changed", "part.deviation_began"}
    cause = robot.core.change("c1").cause
    started = [e for e in events if isinstance(e.event, StepStarted)]
    assert len(started) == STARTS_AT_ONCE
    assert {(e.cause, e.actor) for e in started} == {(cause, PILOT)}


def test_a_node_that_was_not_started_yet_is_left_alone_once_the_change_is_canceled(
    robot: CoreRobot,
) -> None:
    request(robot, FAST)
    robot.give(CancelRequest(ChangeId("c1")))
    while robot.core.wake_at() == robot.now:
        assert asked(robot.give(TimePassed())) == 0


def test_a_request_makes_nothing_for_nodes_whose_turn_has_not_come(robot: CoreRobot) -> None:
    request(robot, FAST)
    assert len(robot.change(ChangeId("c1")).steps) == 3 * STARTS_AT_ONCE


def test_a_node_that_reports_before_its_turn_begins_then(robot: CoreRobot) -> None:
    request(robot, FAST)
    last = PartName(f"node_{NODES - 1}")
    outputs = robot.give(NodeReport(last, reachable=True, state=LifecycleState.UNCONFIGURED))
    assert [c.node for c in outputs.commands if isinstance(c, AskTransition)] == [last]
    robot.advance(5)
    assert robot.change(ChangeId("c1")).status is ChangeStatus.SUCCEEDED
    assert [s.node for s in robot.change(ChangeId("c1")).steps].count(last) == 3


def test_a_part_may_be_asked_for_something_else_before_the_turn_of_its_nodes(
    robot: CoreRobot,
) -> None:
    request(robot, FAST)
    last = PartName(f"node_{NODES - 1}")
    robot.give(ModeRequest(last, SLOW))
    robot.advance(5)
    assert robot.change(ChangeId("c1")).status is ChangeStatus.SUPERSEDED
    assert robot.change(ChangeId("c2")).status is ChangeStatus.SUCCEEDED
    assert robot.actual(last) == f"active.{SLOW}"
    assert robot.actual("node_0") == f"active.{FAST}"
    assert all(part.change is None for part in robot.core.parts().values())


def test_a_newer_change_begins_while_nodes_of_the_older_one_wait(robot: CoreRobot) -> None:
    request(robot, FAST)
    request(robot, SLOW)
    robot.advance(5)
    assert robot.change(ChangeId("c1")).status is ChangeStatus.SUPERSEDED
    assert robot.change(ChangeId("c2")).status is ChangeStatus.SUCCEEDED
    assert robot.actual("node_999") == f"active.{SLOW}"


def test_a_large_change_succeeds(robot: CoreRobot) -> None:
    change = robot.ask_mode(robot.model.parts[0], FAST)
    robot.advance(5)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert len(robot.change(change).steps) == 3 * NODES
    assert {part.actual.mode for part in robot.core.parts().values()} == {FAST}


def test_a_large_change_that_is_over_is_shown_as_it_ended(robot: CoreRobot) -> None:
    change = robot.ask_mode(robot.model.parts[0], FAST)
    robot.advance(0)
    running = robot.change(change)
    statuses = [step.status for step in running.steps]
    robot.advance(5)
    assert [step.status for step in running.steps] == statuses, "a view does not change"
    ended = robot.change(change)
    assert {step.status for step in ended.steps} == {StepStatus.SUCCEEDED}
    assert {step.node for step in ended.steps} == set(robot.model.nodes)
    assert robot.change(change).steps is ended.steps, "nothing is made anew for each reader"


def test_steps_in_flight_of_a_canceled_change_are_shown_with_how_they_end(robot: CoreRobot) -> None:
    change = robot.ask_mode(robot.model.parts[0], FAST)
    robot.advance(0.01)
    robot.give(CancelRequest(change))
    begun = [step for step in robot.change(change).steps if step.status is StepStatus.RUNNING]
    robot.advance(5)
    statuses = [step.status for step in robot.change(change).steps]
    assert statuses.count(StepStatus.SUCCEEDED) == len(begun) > 0
    assert set(statuses) == {StepStatus.SUCCEEDED, StepStatus.CANCELED}


def test_no_more_nodes_are_under_way_at_once_than_can_be_heard_in_time() -> None:
    robot = CoreRobot(big_model(2 * MAX_IN_FLIGHT))
    change = robot.ask_mode(robot.model.parts[0], FAST)
    most = 0
    while robot.change(change).status is ChangeStatus.RUNNING:
        robot.advance(0.05)
        running = [s for s in robot.change(change).steps if s.status is StepStatus.RUNNING]
        most = max(most, len(running))
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert MAX_IN_FLIGHT - STARTS_AT_ONCE <= most <= MAX_IN_FLIGHT
