"""What calls for reactions."""

from domain.simulation.node_settings import Fault
from tests.support.reacting_robot import ReactingRobot

LOST = 'LOST: {when: "not lidar.reachable", action: hold}'


def test_a_node_that_is_lost_calls_for_a_reaction() -> None:
    robot = ReactingRobot(LOST)
    robot.fault("lidar", Fault.SILENT)
    robot.wait(12)

    assert robot.state("LOST") in ("acting", "idle")


def test_a_condition_that_is_true_for_a_moment_begins_nothing() -> None:
    robot = ReactingRobot('LIMP: {when: "a", for_s: 1, action: mode, target: active.SLOW}')
    robot.see(0.9, a=True).see(0.9, a=False).see(0.9, a=True)

    assert robot.state("LIMP") == "pending"
    assert robot.told("LIMP") == []


def test_the_time_of_a_condition_begins_with_its_own_reading() -> None:
    robot = ReactingRobot('LIMP: {when: "a", for_s: 1, action: mode, target: active.SLOW}')
    began = robot.now
    robot.see(a=True)

    assert robot.reaction("LIMP").since == began + 1_000_000_000
