from types import SimpleNamespace
from typing import cast

from domain.findings import Blocker
from domain.health.health import Health
from domain.health.signals import default_signals
from domain.inputs import Reading, Readings
from domain.outbox import Outbox
from domain.robot_state import RobotState
from domain.snapshot import SystemState, TaskStatus
from domain.storage import Storage
from domain.tasks.driving import Driving
from tests.support.good import GOOD


class Robot:
    """A robot with health and a task that a test sets."""

    def __init__(self) -> None:
        self.outbox = Outbox()
        self.health = Health(default_signals(), self.outbox, 0)
        self.driving = SimpleNamespace(status=TaskStatus.NO_TASK, still_moving=None)
        self.state = RobotState(
            self.health, cast("Driving", self.driving), Storage(self.outbox), self.outbox
        )

    def read(self, **values: bool) -> None:
        items = tuple(Reading(name, value) for name, value in {**GOOD, **values}.items())
        self.health.take_readings(Readings(items, "test"), 0)


def test_the_state_is_told_once_and_points_at_the_error_that_decided_it() -> None:
    robot = Robot()
    robot.read()
    robot.state.settle(0)
    robot.outbox.take()

    robot.read(estop=True)
    assert robot.state.settle(0)
    assert not robot.state.settle(0)

    raised, changed = robot.outbox.take().events[-2:]
    assert (raised.kind, changed.kind) == ("error.raised", "system_state.changed")
    assert changed.cause == raised.id
    assert robot.state.view().state is SystemState.ERROR


def test_a_vehicle_that_does_not_stand_comes_first_and_is_no_error() -> None:
    robot = Robot()
    robot.read(estop=True)
    robot.state.settle(0)
    robot.outbox.take()
    before = robot.state.view()

    robot.driving.still_moving = Blocker("STILL_MOVING", "1.1 m/s", ("vehicle",))
    robot.state.settle(0)

    outputs, view = robot.outbox.take(), robot.state.view()
    assert outputs.system_state
    assert not outputs.events
    assert [reason.code for reason in view.reasons] == ["STILL_MOVING", "ESTOP"]
    assert (view.state, view.error_code, view.errors) == (
        before.state,
        before.error_code,
        before.errors,
    )


def test_a_task_makes_an_idle_robot_a_running_one_because_of_the_request_itself() -> None:
    robot = Robot()
    robot.read()
    robot.state.settle(0)
    robot.outbox.take()

    robot.read()
    robot.driving.status = TaskStatus.RUNNING_TASK
    robot.state.settle(0)

    read, changed = robot.outbox.take().events
    assert (changed.kind, changed.cause) == ("system_state.changed", read.id)
    assert robot.state.view().state is SystemState.RUNNING
