"""Conditions follow what happens to the robot, each through its own kind of fact."""

import pytest

from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth
from domain.conditions.watched import WatchedConditions
from domain.fact_changes import FactChanges
from domain.inputs import ModeRequest, NodeReport
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.mode_settings import ModeSettings
from domain.parts.parts import Parts
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault
from domain.snapshot import ErrorKey
from domain.state_and_mode import StateAndMode
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.guards import SetFacts
from tests.support.models import ACTUATION, ARM, BASE, FAST, PERFORMANCE, actuation_model

GUARDS = (
    "battery_level >= 0.3",
    "drive_base.mode == FAST",
    "drive_base.state == active",
    "drive_base.reachable",
    "drive_base.errors.UNREACHABLE",
    "error.ESTOP",
    "robot.state == ERROR",
    "hold.operator",
    "task.status == NO_TASK",
    "vehicle.speed_mps < 0.05",
)


@pytest.fixture
def robot() -> CoreRobot:
    model = actuation_model()
    guards = tuple(map(Condition, GUARDS))
    settings = {ACTUATION: {PERFORMANCE: ModeSettings(requires=guards)}}
    robot = CoreRobot(SmhModel(model.nodes, model.systems, settings))
    robot.read(**GOOD)
    robot.advance(0)
    return robot


def _true(robot: CoreRobot) -> set[str]:
    """Return the conditions that are kept as true."""
    watched = robot.core.conditions
    return {text for text in GUARDS if watched.truth(Condition(text)) is Truth.TRUE}


AT_REST = {
    "battery_level >= 0.3",
    "drive_base.reachable",
    "task.status == NO_TASK",
    "vehicle.speed_mps < 0.05",
}


def test_at_rest_what_is_so_is_true(robot: CoreRobot) -> None:
    assert _true(robot) == AT_REST


def test_a_reading_changes_what_names_its_signal(robot: CoreRobot) -> None:
    robot.read(battery_level=0.2)
    assert "battery_level >= 0.3" not in _true(robot)


def test_a_signal_that_falls_silent_makes_what_names_it_unknown(robot: CoreRobot) -> None:
    robot.advance(5)
    assert robot.core.conditions.truth(Condition(GUARDS[0])) is Truth.UNKNOWN


def test_state_and_mode_of_a_part_are_followed(robot: CoreRobot) -> None:
    robot.begin(ModeRequest(BASE, FAST))
    robot.advance(3)
    assert {"drive_base.mode == FAST", "drive_base.state == active"} <= _true(robot)


def test_a_node_that_dies_is_unreachable_and_that_is_an_error(robot: CoreRobot) -> None:
    robot.fault(BASE, Fault.DIE)
    robot.advance(5)
    assert "drive_base.reachable" not in _true(robot)
    assert "drive_base.errors.UNREACHABLE" in _true(robot)


def test_errors_of_the_robot_and_its_state_are_followed(robot: CoreRobot) -> None:
    robot.read(estop=True)
    assert {"error.ESTOP", "robot.state == ERROR"} <= _true(robot)
    robot.read(estop=False)
    robot.advance(1)
    robot.read(**GOOD)
    assert "error.ESTOP" not in _true(robot)


def test_a_hold_is_followed(robot: CoreRobot) -> None:
    robot.hold("operator", "lunch")
    assert "hold.operator" in _true(robot)
    robot.release("operator")
    assert "hold.operator" not in _true(robot)


def test_without_conditions_nothing_is_done() -> None:
    watched = WatchedConditions(SetFacts())
    robot = CoreRobot(actuation_model())
    parts = Parts(robot.core.model, Outbox())
    assert not FactChanges(watched, parts, robot.core.driving, Outbox()).settle(0)


def test_another_target_touches_only_what_names_convergence() -> None:
    facts, outbox, robot = SetFacts(), Outbox(), CoreRobot(actuation_model())
    parts, watched = Parts(robot.core.model, outbox), WatchedConditions(facts)
    state, there = Condition("drive_base.state == active"), Condition("manipulator.converged")
    watched.watch([state, there], 0)
    changes = FactChanges(watched, parts, robot.core.driving, outbox)
    outbox.parts = {BASE, ARM}
    changes.settle(0)

    facts.values = {"drive_base": "active", "manipulator": True}
    parts.ask({BASE: StateAndMode(LifecycleState.INACTIVE)})
    outbox.parts = {BASE, ARM}
    changes.settle(1)
    assert watched.truth(there) is Truth.TRUE
    assert watched.truth(state) is Truth.UNKNOWN, "its state was not looked at again"


def test_an_error_touches_only_what_names_it() -> None:
    facts, outbox, robot = SetFacts(), Outbox(), CoreRobot(actuation_model())
    watched = WatchedConditions(facts)
    base, arm = Condition("drive_base.errors.DEVIATES"), Condition("manipulator.errors.DEVIATES")
    watched.watch([base, arm], 0)
    changes = FactChanges(watched, Parts(robot.core.model, outbox), robot.core.driving, outbox)
    facts.values = {"DEVIATES": True}
    outbox.errors = {ErrorKey(BASE, "DEVIATES")}
    changes.settle(0)
    assert watched.truth(base) is Truth.TRUE
    assert watched.truth(arm) is Truth.UNKNOWN


def test_a_parameter_reaches_its_guard_though_nothing_else_about_the_node_changed() -> None:
    model = actuation_model()
    guard = Condition("drive_base.parameters.max_speed > 0.5")
    settings = {ACTUATION: {PERFORMANCE: ModeSettings(requires=(guard,))}}
    robot = CoreRobot(SmhModel(model.nodes, model.systems, settings))
    robot.advance(0)

    robot.give(NodeReport(BASE, parameters={"max_speed": 0.9}))

    assert robot.core.conditions.truth(guard) is Truth.TRUE
