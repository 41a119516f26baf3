"""A change that is under way when a device is lost: it ends, and nothing of it goes on later."""

import pytest

from domain.commands import AskTransition
from domain.computers import DeviceState
from domain.inputs import ModeRequest
from domain.lifecycle import LifecycleState
from domain.snapshot import ChangeStatus, ChangeView, StepStatus
from domain.state_and_mode import ModeName, StateAndMode
from tests.support.models import ACTUATION, ARM
from tests.support.robot_of_devices import ARM_COMPUTER, SILENT, RobotOfDevices


@pytest.fixture
def robot() -> RobotOfDevices:
    """Both devices are connected, and everything is requested to move."""
    robot = RobotOfDevices().connect_all()
    robot.give(ModeRequest(ACTUATION, "PERFORMANCE"))
    return robot


def change(robot: RobotOfDevices) -> ChangeView:
    (found,) = robot.core.changes()
    return found


def asked_of_arm(robot: RobotOfDevices) -> list[AskTransition]:
    asked = [each for each in robot.commands if isinstance(each, AskTransition)]
    return [each for each in asked if each.node == ARM]


def test_what_a_node_of_a_lost_device_was_doing_has_an_outcome_that_nobody_knows(
    robot: RobotOfDevices,
) -> None:
    robot.lose()

    (step,) = (
        each
        for each in change(robot).steps
        if each.node == ARM and each.status is not StepStatus.CANCELED
    )
    assert (step.status, step.error) == (
        StepStatus.TIMED_OUT,
        f"the node is unreachable: {SILENT}, its last values are old",
    )


def test_nodes_of_other_computers_go_on(robot: RobotOfDevices) -> None:
    robot.lose()
    assert change(robot).status is ChangeStatus.RUNNING
    robot.obey()

    assert change(robot).status is ChangeStatus.TIMED_OUT
    assert robot.core.part(ACTUATION).target == StateAndMode(
        LifecycleState.ACTIVE, ModeName("PERFORMANCE")
    )


def test_a_device_that_comes_back_at_once_is_asked_for_nothing(robot: RobotOfDevices) -> None:
    robot.lose()
    robot.commands.clear()
    robot.advance(1.0)
    robot.connect(ARM_COMPUTER, "inactive", run=2)
    robot.advance(20.0)

    assert asked_of_arm(robot) == []
    assert str(robot.core.part(ARM).actual.state) == "inactive"


def test_a_late_device_goes_on(robot: RobotOfDevices) -> None:
    robot.says(DeviceState.LATE, ARM_COMPUTER, "device arm has not been heard for 0.5 s")

    assert change(robot).status is ChangeStatus.RUNNING
    assert len(asked_of_arm(robot)) == 1


def test_what_is_requested_while_a_device_is_lost_waits_for_its_return(
    robot: RobotOfDevices,
) -> None:
    robot.lose()
    robot.commands.clear()
    robot.give(ModeRequest(ARM, "WEAK"))
    robot.advance(1.0)
    assert asked_of_arm(robot) == []

    robot.connect(ARM_COMPUTER, "unconfigured", run=2)
    assert len(asked_of_arm(robot)) == 1
