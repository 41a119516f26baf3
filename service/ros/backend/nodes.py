"""All nodes of the robot: one watch each, and one common polling cycle.

Polling fifty nodes costs almost nothing in one burst, and a third of a core if it is spread evenly;
so all are polled at the same time.
"""

import asyncio
from collections.abc import Callable, Mapping
from functools import partial

from domain.commands import NodeCommand
from domain.inputs import NodeAnswer
from domain.lifecycle import LifecycleState
from domain.parameters import ParameterValue
from domain.parts.system_model import NodeModel
from domain.state_and_mode import PartName, part_name
from service.clock import Clock
from service.ros.backend.node_services import Askers, NodeServices, read_parameters, read_state
from service.ros.backend.node_watch import LOOK_PERIOD, NodeMessage, NodeWatch, Work
from service.ros.graph.graph import Lane, Message, Qos, RosGraph, RosNode

_OURS = "pilothouse_"
HEARTBEAT_LEASE_S = 0.5
"""Liveliness lease of the heartbeat topic of a node, s: its death is noticed after this time."""


class RosNodes:
    """The nodes of a model as nodes of ROS 2, with a lifecycle or with parameters only.

    A dead node is reported within 3 s: it is polled once a second, and is unreachable when two
    queries in a row time out after 0.8 s. A node with a heartbeat (a publisher of
    `std_msgs/msg/Empty` on `/{node}/heartbeat` with automatic liveliness and a lease of 0.5 s or
    less) is reported within 1 s. Without a heartbeat, a node whose callback blocks its only thread
    for longer than 2 s is unreachable meanwhile, since it looks like a dead one.
    """

    def __init__(
        self,
        nodes: Mapping[PartName, NodeModel],
        graph: RosGraph,
        clock: Clock,
        ours: str = _OURS,
    ) -> None:
        """Prepare.

        Args:
            nodes: The nodes of the model, by name.
            graph: The ROS 2 graph.
            clock: For the polling cycle.
            ours: Prefix of the names of our own nodes, which have the clients and subscriptions.
        """
        self._ours = ours
        self._nodes = nodes
        self._graph = graph
        self._clock = clock
        self._watches: dict[PartName, NodeWatch] = {}
        self._group: asyncio.TaskGroup | None = None
        self._deliver: Callable[[NodeMessage], None]

    async def start(self, deliver: Callable[[NodeMessage], None]) -> None:
        """Subscribe to the nodes; each is reported as unreachable until it answers.

        Args:
            deliver: Gets reports and answers on the event loop's thread; it must not raise.

        Raises:
            UnknownTypeError: A type of message or service is not installed.
        """
        self._deliver = deliver
        ours = Askers(
            states=self._node(Lane.STATES),
            transitions=self._node(Lane.TRANSITIONS),
            parameters=self._node(Lane.PARAMETERS),
        )
        listening = self._node(Lane.LIVELINESS)
        for name, node in self._nodes.items():
            services = NodeServices(name, ours)
            watch = NodeWatch(node, services, self._clock, deliver, self._start)
            self._watches[name] = watch
            ours.states.subscribe(
                f"/{name}/transition_event",
                "lifecycle_msgs/msg/TransitionEvent",
                Qos.EVENTS,
                _pick_transition,
                partial(_take_transition, watch),
            )
            listening.watch_liveliness(
                f"/{name}/heartbeat", "std_msgs/msg/Empty", HEARTBEAT_LEASE_S, watch.take_heartbeat
            )
            # Making clients for fifty nodes takes almost a second; other tasks must keep running.
            await asyncio.sleep(0)
        ours.parameters.subscribe(
            "/parameter_events",
            "rcl_interfaces/msg/ParameterEvent",
            Qos.PARAMETER_EVENTS,
            partial(_pick_parameters, frozenset(self._nodes)),
            self._take_parameters,
        )

    async def run(self) -> None:
        """Discover and poll the nodes, until cancelled; called once, after `start`."""
        async with asyncio.TaskGroup() as group:
            self._group = group
            try:
                await self._look_forever()
            finally:
                self._group = None

    def send(self, command: NodeCommand) -> None:
        """Send a command to a node at once, whatever other requests are pending."""
        watch = self._watches.get(command.node)
        if self._group is None:
            # Before the start or after the end nothing takes the answer.
            return
        if watch is None:
            self._deliver(NodeAnswer(command.request, command.node, False, "there is no such node"))
        else:
            watch.send(command)

    def _node(self, lane: Lane) -> RosNode:
        return self._graph.node(f"{self._ours}{lane.value}", lane)

    async def _look_forever(self) -> None:
        at = self._clock.now()
        while True:
            for watch in self._watches.values():
                watch.look()
            at = max(at + LOOK_PERIOD, self._clock.now())
            await self._clock.sleep_until(at)

    def _start(self, work: Work) -> bool:
        if self._group is None:
            return False
        self._group.create_task(work())
        return True

    def _take_parameters(self, said: tuple[PartName, dict[str, ParameterValue]]) -> None:
        name, values = said
        self._watches[name].take_parameters(values)


def _pick_transition(message: Message) -> tuple[LifecycleState, LifecycleState]:
    return read_state(message.start_state), read_state(message.goal_state)


def _take_transition(watch: NodeWatch, states: tuple[LifecycleState, LifecycleState]) -> None:
    watch.take_transition(*states)


def _pick_parameters(
    nodes: frozenset[PartName], message: Message
) -> tuple[PartName, dict[str, ParameterValue]] | None:
    """Return the node and the parameters it set; None: another node, or no parameters."""
    name = part_name(message.node)
    if name not in nodes:
        return None
    values = read_parameters((*message.new_parameters, *message.changed_parameters))
    return (name, values) if values else None
