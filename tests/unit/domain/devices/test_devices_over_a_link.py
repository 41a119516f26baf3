"""What the machines of the link really say, and what the core of a supervisor makes of it."""

import re

from domain.computers import SUPERVISOR
from domain.inputs import TimePassed
from tests.support.linked_pair import ARM, BASE, GRIPPER, LinkedRobot
from tests.support.robot_of_devices import RobotOfDevices


def told(link: LinkedRobot) -> RobotOfDevices:
    """Return a core to which all was given that its link gave so far."""
    robot = RobotOfDevices()
    for at, given in link.supervisor.inputs:
        while (due := robot.core.wake_at()) is not None and due <= at:
            robot.now = due
            robot.give(TimePassed())
        robot.now = at
        robot.give(given)
    robot.advance((link.now - robot.now) / 1e9)
    return robot


def test_a_device_that_is_cut_off_for_a_while_is_one_error_and_two_changes_of_each_part() -> None:
    link = LinkedRobot((BASE, ARM))
    link.run(3)
    link.cut(SUPERVISOR, ARM)
    link.run(4)
    lost = told(link)
    link.mend(SUPERVISOR, ARM)
    link.run(3)

    robot = told(link)

    assert lost.announced == ["arm.LOST"]
    why = lost.error("arm.LOST").message
    assert re.fullmatch(r"device arm has not been heard for 1\.\d s", why)
    assert lost.core.part(GRIPPER).actual.reason == (
        f"manipulator is unreachable: {why}, its last values are old"
    )
    assert robot.announced == []
    assert [words for words in robot.happened("part.") if "manipulator" in words] == [
        "manipulator: unknown -> active",
        "manipulator: active -> unknown",
        "manipulator: unknown -> active",
    ]
    connected, late, lost_, back = robot.happened("device.")[1:]
    assert (connected, lost_, back) == ("device arm is connected", why, "device arm is connected")
    assert late.startswith("device arm has not been heard for 0.")


def test_a_device_that_never_comes_is_said_to_be_missing_once() -> None:
    link = LinkedRobot((BASE, ARM))
    link.kill(link.devices[ARM])
    link.run(10)

    robot = told(link)

    assert robot.announced == ["arm.LOST"]
    assert robot.happened("device.")[1:] == ["device arm has not been heard yet"]


def test_a_newcomer_is_a_conflict_that_moves_nothing() -> None:
    link = LinkedRobot((BASE, ARM))
    link.run(3)
    before = told(link)
    link.start(ARM)
    link.run(3)

    robot = told(link)

    assert robot.announced == ["arm.DEVICE_CONFLICT"]
    assert robot.happened("part.") == before.happened("part.")
    assert robot.core.part(GRIPPER).reachable
