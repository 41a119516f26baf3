"""Tells what is wrong in the ROS graph, once it has lasted."""

from collections.abc import Callable, Sequence
from typing import TypeAlias

from domain.graph_terms import GraphFault, GraphFaultKind
from domain.timebase import Duration, Instant, seconds
from service.clock import Clock
from service.ros.graph.graph import RosGraph

LOOK_PERIOD: Duration = seconds(1.0)
DOUBLED_FOR: Duration = seconds(30.0)
"""A process that was killed stays in the graph for some 20 s, beside the one that replaces it."""


_Key: TypeAlias = tuple[str, str]


class GraphWatch:
    """Looks at the graph once a second, and delivers what begins or ends to be wrong."""

    def __init__(self, graph: RosGraph, clock: Clock) -> None:
        self._graph = graph
        self._clock = clock
        self._since: dict[_Key, Instant] = {}
        """Since when each fault was seen in every look."""
        self._told: dict[_Key, GraphFault] = {}

    async def run(self, deliver: Callable[[GraphFault], None]) -> None:
        """Deliver until cancelled."""
        while True:
            for fault in self._news(await self._graph.look()):
                deliver(fault)
            await self._clock.sleep_until(self._clock.now() + LOOK_PERIOD)

    def _news(self, seen: Sequence[GraphFault]) -> list[GraphFault]:
        """Return what has to be told after a look."""
        now = self._clock.now()
        faults: dict[_Key, GraphFault] = {(fault.kind, fault.name): fault for fault in seen}
        self._since = {key: self._since.get(key, now) for key in faults}
        lasting = {key: fault for key, fault in faults.items() if self._has_lasted(fault, now)}
        over = [old for key, old in self._told.items() if key not in faults]
        found = [fault for key, fault in lasting.items() if self._told.get(key) != fault]
        self._told = lasting
        return [*(GraphFault(old.kind, old.name) for old in over), *found]

    def _has_lasted(self, fault: GraphFault, now: Instant) -> bool:
        since = self._since[fault.kind, fault.name]
        return fault.kind is not GraphFaultKind.DUPLICATE or now - since >= DOUBLED_FOR
