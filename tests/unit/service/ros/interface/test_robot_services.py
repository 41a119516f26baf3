import pytest

from domain.errors import InvalidValueError
from domain.inputs import TaskRequest
from domain.snapshot import TaskPhase
from tests.support.paths import straight
from tests.support.ros_robot import OPERATOR, RosRobot


async def test_the_task_is_canceled(robot: RosRobot) -> None:
    robot.supervisor.submit(TaskRequest(straight(), 0, "pure_pursuit", 1.0))

    assert await robot.call("/cancel_tasks") == {}

    (task,) = robot.supervisor.core.driving.tasks()
    assert task.status is TaskPhase.CANCELED
    requested = [e for e in robot.supervisor.events.oldest_first() if "cancel_req" in e.kind]
    assert [event.actor for event in requested] == [OPERATOR]


async def test_without_a_task_nothing_happens(robot: RosRobot) -> None:
    assert await robot.call("/cancel_tasks") == {}


async def test_it_takes_no_fields(robot: RosRobot) -> None:
    with pytest.raises(InvalidValueError, match="'task'"):
        await robot.call("/cancel_tasks", {"task": "t1"})
