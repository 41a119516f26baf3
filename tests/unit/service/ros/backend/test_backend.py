import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.commands import AskTransition, Drive
from domain.graph_terms import GraphFault, GraphFaultKind
from domain.inputs import (
    BackendStatus,
    DriveStatus,
    NodeAnswer,
    NodeReport,
    Readings,
    ReportBacklog,
)
from domain.lifecycle import Transition
from domain.vehicle import DriveCommand
from service.files.robot_file import read_robot_file
from service.ports import BackendMessage
from service.ros.backend.backend import Ros2Backend
from service.ros.graph.graph import GraphFailedError, UnknownTypeError
from tests.support.heard_nodes import START_PARAMETERS
from tests.support.manual_clock import ManualClock, settle
from tests.support.models import ARM, BASE, actuation_model
from tests.support.ros_graph import FakeGraph
from tests.support.ros_nodes import FakeNode, parameter_event

ROBOT_FILE = """
backend: ros2
ros2:
  signals:
    estop: {topic: /estop, type: std_msgs/msg/Bool}
  command: {topic: /cmd_vel, type: geometry_msgs/msg/Twist}
"""


class Listening:
    """A backend over a graph in memory, and what was heard of it."""

    def __init__(self, *missing: str) -> None:
        self.clock = ManualClock()
        self.graph = FakeGraph(self.clock, missing)
        model = actuation_model()
        robot = read_robot_file(ROBOT_FILE, model)
        self.backend = Ros2Backend(model, robot, self.graph, self.clock)
        self.heard: list[BackendMessage] = []

    def run(self) -> asyncio.Task[None]:
        return asyncio.create_task(self.backend.run(self.heard.append))

    def of(self, kind: type[BackendMessage]) -> list[BackendMessage]:
        return [message for message in self.heard if isinstance(message, kind)]


async def ended(running: asyncio.Task[None]) -> None:
    running.cancel()
    await asyncio.wait([running])


@pytest.fixture
async def robot() -> AsyncIterator[Listening]:
    """Return a backend that runs and has a drive base."""
    listening = Listening()
    FakeNode(listening.graph, BASE, START_PARAMETERS)
    running = listening.run()
    await listening.clock.advance(0.5)
    yield listening
    await ended(running)


async def test_it_is_there_before_its_nodes(robot: Listening) -> None:
    assert robot.heard[:4] == [
        BackendStatus(available=True),
        DriveStatus(available=True),
        NodeReport(BASE, reachable=False),
        NodeReport(ARM, reachable=False),
    ]


async def test_nodes_are_heard_and_told(robot: Listening) -> None:
    robot.heard.clear()
    robot.backend.send(AskTransition(1, BASE, Transition.CONFIGURE))
    await robot.clock.advance(0.1)

    assert robot.of(NodeAnswer) == [NodeAnswer(1, BASE, True)]
    assert len(robot.of(NodeReport)) == 2


async def test_what_is_wrong_in_the_graph_is_told(robot: Listening) -> None:
    fault = GraphFault(GraphFaultKind.QOS, "/estop", "no message of /button arrives")
    robot.graph.faults.append(fault)
    await robot.clock.advance(1.0)

    assert robot.of(GraphFault) == [fault]


async def test_signals_are_heard(robot: Listening) -> None:
    robot.graph.publish("/estop", {"data": True})
    await settle()

    (readings,) = robot.of(Readings)
    assert isinstance(readings, Readings)
    assert [(item.signal, item.value) for item in readings.items] == [("estop", True)]


async def test_the_vehicle_is_told_to_drive_and_after_half_a_second_to_stand(
    robot: Listening,
) -> None:
    robot.backend.send(Drive(DriveCommand(1.5, 0.0)))
    await robot.clock.advance(0.55)

    speeds = [message["linear"]["x"] for message in robot.graph.published("/cmd_vel")]
    assert speeds == [1.5, 0.0]


async def test_what_comes_at_once_is_delivered_in_its_order_and_lets_others_run(
    robot: Listening,
) -> None:
    robot.heard.clear()
    values = [float(number) for number in range(1_000)]
    for value in values:
        robot.graph.publish("/parameter_events", parameter_event(BASE, {"max_speed": value}))
    await asyncio.sleep(0)
    early = len(robot.heard)
    await settle()

    assert 0 < early < len(values)
    reports = [message for message in robot.heard if isinstance(message, NodeReport)]
    assert reports == [NodeReport(BASE, parameters={"max_speed": v}) for v in values]
    assert robot.heard[-1] == ReportBacklog("ROS nodes", None)


async def test_it_leaves_the_graph_when_it_is_cancelled() -> None:
    listening = Listening()
    running = listening.run()
    await listening.clock.advance(0.5)
    assert not listening.graph.closed

    await ended(running)

    assert running.cancelled()
    assert listening.graph.closed


async def test_a_link_that_breaks_ends_the_run() -> None:
    listening = Listening()
    running = listening.run()
    await listening.clock.advance(0.5)
    listening.graph.fail()
    await asyncio.wait([running])

    error = running.exception()
    assert isinstance(error, ExceptionGroup)
    assert error.subgroup(GraphFailedError) is not None
    assert listening.graph.closed


async def test_a_type_that_is_not_installed_ends_the_run_by_its_name() -> None:
    listening = Listening("std_msgs/msg/Bool")

    with pytest.raises(UnknownTypeError, match="std_msgs/msg/Bool"):
        await listening.backend.run(listening.heard.append)

    assert listening.graph.closed


async def test_what_is_sent_before_its_run_does_no_harm() -> None:
    listening = Listening()
    listening.backend.send(AskTransition(1, BASE, Transition.CONFIGURE))
    listening.backend.send(Drive(DriveCommand(1.0, 0.0)))
    running = listening.run()
    await listening.clock.advance(0.1)
    await ended(running)

    assert listening.of(NodeAnswer) == []
