"""Nodes of ROS 2 in memory, with somebody who listens to them and writes down when."""

import asyncio
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager

from domain.commands import AskFacts, AskParameters, AskTransition
from domain.inputs import NodeAnswer, NodeReport
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import Parameters
from domain.parts.system_model import NodeModel
from domain.state_and_mode import PartName
from domain.timebase import to_seconds
from service.ros.backend.node_watch import NodeMessage
from service.ros.backend.nodes import RosNodes
from tests.support.manual_clock import ManualClock, settle
from tests.support.models import BASE, actuation_model
from tests.support.ros_graph import FakeGraph
from tests.support.ros_nodes import FakeNode

START_PARAMETERS: Parameters = {"max_speed": 0.0, "controller": "none"}
"""What the drive base starts with."""


class HeardNodes:
    """A `RosNodes` that runs, and everything that it delivered.

    Args:
        models: The nodes that it looks for.
    """

    def __init__(self, models: Sequence[NodeModel] = ()) -> None:
        self.clock = ManualClock()
        self.graph = FakeGraph(self.clock)
        nodes = {node.name: node for node in models or actuation_model().nodes.values()}
        self.nodes = RosNodes(nodes, self.graph, self.clock)
        self.heard: list[tuple[float, NodeMessage]] = []
        self._running: asyncio.Task[None] | None = None

    def base(self, *, plain: bool = False, heartbeat: bool = False) -> FakeNode:
        """Start the drive base."""
        return FakeNode(self.graph, BASE, START_PARAMETERS, plain=plain, heartbeat=heartbeat)

    async def listen(self) -> None:
        """Begin to look for the nodes."""
        await self.nodes.start(lambda message: self.heard.append((self.now_s, message)))
        self._running = asyncio.create_task(self.nodes.run())
        await settle()

    async def join(self) -> None:
        """Begin to look for the nodes, let them be found, and forget what was heard of that."""
        await self.listen()
        await self.advance(1.5)
        self.heard.clear()

    async def end(self) -> None:
        """Listen no longer, and end all nodes."""
        if self._running is not None:
            self._running.cancel()
            await asyncio.wait([self._running])
        await self.graph.close()

    async def advance(self, by_s: float) -> None:
        await self.clock.advance(by_s)

    @property
    def now_s(self) -> float:
        return to_seconds(self.clock.now())

    # --- what it is told -------------------------------------------------------------------------

    def ask(self, request: int, transition: Transition, node: PartName = BASE) -> None:
        self.nodes.send(AskTransition(request, node, transition))

    def set(self, request: int, values: Parameters, node: PartName = BASE) -> None:
        self.nodes.send(AskParameters(request, node, values))

    def ask_facts(self, node: PartName = BASE) -> None:
        self.nodes.send(AskFacts(9_999, node))

    # --- what was heard --------------------------------------------------------------------------

    def reports(self, node: PartName = BASE) -> list[NodeReport]:
        return [m for _, m in self.heard if isinstance(m, NodeReport) and m.node == node]

    def states(self, node: PartName = BASE) -> list[LifecycleState | None]:
        return [report.state for report in self.reports(node)]

    def answers(self) -> list[NodeAnswer]:
        return [message for _, message in self.heard if isinstance(message, NodeAnswer)]

    def unreachable_after_s(self, since_s: float) -> float | None:
        """Return how long after a moment the drive base was reported as unreachable."""
        for at_s, message in self.heard:
            if message == NodeReport(BASE, reachable=False):
                return at_s - since_s
        return None

    def requests(self, service: str, since_s: float = 0.0) -> list[float]:
        """Return when the drive base was asked by one of its services, in s."""
        name = f"/{BASE}/{service}"
        return [r.at_s for r in self.graph.requests if r.service == name and r.at_s >= since_s]


@asynccontextmanager
async def heard_nodes() -> AsyncIterator[HeardNodes]:
    """Yield nodes that are not looked for yet, and end them."""
    heard = HeardNodes()
    try:
        yield heard
    finally:
        await heard.end()


def all_facts(
    state: LifecycleState | None, parameters: Parameters | None = None, *, lifecycle: bool = True
) -> NodeReport:
    """Return what the drive base says when it is asked for everything."""
    known = START_PARAMETERS if parameters is None else parameters
    return NodeReport(BASE, state, None, known, reachable=True, has_lifecycle=lifecycle)
