"""What is wrong in the ROS graph is told once, and its end."""

import pytest

from domain.graph_faults import MOST, GraphFaults
from domain.graph_terms import GraphFault, GraphFaultKind
from domain.outbox import Outbox, Outputs

SCAN = GraphFault(GraphFaultKind.QOS, "/scan", "no message of /lidar arrives")


class Told:
    """The concern, and what it tells."""

    def __init__(self) -> None:
        self._outbox = Outbox()
        self.concern = GraphFaults(self._outbox)

    def take(self, fault: GraphFault) -> Outputs:
        self.concern.take_fault(fault, 5)
        return self._outbox.take()

    @property
    def known(self) -> list[GraphFault]:
        return list(self.concern.faults.values())


@pytest.fixture
def told() -> Told:
    return Told()


def test_a_fault_is_told_with_its_reason(told: Told) -> None:
    (event,) = told.take(SCAN).events

    assert event.kind == "ros.fault"
    assert event.data == {
        "fault": "qos",
        "name": "/scan",
        "reason": "no message of /lidar arrives",
    }
    assert event.event.words == "/scan: no message of /lidar arrives"
    assert told.known == [SCAN]


def test_a_fault_is_told_once_and_another_reason_anew(told: Told) -> None:
    told.take(SCAN)

    assert told.take(SCAN).events == ()
    assert told.take(GraphFault(GraphFaultKind.QOS, "/scan", "no message of /radar arrives")).events
    assert len(told.known) == 1


def test_the_end_of_a_fault_is_told_once(told: Told) -> None:
    told.take(SCAN)
    (event,) = told.take(GraphFault(GraphFaultKind.QOS, "/scan")).events

    assert (event.kind, event.data) == ("ros.fault_ended", {"fault": "qos", "name": "/scan"})
    assert told.known == []
    assert told.take(GraphFault(GraphFaultKind.QOS, "/scan")).events == ()


def test_a_topic_and_a_node_of_one_name_are_told_apart(told: Told) -> None:
    told.take(SCAN)
    told.take(GraphFault(GraphFaultKind.DUPLICATE, "/scan", "2 nodes have this name"))
    told.take(GraphFault(GraphFaultKind.QOS, "/scan"))

    assert [fault.kind for fault in told.known] == ["duplicate"]


def test_a_graph_where_all_is_wrong_does_not_fill_the_log(told: Told) -> None:
    events = [
        told.take(GraphFault(GraphFaultKind.QOS, f"/{n}", "wrong")).events for n in range(MOST + 50)
    ]

    assert sum(map(len, events)) == len(told.known) == MOST
