"""Somebody presses the stop at a device: the whole robot stops, and says where the stop is."""

import pytest

from domain.commands import AskRelease, TellStops
from domain.computers import ComputerName, DeviceState, PeerStop, StopId
from domain.devices.settings import DeviceSettings
from domain.errors import BlockedError
from domain.inputs import DeviceStatus, PeerStops
from domain.snapshot import ChangeStatus, ErrorKey, TaskPhase
from domain.supervision import SupervisionSettings
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.kept_values import KeptValues
from tests.support.models import ACTUATION, actuation_model

ARM = ComputerName("arm")
STOP = PeerStop(StopId("0f0f-7"), "bert", "smoke", 0)
SETTINGS = SupervisionSettings(peers=(ARM,), devices={ARM: DeviceSettings(ARM, ())})
AT_ARM = "emergency stop is engaged at device arm"


class Robot(CoreRobot):
    """A robot with a device, which is connected."""

    def __init__(self) -> None:
        super().__init__(actuation_model(), SETTINGS)
        self.read(**GOOD)
        self.connect(DeviceState.CONNECTED)

    def connect(self, state: DeviceState) -> None:
        self.give(DeviceStatus(ARM, state))

    def hear(self, *stops: PeerStop) -> None:
        self.give(PeerStops(ARM, stops))


def test_a_vehicle_that_drives_is_stopped_and_waits() -> None:
    robot = Robot()
    robot.submit_task()
    robot.advance(2)
    assert robot.core.driving.vehicle.command.speed_mps > 0

    robot.hear(STOP)
    assert robot.core.driving.vehicle.command.speed_mps == 0
    assert robot.core.driving.holds["error"].reason == AT_ARM
    robot.read(**GOOD)
    robot.advance(5)
    assert str(robot.task.status) == TaskPhase.PAUSED
    assert robot.core.emergency_stop().standstill_at is not None

    robot.read(**GOOD)
    robot.hear()
    robot.advance(0.5)
    assert str(robot.task.status) == TaskPhase.RUNNING


def test_nothing_is_activated_and_what_refuses_it_says_where_the_stop_is() -> None:
    robot = Robot()
    change = robot.ask_mode(ACTUATION, "MODERATE")
    robot.hear(STOP)
    robot.advance(20)
    assert robot.change(change).status is ChangeStatus.FAILED

    with pytest.raises(BlockedError) as refused:
        robot.ask_mode(ACTUATION, "MODERATE")
    assert [blocker.message for blocker in refused.value.blockers] == [AT_ARM]
    robot.read(**GOOD)
    assert robot.core.system_state().errors == ("ESTOP",)

    robot.connect(DeviceState.LOST)
    view = robot.core.error(ErrorKey(None, "ESTOP"))
    assert view.message == f"{AT_ARM}, which has not been heard"
    assert [reason.message for reason in robot.core.system_state().reasons] == [view.message]

    robot.connect(DeviceState.CONNECTED)
    robot.hear()
    robot.advance(20)
    assert robot.change(change).status is ChangeStatus.FAILED, "nothing is made up for"
    robot.ask_mode(ACTUATION, "MODERATE")


def test_a_stop_of_the_device_that_came_while_it_was_cut_off_outlives_the_release_here() -> None:
    robot = Robot()
    robot.stop("dog")
    robot.connect(DeviceState.LOST)
    robot.release_stop()
    robot.advance(5)
    assert not robot.core.emergency_stop().engaged

    robot.connect(DeviceState.CONNECTED)
    robot.hear(STOP)
    assert robot.core.emergency_stop().engaged
    robot.release_stop()
    assert robot.told_others[-1] == AskRelease(ARM, (STOP.id,))
    robot.hear()
    assert not robot.core.emergency_stop().engaged


def test_a_supervisor_that_starts_while_the_device_is_away_is_stopped_by_its_stop() -> None:
    robot, kept = Robot(), KeptValues()
    kept.take(robot.give(PeerStops(ARM, (STOP,))))

    again = CoreRobot(actuation_model(), SETTINGS)
    again.read(**GOOD)
    again.give(kept.restored())

    assert again.told_others == [TellStops(())]
    assert again.core.emergency_stop().not_heard == (ARM,)
    with pytest.raises(BlockedError):
        again.ask_mode(ACTUATION, "MODERATE")
