"""Looks for what is wrong in the ROS graph: topics whose ends do not match, and doubled names.

ROS 2 tells neither: a topic with such ends just stays silent, and of two nodes with one name an
arbitrary one gets each request. Imports no ROS.
"""

import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from domain.graph_terms import GraphFault, GraphFaultKind

TOPICS_AT_ONCE = 10
"""Topics that one look goes through: each takes 0.1 ms and more, and fifty nodes have a hundred."""

_UNKNOWN = "_NODE_NAME_UNKNOWN_"
"""What an end has as name of its node while that is being discovered."""

Judge: TypeAlias = Callable[[Any, Any], str]
"""Takes what a publisher offers and what a subscription requests; returns why the latter hears
nothing of the former; empty: it hears it."""


@dataclass(frozen=True, slots=True)
class End:
    """One end of a topic that is ours."""

    topic: str
    type_name: str
    profile: Any
    """Its quality of service."""
    publishes: bool


class Survey:
    """The ends of topics that are ours, and what was wrong with each when it was looked at last."""

    def __init__(self, judge: Judge) -> None:
        """Prepare.

        Args:
            judge: Compares the quality of service of two ends.
        """
        self._judge = judge
        self._lock = threading.Lock()
        self._ends: dict[tuple[str, bool], End] = {}
        self._next = 0
        self._found: dict[tuple[str, bool], GraphFault] = {}

    def add(self, end: End) -> None:
        """Look at this end, too; may be used from any thread."""
        with self._lock:
            self._ends[end.topic, end.publishes] = end

    def look(self, node: Any) -> Sequence[GraphFault]:  # noqa: ANN401  # of rclpy
        """Look at some more topics and at all names; return all faults that are known now.

        Args:
            node: Knows the graph.
        """
        for end in self._some():
            key = end.topic, end.publishes
            fault = self._fault_of(end, node)
            if fault is None:
                self._found.pop(key, None)
            else:
                self._found[key] = fault
        return (*self._found.values(), *_doubled(node.get_node_names_and_namespaces()))

    def _some(self) -> list[End]:
        with self._lock:
            ends = list(self._ends.values())
        if self._next >= len(ends):
            self._next = 0
        begin, self._next = self._next, self._next + TOPICS_AT_ONCE
        return ends[begin : self._next]

    def _fault_of(self, end: End, node: Any) -> GraphFault | None:  # noqa: ANN401
        """Return what is wrong with the first other end that does not match."""
        if end.publishes:
            others = node.get_subscriptions_info_by_topic(end.topic)
        else:
            others = node.get_publishers_info_by_topic(end.topic)
        known = (other for other in others if other.node_name != _UNKNOWN)
        return next(self._faults(end, known), None)

    def _faults(self, end: End, others: Iterable[Any]) -> Iterator[GraphFault]:
        for other in others:
            who = _full_name(other.node_name, other.node_namespace)
            if other.topic_type != end.type_name:
                verb = "subscribes to" if end.publishes else "publishes"
                words = f"{who} {verb} {other.topic_type}, and Pilothouse has {end.type_name}"
                yield GraphFault(GraphFaultKind.TYPE, end.topic, words)
                continue
            ends = (end.profile, other.qos_profile)
            why = self._judge(*(ends if end.publishes else ends[::-1]))
            if why:
                arrives = "no message reaches" if end.publishes else "no message arrives from"
                yield GraphFault(GraphFaultKind.QOS, end.topic, f"{arrives} {who}: {why}")


def _doubled(names: Iterable[tuple[str, str]]) -> Iterator[GraphFault]:
    """Yield the nodes that have one name with another one."""
    counts = Counter(_full_name(name, namespace) for name, namespace in names)
    for name, count in counts.items():
        if count > 1:
            yield GraphFault(GraphFaultKind.DUPLICATE, name, f"{count} nodes have this name")


def _full_name(name: str, namespace: str) -> str:
    return f"{namespace.rstrip('/')}/{name}"
