"""Why a part is not where it should be, as an operator asks."""

from domain.inputs import ModeRequest
from domain.simulation.node_settings import Fault
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.guarded_model import guarded_model
from tests.support.models import ACTUATION, ARM, BASE, PERFORMANCE, actuation_model


def _robot() -> CoreRobot:
    robot = CoreRobot(actuation_model())
    robot.read(**GOOD)
    return robot


def test_a_part_that_nobody_asked_for_anything_is_where_it_should_be() -> None:
    assert _robot().core.why(ACTUATION) == ()


def test_while_a_change_runs_each_node_that_is_elsewhere_tells_which_change() -> None:
    robot = _robot()
    robot.begin(ModeRequest(ACTUATION, PERFORMANCE))
    base = next(why for why in robot.core.why(ACTUATION) if why.path[-1] == BASE)
    assert (base.code, base.path) == ("DEVIATES", ("actuation", "drive_base"))
    assert base.message == "drive_base is unconfigured, target active.FAST; change c1 is under way"
    robot.advance(5)
    assert robot.core.why(ACTUATION) == ()


def test_a_dead_node_is_the_reason_of_its_system() -> None:
    robot = _robot()
    robot.begin(ModeRequest(ACTUATION, PERFORMANCE))
    robot.advance(5)
    robot.fault(ARM, Fault.DIE)
    robot.advance(5)
    (why,) = robot.core.why(ACTUATION)
    assert (why.code, why.path) == ("UNREACHABLE", ("actuation", "manipulator"))


def test_what_would_block_a_request_comes_before_the_nodes_below() -> None:
    robot = CoreRobot(guarded_model(invariants=()))
    robot.read(**GOOD)
    robot.begin(ModeRequest(ACTUATION, PERFORMANCE))
    robot.advance(0.1)
    robot.read(battery_level=0.1)
    robot.advance(1)
    first, *others = robot.core.why(ACTUATION)
    assert first.message == "battery_level is 0.1, needs >= 0.3"
    assert {why.message.partition(";")[2] for why in others} == {" nothing moves it"}


def test_a_system_whose_part_was_asked_for_something_else_says_so() -> None:
    robot = _robot()
    robot.ask_transition(ACTUATION, "configure")
    robot.advance(3)
    robot.begin(ModeRequest(BASE, "FAST"))
    robot.advance(3)
    (why,) = robot.core.why(ACTUATION)
    assert (why.code, why.path, why.threshold) == ("DEVIATES", ("actuation",), "inactive")
    (other,) = why.causes
    assert other.message == "the target of drive_base is active.FAST, and actuation needs inactive"
    assert (other.path, other.root_cause) == (("actuation", "drive_base"), True)
    assert not why.root_cause
