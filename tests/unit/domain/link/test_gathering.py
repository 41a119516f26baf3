"""What follows from one step of a link."""

from domain.computers import SUPERVISOR, ComputerName, Incarnation
from domain.inputs import PeerStops
from domain.link.gathering import Gathering
from domain.link.messages import Report
from domain.link.outputs import NOTHING, LinkOutputs, Sending
from tests.support.linked_pair import BASE


def test_it_is_taken_once_in_order() -> None:
    gathering = Gathering()
    stops = [PeerStops(ComputerName(name), ()) for name in ("a", "b")]
    report = Report(BASE, Incarnation("i"), 1, ())
    gathering.send(SUPERVISOR, report)
    for each in stops:
        gathering.give(each)

    assert gathering.take() == LinkOutputs((Sending(SUPERVISOR, report),), tuple(stops))
    assert gathering.take() is NOTHING
