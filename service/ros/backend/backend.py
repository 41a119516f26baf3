"""A robot in ROS 2: its nodes, its signals and its vehicle as one backend."""

import asyncio

from domain.commands import Drive, NodeCommand, PreemptGoal, SendGoal
from domain.inputs import BackendStatus
from domain.parts.system_model import SmhModel
from service.clock import Clock
from service.files.robot_file import RobotSettings
from service.ports import Deliver
from service.ros.backend.delivery import Delivery
from service.ros.backend.diagnostics import ReportedDiagnostics
from service.ros.backend.graph_watch import GraphWatch
from service.ros.backend.navigation_client import NavigationClient
from service.ros.backend.nodes import RosNodes
from service.ros.backend.signals import SignalTopics
from service.ros.backend.topic_statistics import TopicStatistics
from service.ros.backend.vehicle import RosVehicle
from service.ros.graph.graph import RosGraph

_ROOM = 10_000
_ROOM_PER_NODE = 200
"""Capacity for undelivered messages. A busy event loop does not need more, since the graph queues
about a hundred messages of each topic itself.
"""


class Ros2Backend:
    """One adapter for the nodes, the vehicle, the controller and the signals of a robot in ROS 2.

    Only `run` delivers messages: readings of `estop` first, reports of nodes last.
    """

    def __init__(
        self,
        model: SmhModel,
        robot: RobotSettings,
        graph: RosGraph,
        clock: Clock,
    ) -> None:
        """Prepare; nothing is received or sent before `run`.

        Args:
            model: Defines the nodes.
            robot: Defines the topics of signals and vehicle.
            graph: The ROS 2 graph; `run` closes it at its end.
            clock: Of the service.
        """
        self._graph = graph
        self._nodes = RosNodes(model.nodes, graph, clock)
        self._signals = SignalTopics(robot, graph, clock)
        self._statistics = TopicStatistics(robot, graph, clock)
        self._diagnostics = ReportedDiagnostics(robot.ros2.diagnostics, graph)
        self._watch = GraphWatch(graph, clock)
        limits = robot.to_vehicle_limits()
        self._vehicle = RosVehicle(robot.ros2, limits, graph, clock)
        navigation = robot.ros2.navigation
        self._navigation: NavigationClient | None = None
        if navigation is not None:
            self._navigation = NavigationClient(navigation, robot.vehicle.frame_id, graph, clock)
        room = _ROOM + _ROOM_PER_NODE * len(model.nodes)
        self._delivery = Delivery(room, clock)

    async def run(self, deliver: Deliver) -> None:
        """Deliver the messages of nodes, signals and vehicle until cancelled; then leave the graph.

        Raises:
            UnknownTypeError: A type of message or service is not installed.
            ExceptionGroup: `GraphFailedError`: the link to ROS 2 broke.
        """
        try:
            deliver(BackendStatus(available=True))
            hear = self._delivery.put
            self._signals.start(hear)
            self._statistics.start()
            self._diagnostics.start(hear)
            self._vehicle.start(hear)
            if self._navigation is not None:
                self._navigation.start(hear)
            await self._nodes.start(hear)
            async with asyncio.TaskGroup() as group:
                group.create_task(self._graph.wait_failed(), name="link to ROS 2")
                group.create_task(self._nodes.run(), name="nodes")
                group.create_task(self._vehicle.run(), name="vehicle")
                if self._navigation is not None:
                    group.create_task(self._navigation.run(), name="navigation")
                group.create_task(self._statistics.run(hear), name="statistics of topics")
                group.create_task(self._watch.run(hear), name="faults of the graph")
                await self._delivery.run(deliver)
        finally:
            await self._graph.close()

    def send(self, command: NodeCommand | Drive | SendGoal | PreemptGoal, /) -> None:
        """Send a command to a node, to the vehicle or to the external controller."""
        if isinstance(command, Drive):
            self._vehicle.send(command)
        elif isinstance(command, SendGoal | PreemptGoal):
            if self._navigation is not None:
                self._navigation.send(command)
        else:
            self._nodes.send(command)
