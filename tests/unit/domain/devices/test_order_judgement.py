import pytest

from domain.commands import AskFacts, AskParameters, AskTransition, NodeCommand
from domain.devices.order_judgement import action_of, renumbered
from domain.lifecycle import Transition
from tests.support.device_robot import DeviceRobot
from tests.support.models import BASE

COMMANDS: list[tuple[NodeCommand, str]] = [
    (AskTransition(1, BASE, Transition.ACTIVATE), "activate"),
    (AskParameters(1, BASE, {"max_speed": 0.1}), "set_parameters"),
    (AskFacts(1, BASE), "report"),
]


@pytest.mark.parametrize(("command", "action"), COMMANDS)
def test_a_command_is_named_as_steps_are(command: NodeCommand, action: str) -> None:
    assert action_of(command) == action


@pytest.mark.parametrize(("command", "action"), COMMANDS)
def test_another_number_changes_nothing_else(command: NodeCommand, action: str) -> None:
    other = renumbered(command, 7)

    assert (other.request, renumbered(other, 1)) == (7, command)


@pytest.mark.parametrize("order", ["configure", "deactivate", "cleanup", "shutdown"])
def test_a_stop_keeps_nothing_from_coming_to_rest(order: str) -> None:
    robot = DeviceRobot()
    robot.connect()
    robot.activate()
    robot.stop()

    robot.order("drive_base", order)

    assert robot.happened("order.refused") == []


def test_facts_are_told_whatever_is_in_progress() -> None:
    robot = DeviceRobot()
    robot.connect()
    robot.activate()
    robot.stop()
    robot.ask_transition("drive_base", "deactivate")

    robot.give_order(AskFacts(1, BASE))

    assert robot.happened("order.refused") == []
