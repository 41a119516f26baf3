"""Nodes, vehicle and signals from different places, as one robot."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.commands import AskFacts, Drive, NodeCommand
from domain.inputs import NodeReport, Reading, Readings, VehicleReport
from domain.state_and_mode import PartName
from domain.vehicle import DriveCommand, Pose, VehicleState
from service.composite import CompositeRobot
from service.ports import BackendMessage, Deliver
from service.running import TaskFailedError
from tests.support.manual_clock import settle
from tests.support.models import ARM, BASE

STOP = Drive(DriveCommand(0.0, 0.0))
AT_REST = VehicleReport(VehicleState(Pose(0.0, 0.0, 0.0), 0.0, 0.0))
RELEASED = Readings((Reading("estop", value=False),), "button")


class Adapter:
    """One that says something at the start, and remembers what it is sent."""

    def __init__(self, *says: BackendMessage) -> None:
        self._says = says
        self.sent: list[NodeCommand | Drive] = []
        self.runs = 0
        self.broken = asyncio.Event()

    async def run(self, deliver: Deliver) -> None:
        self.runs += 1
        for message in self._says:
            deliver(message)
        await self.broken.wait()
        raise OSError("no such bus")

    def send(self, command: NodeCommand | Drive, /) -> None:
        self.sent.append(command)


class Robot:
    """A base here, an arm and the vehicle there, and a button."""

    def __init__(self) -> None:
        self.base = Adapter(NodeReport(BASE, reachable=True))
        self.arm_and_vehicle = Adapter(NodeReport(ARM, reachable=True), AT_REST)
        self.button = Adapter(RELEASED)
        self.robot = CompositeRobot(
            {BASE: self.base, ARM: self.arm_and_vehicle}, self.arm_and_vehicle, [self.button]
        )
        self.heard: list[BackendMessage] = []


@pytest.fixture
async def robot() -> AsyncIterator[Robot]:
    robot = Robot()
    run = asyncio.create_task(robot.robot.run(robot.heard.append))
    await settle()
    yield robot
    run.cancel()
    await asyncio.gather(run, return_exceptions=True)


async def test_all_adapters_are_heard(robot: Robot) -> None:
    assert robot.heard == [
        NodeReport(BASE, reachable=True),
        NodeReport(ARM, reachable=True),
        AT_REST,
        RELEASED,
    ]


async def test_an_adapter_with_several_ports_runs_once(robot: Robot) -> None:
    assert robot.arm_and_vehicle.runs == 1


async def test_each_command_goes_where_its_node_or_the_vehicle_is(robot: Robot) -> None:
    robot.robot.send(AskFacts(1, BASE))
    robot.robot.send(AskFacts(2, ARM))
    robot.robot.send(STOP)

    assert robot.base.sent == [AskFacts(1, BASE)]
    assert robot.arm_and_vehicle.sent == [AskFacts(2, ARM), STOP]


async def test_a_command_for_a_node_that_is_nowhere_does_no_harm(robot: Robot) -> None:
    robot.robot.send(AskFacts(1, PartName("nowhere")))

    assert robot.base.sent == robot.arm_and_vehicle.sent == []


def test_a_robot_without_a_vehicle_is_told_to_drive_in_vain() -> None:
    CompositeRobot({}).send(STOP)


async def test_an_adapter_that_breaks_ends_the_robot_and_is_named() -> None:
    robot = Robot()
    robot.button.broken.set()

    with pytest.raises(ExceptionGroup) as raised:
        await robot.robot.run(robot.heard.append)

    (error,) = raised.value.exceptions
    assert isinstance(error, TaskFailedError)
    assert (error.name, str(error.__cause__)) == ("Adapter 3", "no such bus")
