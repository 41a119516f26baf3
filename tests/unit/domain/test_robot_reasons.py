"""What stands behind a comparison that is not true, down to the root cause."""

import pytest

from domain.conditions.condition import Condition
from domain.conditions.explanation import explain
from domain.findings import Blocker
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.robot_reasons import MAX_CAUSES
from domain.simulation.node_settings import Fault
from domain.state_and_mode import PartName
from tests.support.big_model import big_model
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import BASE, nested_model


@pytest.fixture
def robot() -> CoreRobot:
    robot = CoreRobot(nested_model())
    robot.read(**GOOD)
    return robot


def _why(robot: CoreRobot, text: str) -> Blocker:
    (blocker,) = explain(Condition(text), robot.core.facts)
    return blocker


def _causes(robot: CoreRobot, text: str) -> list[tuple[str, str]]:
    return [(cause.code, cause.message) for cause in _why(robot, text).causes]


def test_an_error_is_explained_by_what_raised_it(robot: CoreRobot) -> None:
    robot.read(battery_level=0.4)

    blocker = _why(robot, "not error.BATTERY_LOW")

    (cause,) = blocker.causes
    assert (cause.code, cause.value, cause.threshold) == ("BATTERY_LOW", 0.4, 0.5)
    assert cause.root_cause
    assert not blocker.root_cause


def test_an_error_that_is_missed_has_no_cause(robot: CoreRobot) -> None:
    assert _causes(robot, "error.BATTERY_LOW") == []


def test_the_robot_in_error_is_explained_by_all_its_errors(robot: CoreRobot) -> None:
    robot.read(battery_level=0.4, estop=True)

    assert [code for code, _ in _causes(robot, "robot.state != ERROR")] == ["ESTOP", "BATTERY_LOW"]


def test_a_system_is_explained_by_the_nodes_that_are_gone(robot: CoreRobot) -> None:
    robot.fault("drive_base", Fault.DIE)
    robot.advance(5)

    (cause,) = _why(robot, "part('robot').state == active").causes

    assert (cause.code, cause.message) == ("UNREACHABLE", "drive_base is unreachable")
    assert cause.path == ("robot", "actuation", "drive_base")
    assert _causes(robot, "actuation.reachable") == [("UNREACHABLE", "drive_base is unreachable")]


def test_a_system_in_another_mode_is_explained_by_the_part_that_is_not_there(
    robot: CoreRobot,
) -> None:
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(5)
    assert robot.actual("actuation") == "active.PERFORMANCE"
    robot.give(NodeReport(BASE, LifecycleState.INACTIVE))

    ((code, message),) = _causes(robot, "actuation.converged")
    assert code == "DEVIATES"
    assert message.startswith("drive_base is inactive")


def test_a_node_that_is_stuck_explains_its_system(robot: CoreRobot) -> None:
    robot.give(NodeReport(BASE, LifecycleState.FINALIZED))

    assert _causes(robot, "actuation.state == active") == [
        ("FINALIZED", "drive_base is finalized: its process must be restarted")
    ]
    assert (
        _why(robot, "drive_base.state == active").message == "drive_base is finalized, needs active"
    )


def test_an_unreachable_node_needs_no_words_but_its_own(robot: CoreRobot) -> None:
    robot.fault("drive_base", Fault.DIE)
    robot.advance(5)

    blocker = _why(robot, "drive_base.state == active")

    assert blocker.message == "drive_base is unreachable, needs active"
    assert blocker.causes == ()


def test_a_paused_task_is_explained_by_the_holds_and_they_by_the_errors(robot: CoreRobot) -> None:
    robot.advance(0.1)
    robot.submit_task()
    robot.hold("operator", "lunch")
    robot.read(battery_level=0.4)

    blocker = _why(robot, "task.status == RUNNING_TASK")

    by_operator, by_error = blocker.causes
    assert by_operator.code == by_error.code == "HOLD"
    assert by_operator.message.endswith(": lunch")
    assert [cause.code for cause in by_error.causes] == ["BATTERY_LOW"]
    assert not by_error.root_cause
    assert _causes(robot, "not hold.operator") == [("HOLD", by_operator.message)]


def test_a_task_that_is_not_there_has_no_further_reason(robot: CoreRobot) -> None:
    assert _causes(robot, "task.status == RUNNING_TASK") == []


def test_an_error_of_a_part_is_explained_by_what_is_wrong_with_it(robot: CoreRobot) -> None:
    robot.fault("drive_base", Fault.DIE)
    robot.advance(5)

    assert _causes(robot, "not drive_base.errors.UNREACHABLE") == [
        ("UNREACHABLE", "drive_base is unreachable")
    ]


def test_a_part_that_should_not_be_where_it_is_has_no_further_reason(robot: CoreRobot) -> None:
    robot.ask_transition("drive_base", "activate")
    robot.advance(5)
    robot.give(NodeReport(PartName("lidar"), LifecycleState.FINALIZED))

    assert _causes(robot, "part('robot').state in [unconfigured, inactive]") == [
        ("FINALIZED", "lidar is finalized: its process must be restarted")
    ]
    assert _causes(robot, "drive_base.state != active") == []
    assert _causes(robot, "not part('robot').reachable") == []


def test_of_many_nodes_only_some_are_named() -> None:
    robot = CoreRobot(big_model(1_000))
    root = robot.model.parts[0]
    for node in robot.model.nodes:
        robot.give(NodeReport(node, reachable=False))

    assert len(_causes(robot, f"part('{root}').state == active")) == MAX_CAUSES
