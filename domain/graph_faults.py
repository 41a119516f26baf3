"""What is wrong in the ROS graph; nothing is stopped for it: what is missed tells of itself."""

from collections.abc import Mapping

from domain.concern import Concern, Takers
from domain.events.service import GraphFaultEnded, GraphFaultFound
from domain.graph_terms import GraphFault
from domain.outbox import Outbox
from domain.timebase import Instant

MOST = 100
"""Faults that are known at once; more of them have one cause, and are not told."""


class GraphFaults(Concern):
    """Tells each fault once, and its end."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._faults: dict[tuple[str, str], GraphFault] = {}

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {GraphFault: self.take_fault}

    @property
    def faults(self) -> Mapping[tuple[str, str], GraphFault]:
        """Return the faults by kind and name, in the order in which they were found."""
        return self._faults

    def take_fault(self, fault: GraphFault, now: Instant) -> None:
        """Take that something is wrong, or is right again; only a change is told."""
        key = (fault.kind, fault.name)
        known = self._faults.get(key)
        if known == fault or (known is None and (not fault.reason or len(self._faults) >= MOST)):
            return
        if fault.reason:
            self._faults[key] = fault
            self._outbox.begin(now, GraphFaultFound(fault.kind, fault.name, fault.reason))
        else:
            del self._faults[key]
            self._outbox.begin(now, GraphFaultEnded(fault.kind, fault.name))
        self._outbox.record_input()
