"""Checkpoints that come over ROS."""

import pytest

from domain.actor import Actor
from domain.errors import InvalidValueError, PilothouseError
from domain.inputs import CheckpointReport
from domain.state_and_mode import PartName
from service.ros.interface.checkpoint_topic import TOPIC, checkpoint_topic
from tests.support.ros_robot import RosRobot

SENDER = Actor("ros")


class Watched(RosRobot):
    """The example robot, and what was submitted to it."""

    def __init__(self) -> None:
        super().__init__()
        self.submitted: list[object] = []
        self.supervisor.submit = self.submitted.append  # type: ignore[method-assign,assignment]

    def say(self, text: object) -> None:
        checkpoint_topic(self.supervisor).take({"data": text}, SENDER)


@pytest.mark.parametrize(
    ("text", "node"),
    [
        ("drive_base loop", "drive_base"),
        ("/drive_base loop", "drive_base"),
        ("  left/arm   loop\n", "left/arm  "),
    ],
)
async def test_a_message_names_node_and_checkpoint(text: str, node: str) -> None:
    robot = Watched()

    robot.say(text)

    assert robot.submitted == [CheckpointReport(PartName(node.strip()), "loop", SENDER)]


@pytest.mark.parametrize("text", ["", "loop", " loop", 7, None])
async def test_what_names_no_node_is_rejected_and_counted(text: object) -> None:
    robot = Watched()

    with pytest.raises(InvalidValueError):
        robot.say(text)

    assert robot.submitted == []
    assert robot.supervisor.refused_readings.counts == {"ros": 1}


async def test_a_checkpoint_that_nobody_declared_is_rejected() -> None:
    robot = RosRobot()

    with pytest.raises(PilothouseError):
        checkpoint_topic(robot.supervisor).take({"data": "drive_base loop"}, SENDER)


def test_each_message_counts() -> None:
    assert checkpoint_topic(RosRobot().supervisor).needs_all
    assert checkpoint_topic(RosRobot().supervisor).name == TOPIC
