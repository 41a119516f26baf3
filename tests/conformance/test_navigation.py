"""What is asked of whoever drives a task: the trackers on board, and an external controller.

In virtual time; `tests/ros2/test_navigation.py` has real action servers.
"""

from collections.abc import Callable
from typing import TypeAlias

import pytest

from domain.commands import Drive
from domain.parts.system_model import SmhModel
from domain.snapshot import TaskPhase
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.paths import straight
from tests.support.scripted_controller import ControlledRobot

Make: TypeAlias = Callable[[], CoreRobot]


def on_board() -> CoreRobot:
    robot = CoreRobot(SmhModel({}, {}))
    robot.read(**GOOD)
    return robot


@pytest.fixture(params=[on_board, ControlledRobot], ids=["on board", "external"])
def robot(request: pytest.FixtureRequest) -> CoreRobot:
    make: Make = request.param
    return make()


def drive(robot: CoreRobot, by_s: float) -> None:
    """Let time pass with good readings twice a second."""
    for _ in range(round(by_s / 0.5)):
        robot.advance(0.5)
        robot.read(**GOOD)


def x_m(robot: CoreRobot) -> float:
    state = robot.core.driving.vehicle.state
    assert state is not None
    return state.pose.x_m


def speed_mps(robot: CoreRobot) -> float:
    state = robot.core.driving.vehicle.state
    assert state is not None
    return state.speed_mps


def goals(robot: CoreRobot) -> list[tuple[int, int]]:
    """Return number and first waypoint of each goal."""
    started = (*robot.happened("task.started"), *robot.happened("task.resumed"))
    return [(data["goal"], data["target_index"]) for data in started]


def test_a_path_is_driven_to_its_end_and_the_vehicle_stands_there(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    drive(robot, 15)

    assert (robot.task.status, robot.task.progress) == (TaskPhase.SUCCEEDED, 1.0)
    assert x_m(robot) == pytest.approx(20.0, abs=0.5)
    assert speed_mps(robot) == 0.0


def test_progress_grows_with_the_way_that_is_driven(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    for _ in range(8):
        drive(robot, 0.5)
        assert robot.task.distance_m == pytest.approx(x_m(robot), abs=0.2)
        assert robot.task.target_index == pytest.approx(x_m(robot) + 0.5, abs=0.7)


def test_the_cruise_speed_is_not_exceeded(robot: CoreRobot) -> None:
    robot.submit_task(straight(), speed_mps=1.0)
    seen = []
    for _ in range(100):
        robot.advance(0.05)
        seen.append(speed_mps(robot))
    assert 0.9 < max(seen) <= 1.0 + 1e-6


@pytest.mark.parametrize("how", ["hold", "stop", "cancel_task"])
def test_whoever_drives_speed_0_is_commanded_in_the_same_step(robot: CoreRobot, how: str) -> None:
    robot.submit_task(straight())
    drive(robot, 3)
    outputs = getattr(robot, how)()

    first = outputs.commands[0]
    assert isinstance(first, Drive)
    assert first.command.speed_mps == 0.0
    drive(robot, 3)
    assert speed_mps(robot) == 0.0


def test_a_task_goes_on_from_the_waypoint_that_it_reached_with_one_goal(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    drive(robot, 3)
    robot.hold()
    drive(robot, 2)
    reached = robot.task.target_index
    robot.release()
    drive(robot, 15)

    assert goals(robot) == [(1, 0), (2, reached)]
    assert robot.task.status is TaskPhase.SUCCEEDED


def test_a_task_that_is_held_and_released_while_it_stops_goes_on(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    drive(robot, 3)
    robot.hold()
    robot.advance(0.06)
    robot.release()
    drive(robot, 15)

    assert len(goals(robot)) == 2
    assert robot.task.status is TaskPhase.SUCCEEDED


def test_a_new_task_replaces_the_one_that_is_driven(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    drive(robot, 1)
    robot.submit_task(straight(10.0))
    drive(robot, 10)

    assert [data["task"] for data in robot.happened("task.canceled")] == ["t1"]
    assert (robot.task.id, robot.task.status) == ("t2", TaskPhase.SUCCEEDED)
    assert x_m(robot) == pytest.approx(10.0, abs=0.5)


def test_a_task_begins_at_the_waypoint_that_was_asked_for(robot: CoreRobot) -> None:
    robot.submit_task(straight(), start_index=3)
    drive(robot, 15)

    assert goals(robot) == [(1, 3)]
    assert robot.task.status is TaskPhase.SUCCEEDED


def test_without_a_pose_the_task_is_held_and_goes_on_with_it(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    drive(robot, 2)
    robot.lose_pose()
    drive(robot, 2)
    assert "vehicle" in robot.core.driving.holds
    robot.lose_pose(lost=False)
    drive(robot, 15)

    assert robot.task.status is TaskPhase.SUCCEEDED
