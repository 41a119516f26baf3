"""Requests for modes with guards, as an operator meets them."""

import pytest

from domain.errors import BlockedError
from domain.findings import Blocker
from domain.inputs import ModeRequest
from domain.parts.mode_settings import ModeSettings, OnFailure, TransitionSettings
from domain.parts.system_model import EVERY_MODE, SmhModel
from domain.simulation.node_settings import Fault
from domain.snapshot import ChangeStatus, ModeView, Rollback
from domain.state_and_mode import ModeName, PartName
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.guarded_model import CHARGED, COOL, guarded_model
from tests.support.models import ACTUATION, ARM, BASE, FAST, PERFORMANCE

PERFORM = ModeRequest(ACTUATION, PERFORMANCE)


def _robot(model: SmhModel) -> CoreRobot:
    robot = CoreRobot(model)
    robot.read(**GOOD)
    return robot


def _mode(robot: CoreRobot, part: PartName, mode: ModeName) -> ModeView:
    return next(view for view in robot.core.modes(part) if view.mode == mode)


def _refused(robot: CoreRobot, request: ModeRequest) -> tuple[Blocker, ...]:
    with pytest.raises(BlockedError) as refusal:
        robot.give(request)
    return tuple(refusal.value.blockers)


def test_a_mode_whose_guards_hold_can_be_entered_and_its_guards_are_listed() -> None:
    robot = _robot(guarded_model())
    view = _mode(robot, ACTUATION, PERFORMANCE)
    assert (view.can_enter, view.blockers) == (True, ())
    assert (view.requires, view.invariants) == ((CHARGED,), (COOL,))
    assert view.can_stay is None, "it is not in force"


def test_a_request_is_refused_with_the_tree_that_its_mode_shows() -> None:
    robot = _robot(guarded_model())
    robot.read(battery_level=0.21)
    view = _mode(robot, ACTUATION, PERFORMANCE)
    assert not view.can_enter
    assert _refused(robot, PERFORM) == view.blockers
    assert view.blockers[0].message == "battery_level is 0.21, needs >= 0.3"
    assert robot.core.part(ACTUATION).target is None, "nothing changed"


def test_guards_of_a_part_below_count_as_well_and_their_path_leads_there() -> None:
    robot = _robot(guarded_model(BASE, FAST))
    robot.read(temperature=54)
    (blocker,) = _refused(robot, PERFORM)
    assert (blocker.code, blocker.path) == ("INVARIANT", ("actuation", "drive_base"))


def test_a_guard_that_breaks_while_a_change_runs_stops_it_even_if_others_would_go_on() -> None:
    robot = _robot(guarded_model(invariants=()))
    change = robot.begin(PERFORM)
    robot.advance(0.4)
    robot.read(battery_level=0.2)
    robot.advance(5)
    view = robot.change(change)
    assert view.status is ChangeStatus.FAILED
    assert view.reason == "battery_level is 0.2, needs >= 0.3"
    assert robot.actual(BASE) == "active.FAST", "the step in flight arrived, and no other began"
    assert robot.actual(ARM) == "unconfigured"


def test_an_invariant_that_breaks_while_a_change_runs_fails_it_at_once() -> None:
    robot = _robot(guarded_model())
    change = robot.begin(PERFORM)
    robot.advance(0.1)
    robot.read(temperature=51)
    robot.advance(5)
    view = robot.change(change)
    assert view.status is ChangeStatus.FAILED
    assert view.reason == "actuation cannot stay PERFORMANCE: temperature is 51 °C, needs < 50 °C"


def test_an_invariant_may_be_broken_for_its_grace() -> None:
    robot = _robot(guarded_model(grace_s=1))
    change = robot.begin(PERFORM)
    robot.advance(0.1)
    robot.read(temperature=51)
    robot.advance(0.9)
    robot.read(temperature=49)
    robot.advance(3)
    assert robot.change(change).status is ChangeStatus.SUCCEEDED


def test_after_the_grace_of_an_invariant_the_change_fails() -> None:
    robot = _robot(guarded_model(grace_s=0.5))
    robot.fault(BASE, Fault.SLOW)
    change = robot.begin(PERFORM)
    robot.read(temperature=51)
    robot.advance(0.4)
    assert robot.change(change).status is ChangeStatus.RUNNING
    robot.advance(10)
    view = robot.change(change)
    assert view.status is ChangeStatus.FAILED


def test_a_change_that_goes_back_on_a_failure_does_so_when_a_guard_breaks() -> None:
    transition = TransitionSettings({ARM: (BASE,)}, None, OnFailure.ROLLBACK)
    robot = _robot(guarded_model(transition=transition))
    change = robot.begin(PERFORM)
    robot.advance(0.6)
    robot.read(temperature=51)
    robot.advance(10)
    view = robot.change(change)
    assert (view.status, view.rollback) == (ChangeStatus.FAILED, Rollback.DONE)
    assert robot.actual(BASE) == "unconfigured"


def test_a_mode_in_force_can_be_stayed_in_exactly_while_its_invariants_hold() -> None:
    robot = _robot(guarded_model())
    robot.begin(PERFORM)
    robot.advance(5)
    robot.read(**GOOD)
    assert _mode(robot, ACTUATION, PERFORMANCE).can_stay is True
    robot.read(temperature=51)
    assert _mode(robot, ACTUATION, PERFORMANCE).can_stay is False


def test_a_guard_of_one_part_that_breaks_lets_no_later_part_begin() -> None:
    model = guarded_model(BASE, FAST, invariants=())
    order = ModeSettings(transition=TransitionSettings({ARM: (BASE,)}))
    settings = {**model.mode_settings, ACTUATION: {EVERY_MODE: order}}
    robot = _robot(SmhModel(model.nodes, model.systems, settings))
    change = robot.begin(PERFORM)
    robot.read(battery_level=0.2)
    robot.advance(5)
    assert robot.change(change).status is ChangeStatus.FAILED
    assert robot.actual(ARM) == "unconfigured", "as with stop, although its policy is to continue"
