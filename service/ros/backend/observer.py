"""Observes the parts of a robot in a ROS 2 graph, without a service; it commands nothing."""

import asyncio
import logging
import os
from collections.abc import Callable

from domain.errors import PilothouseError
from domain.inputs import NodeReport
from domain.parts.observed_parts import AnnouncedTarget, ObservedParts
from domain.parts.system_model import SmhModel
from service.clock import Clock
from service.ros.backend.announced_targets import AnnouncedTargets
from service.ros.backend.node_watch import NodeMessage
from service.ros.backend.nodes import RosNodes
from service.ros.graph.graph import Lane, RosGraph
from service.ros.graph.names import is_allowed

_log = logging.getLogger(__name__)


class RosObserver:
    """Keeps the parts of a model up to date from the ROS 2 graph.

    States and parameters are those of the nodes themselves, watched as by the service; targets are
    those that the service, or another mode manager, announces. Of the nodes it only asks.
    """

    def __init__(self, model: SmhModel, graph: RosGraph, clock: Clock) -> None:
        """Prepare; nothing is received before `run`.

        Args:
            model: Systems and nodes. Those whose name ROS does not allow cannot be observed.
            graph: The ROS 2 graph; `run` closes it at its end.
            clock: For the polling cycle and the times of deviations.
        """
        self.parts = ObservedParts(model)
        self._graph = graph
        self._clock = clock
        self._changed: Callable[[], None] = _nothing
        # Several monitors may run beside the service. A leading underscore hides their nodes from
        # `ros2 node list`, as those of the ROS tools.
        self._ours = f"_pilothouse_monitor_{os.getpid()}_"

    async def run(self, changed: Callable[[], None]) -> None:
        """Observe until cancelled; then leave the graph.

        Args:
            changed: Called after each report and each announced target; must return at once.

        Raises:
            UnknownTypeError: `lifecycle_msgs` or `rcl_interfaces` is not installed.
            ExceptionGroup: `GraphFailedError`: the link to ROS 2 broke.
        """
        self._changed = changed
        model, graph = self.parts.model, self._graph
        odd = [part for part in model.parts if not is_allowed(f"/{part}")]
        if odd:
            _log.warning("not observed, since ROS does not allow the name: %s", ", ".join(odd))
        own_nodes = {name: node for name, node in model.nodes.items() if name not in odd}
        try:
            nodes = RosNodes(own_nodes, graph, self._clock, self._ours)
            node = graph.node(f"{self._ours}{Lane.TARGETS.value}", Lane.TARGETS)
            targets = AnnouncedTargets([p for p in model.parts if p not in odd], graph, node)
            await nodes.start(self._take_message)
            await targets.start(self._take_target)
            async with asyncio.TaskGroup() as group:
                group.create_task(graph.wait_failed(), name="link to ROS 2")
                await nodes.run()
        finally:
            await graph.close()

    def _take_message(self, message: NodeMessage) -> None:
        """Take a report; there are no answers, since no node is commanded."""
        if not isinstance(message, NodeReport):
            return
        try:
            self.parts.take_report(message, self._clock.now())
        except PilothouseError as error:
            _log.warning("ignored a report of %s: %s", message.node, error)
            return
        self._changed()

    def _take_target(self, target: AnnouncedTarget) -> None:
        self.parts.take_target(target, self._clock.now())
        self._changed()


def _nothing() -> None:
    """Do nothing."""
