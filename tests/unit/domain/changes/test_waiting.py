"""Requests that wait until what their mode requires is true."""

import pytest

from domain.errors import BlockedError
from domain.identifiers import ChangeId
from domain.inputs import BackendStatus, CancelRequest, ModeRequest, Restored
from domain.parts.mode_settings import TransitionSettings
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault
from domain.snapshot import ChangeStatus
from domain.timebase import seconds
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.guarded_model import guarded_model
from tests.support.models import ACTUATION, ARM, BASE, FAST, PERFORMANCE


@pytest.fixture
def robot() -> CoreRobot:
    """Return a robot whose battery is too low for PERFORMANCE."""
    robot = CoreRobot(guarded_model(requires=("vehicle.x_m < 1", "not hold.charging")))
    robot.read(**GOOD)
    robot.hold("charging")
    return robot


def _ask(robot: CoreRobot, wait_for_s: float = 60.0) -> ChangeId:
    return robot.begin(ModeRequest(ACTUATION, PERFORMANCE, wait_for=seconds(wait_for_s)))


def _keep_good(robot: CoreRobot, duration_s: int) -> None:
    """Let time pass while all signals stay fresh."""
    for _ in range(duration_s):
        robot.read(**GOOD)
        robot.advance(1)


def test_a_request_waits_and_changes_no_target(robot: CoreRobot) -> None:
    change = _ask(robot)
    assert robot.change(change).status is ChangeStatus.WAITING
    assert robot.core.part(ACTUATION).target is None
    assert robot.core.part(ACTUATION).change is None
    (told,) = robot.happened("change.waiting")
    assert told["reason"] == "hold charging is set"


def test_it_begins_in_the_step_in_which_its_guards_hold(robot: CoreRobot) -> None:
    change = _ask(robot)
    _keep_good(robot, 5)
    outputs = robot.release("charging")
    assert robot.change(change).status is ChangeStatus.RUNNING
    assert outputs.commands, "the first node is asked at once"
    _keep_good(robot, 5)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED
    assert robot.actual(ACTUATION) == "active.PERFORMANCE"


def test_when_its_time_is_up_it_fails_with_what_it_waited_for(robot: CoreRobot) -> None:
    change = _ask(robot, wait_for_s=3)
    _keep_good(robot, 4)
    view = robot.change(change)
    assert view.status is ChangeStatus.FAILED
    assert view.reason == "waited for 3 s: hold charging is set"
    robot.release("charging")
    assert robot.core.part(ACTUATION).target is None, "an outcome is final"


def test_what_waiting_does_not_help_refuses_the_request_at_once(robot: CoreRobot) -> None:
    robot.read(temperature=51)
    with pytest.raises(BlockedError):
        _ask(robot)


def test_estop_ends_a_waiting_request(robot: CoreRobot) -> None:
    change = _ask(robot)
    robot.read(estop=True)
    view = robot.change(change)
    assert view.status is ChangeStatus.FAILED
    assert "ESTOP" in (view.reason or "") or "e-stop" in (view.reason or "").lower()


def test_a_node_that_cannot_be_activated_any_more_ends_it(robot: CoreRobot) -> None:
    _keep_good(robot, 1)
    change = _ask(robot)
    robot.ask_transition(ARM, "shutdown")
    robot.fault(ARM, Fault.SLOW)
    _keep_good(robot, 5)
    assert robot.change(change).status is ChangeStatus.FAILED


def test_it_can_be_canceled(robot: CoreRobot) -> None:
    change = _ask(robot)
    robot.give(CancelRequest(change))
    assert robot.change(change).status is ChangeStatus.CANCELED
    robot.release("charging")
    assert robot.core.part(ACTUATION).target is None


def test_a_later_one_that_waits_supersedes_an_earlier_one(robot: CoreRobot) -> None:
    earlier, later = _ask(robot), _ask(robot)
    assert robot.change(earlier).status is ChangeStatus.SUPERSEDED
    assert robot.change(later).status is ChangeStatus.WAITING


def test_a_newer_request_for_the_part_supersedes_it(robot: CoreRobot) -> None:
    waiting = _ask(robot)
    robot.begin(ModeRequest(ACTUATION, "MODERATE"))
    assert robot.change(waiting).status is ChangeStatus.SUPERSEDED


def test_a_request_that_need_not_wait_begins_at_once(robot: CoreRobot) -> None:
    robot.release("charging")
    assert robot.change(_ask(robot)).status is ChangeStatus.RUNNING


def test_the_deadline_of_a_change_counts_from_when_it_begins() -> None:
    model = guarded_model(
        requires=("not hold.charging",),
        invariants=(),
        transition=TransitionSettings(deadline=seconds(2)),
    )
    robot = CoreRobot(model)
    robot.read(**GOOD)
    robot.hold("charging")
    robot.fault(ARM, Fault.SILENT)
    change = _ask(robot)
    _keep_good(robot, 5)
    robot.release("charging")
    _keep_good(robot, 3)
    view = robot.change(change)
    assert view.status is ChangeStatus.TIMED_OUT
    assert view.reason == "not done within 2 s: manipulator"


def test_nothing_begins_while_the_backend_is_down(robot: CoreRobot) -> None:
    change = _ask(robot)
    robot.give(BackendStatus(available=False, reason="no route"))
    robot.release("charging")
    assert robot.change(change).status is ChangeStatus.WAITING
    robot.give(BackendStatus(available=True))
    assert robot.change(change).status is ChangeStatus.RUNNING


def test_one_that_begins_supersedes_those_that_wait_below_it() -> None:
    of_base = guarded_model(BASE, FAST, requires=("not hold.lunch",), invariants=())
    model = guarded_model(requires=("not hold.charging",), invariants=())
    robot = CoreRobot(
        SmhModel(model.nodes, model.systems, {**model.mode_settings, **of_base.mode_settings})
    )
    robot.read(**GOOD)
    robot.hold("charging")
    above = _ask(robot)
    robot.hold("lunch")
    below = robot.begin(ModeRequest(BASE, FAST, wait_for=seconds(60)))
    robot.release("lunch")
    assert robot.change(below).status is ChangeStatus.RUNNING
    robot.hold("lunch")
    below = robot.begin(ModeRequest(BASE, FAST, wait_for=seconds(60)))
    robot.release("charging")
    assert robot.change(above).status is ChangeStatus.WAITING, (
        "the base below still waits for lunch"
    )
    robot.release("lunch")
    assert robot.change(above).status is ChangeStatus.RUNNING
    assert robot.change(below).status is ChangeStatus.SUPERSEDED


def test_after_a_restart_one_that_begins_counts_as_asked_for_by_an_operator() -> None:
    robot = CoreRobot(guarded_model(requires=("not hold.charging",), invariants=()))
    robot.give(Restored(boot=2))
    robot.read(**GOOD)
    robot.hold("charging")
    parts = robot.core._parts  # noqa: SLF001  # no view tells it
    _ask(robot)
    assert parts.waits_for_operator(ACTUATION), "nothing was begun yet"
    robot.release("charging")
    assert not parts.waits_for_operator(ARM)
