"""A change that is under way when a device is lost: it ends, and nothing of it goes on later."""

import pytest

from domain.commands import AskTransition, NodeCommand
from domain.computers import DeviceState
from domain.devices.settings import DeviceSettings
from domain.inputs import ModeRequest
from domain.lifecycle import LifecycleState
from domain.parts.mode_settings import OnFailure
from domain.snapshot import ChangeStatus, ChangeView, StepStatus
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.supervision import SupervisionSettings
from tests.support.models import ACTUATION, ARM
from tests.support.ordered_model import ROBOT, ordered_model
from tests.support.robot_of_devices import (
    ARM_COMPUTER,
    BASE_COMPUTER,
    SILENT,
    RobotOfDevices,
)


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


# --- a node that waits for others ----------------------------------------------------------------


def in_order(on_failure: OnFailure) -> RobotOfDevices:
    """Three nodes in a row are requested to be active; the second is on the arm."""
    first, second, third = (PartName(name) for name in ("n1", "n2", "n3"))
    model = ordered_model({"n2": ["n1"], "n3": ["n2"]}, on_failure, parts=(first, second, third))
    devices = {
        BASE_COMPUTER: DeviceSettings(BASE_COMPUTER, (first, third)),
        ARM_COMPUTER: DeviceSettings(ARM_COMPUTER, (second,)),
    }
    settings = SupervisionSettings(devices=devices, peers=tuple(devices))
    robot = RobotOfDevices(model, settings).connect_all("inactive")
    robot.give(ModeRequest(ROBOT, "FAST"))
    return robot


def asked(robot: RobotOfDevices) -> set[PartName]:
    return {each.node for each in robot.commands if isinstance(each, NodeCommand)}


def test_a_node_whose_turn_had_not_come_ends_with_its_device() -> None:
    robot = in_order(OnFailure.STOP)

    robot.lose()

    failed = [step for step in change(robot).steps if step.status is StepStatus.FAILED]
    assert [(step.node, step.error) for step in failed] == [
        ("n2", f"n2: the node is unreachable: {SILENT}, its last values are old")
    ]
    assert change(robot).status is ChangeStatus.RUNNING, "a step of n1 is in flight"
    robot.obey()
    assert change(robot).status is ChangeStatus.FAILED
    assert change(robot).reason == failed[0].error


def test_the_others_go_on_in_their_order_without_it() -> None:
    robot = in_order(OnFailure.CONTINUE)

    robot.lose()
    assert asked(robot) == {"n1"}, "n3 still waits for n1"
    robot.obey().advance(0.1)
    assert asked(robot) == {"n3"}
    robot.obey()

    states = {node: str(robot.core.part(PartName(node)).actual.state) for node in ("n1", "n3")}
    assert states == {"n1": "active", "n3": "active"}
    assert change(robot).status is ChangeStatus.FAILED


def test_it_does_not_begin_either_when_its_device_is_back() -> None:
    robot = in_order(OnFailure.CONTINUE)
    robot.lose()
    robot.connect(ARM_COMPUTER, "inactive", run=2)
    robot.obey().advance(20.0)
    assert asked(robot) == {"n3"}

    assert str(robot.core.part(PartName("n2")).actual.state) == "inactive"
