"""Restarts of nodes by reactions."""

from domain.simulation.node_settings import Fault
from tests.support.reacting_robot import ReactingRobot

AGAIN = 'AGAIN: {when: "a", action: restart}'


def actions(robot: ReactingRobot, node: str = "lidar") -> list[str]:
    told = robot.happened("change.step_started")
    return [str(data["action"]) for data in told if data["node"] == node][2:]


def test_a_node_is_restarted_to_its_target_in_force() -> None:
    robot = ReactingRobot(of_lidar=AGAIN).see(a=True)

    assert actions(robot) == ["deactivate", "cleanup", "configure", "activate"]
    assert robot.actual("lidar") == "active"
    assert robot.target("lidar") == "active"


def test_a_restart_that_has_begun_goes_on_after_its_cause() -> None:
    robot = ReactingRobot(of_lidar=AGAIN).see(0.1, a=True).see(2, a=False)

    assert actions(robot)[-1] == "activate"
    assert robot.state("AGAIN", "lidar") == "idle"


def test_it_restarts_once_each_time_it_is_called_for() -> None:
    robot = ReactingRobot(of_lidar=AGAIN).see(3, a=True).see(a=False).see(3, a=True)

    assert actions(robot).count("cleanup") == 2


def test_a_node_at_rest_is_configured_and_no_more() -> None:
    robot = ReactingRobot(of_lidar=AGAIN)
    robot.rest("lidar")
    robot.see(2, a=True)

    assert robot.actual("lidar") == "inactive"
    assert actions(robot)[-2:] == ["cleanup", "configure"]


def test_nothing_is_restarted_under_estop_nor_because_of_its_end() -> None:
    robot = ReactingRobot(of_lidar=AGAIN)
    robot.stop()
    robot.see(a=True)
    assert (robot.state("AGAIN", "lidar"), actions(robot)) == ("overruled", [])
    robot.release_stop()
    robot.see(2, a=True)
    assert actions(robot) == []
    robot.see(a=False).see(2, a=True)
    assert robot.actual("lidar") == "active"
    assert "cleanup" in actions(robot)


def test_estop_in_the_middle_leaves_the_node_where_it_is() -> None:
    robot = ReactingRobot(of_lidar=AGAIN).see(0.15, a=True)
    robot.stop()
    robot.advance(3)
    robot.release_stop()
    robot.advance(3)

    assert robot.actual("lidar") == "unconfigured"


def test_a_finalized_node_cannot_be_restarted() -> None:
    robot = ReactingRobot(of_lidar=AGAIN)
    robot.rest("lidar", "shutdown")
    robot.see(a=True)

    assert robot.state("AGAIN", "lidar") == "overruled"


def test_a_restart_that_fails_is_told_as_a_failed_change() -> None:
    robot = ReactingRobot(of_lidar=AGAIN)
    robot.fault("lidar", Fault.REFUSE)
    robot.see(3, a=True)

    assert robot.happened("change.failed")
    assert robot.state("AGAIN", "lidar") == "acting"


def test_a_restart_overrules_other_states_of_its_node() -> None:
    robot = ReactingRobot(of_drive='AGAIN: {when: "a", action: restart}').see(2, a=True)

    assert robot.actual("drive") == "active.FAST"
