"""A device as the supervisor knows it: what it waits for before it is connected."""

from domain.commands import AskFacts
from domain.computers import SUPERVISOR, DeviceState, Incarnation, Session
from domain.inputs import DeviceStatus, Input, NodeAnswer, NodeReport
from domain.lifecycle import LifecycleState
from domain.link.gathering import Gathering
from domain.link.messages import Beat, NodeOrder, Report
from domain.link.peer import Own, Peer, Said
from domain.link.pieces import cut
from domain.link.remote_device import RemoteDevice
from domain.link.settings import LinkSettings, Owned
from domain.link.stops import OwnStops
from domain.timebase import Instant, seconds
from tests.support.linked_pair import BASE, DRIVE, TERMS

WE, IT = Incarnation("we"), Incarnation("it")
FIRST, SECOND = Session("s1"), Session("s2")
ACTIVE = NodeReport(DRIVE, LifecycleState.ACTIVE, reachable=True)


class Heard:
    """The device `base`, whose messages are made by hand."""

    def __init__(self) -> None:
        settings, own = LinkSettings(), Own(SUPERVISOR, WE, TERMS)
        self.now: Instant = 0
        self.peer = Peer(BASE, own, OwnStops(), settings, 0)
        self.device = RemoteDevice(self.peer, own, Owned((DRIVE,)), settings, 0)
        self.gathering = Gathering()
        self.sent = self.peer.beat(Said(), 0)
        self._beats = self._reports = 0

    def beat(self, session: Session = FIRST, process: Incarnation = IT) -> list[Input]:
        self._beats += 1
        echo = self.sent.seq
        beat = Beat(BASE, process, self._beats, TERMS, WE, echo, session)
        self.peer.hear(beat, self.now)
        self.device.take_beat(beat, self.now, self.gathering)
        return self._given()

    def report(
        self, session: Session = FIRST, process: Incarnation = IT, *, complete: bool = True
    ) -> list[Input]:
        self._reports += 1
        report = Report(BASE, process, self._reports, (ACTIVE,), complete, session)
        self.device.take_report(report, self.now, self.gathering)
        return self._given()

    def begins_anew(self) -> None:
        self._reports = 0

    def wait(self, for_s: float) -> list[Input]:
        self.now += seconds(for_s)
        if self.peer.pass_time(self.now):
            self.device.lose()
        self.sent = self.peer.beat(self.device.says(), self.now)
        return self._given()

    def _given(self) -> list[Input]:
        self.device.tell_status(self.now, self.gathering)
        return list(self.gathering.take().inputs)


def connected() -> Heard:
    heard = Heard()
    heard.beat()
    heard.report()
    return heard


def states(given: list[Input]) -> list[DeviceState]:
    return [each.state for each in given if isinstance(each, DeviceStatus)]


def test_it_is_connected_once_it_told_everything() -> None:
    heard = Heard()

    assert heard.beat() == []
    assert heard.report(complete=False) == []
    assert heard.report() == [
        ACTIVE,
        DeviceStatus(
            BASE, DeviceState.CONNECTED, incarnation=IT, session=FIRST, version=TERMS.version
        ),
    ]


def test_a_report_in_pieces_connects_it_with_the_last_piece() -> None:
    heard = Heard()
    heard.beat()
    first, last = cut(Report(BASE, IT, 1, (ACTIVE, ACTIVE), complete=True, session=FIRST), 2)

    heard.device.take_report(first, heard.now, heard.gathering)
    half = heard.device.is_connected
    heard.device.take_report(last, heard.now, heard.gathering)

    assert (half, heard.device.is_connected) == (False, True)


def test_it_is_told_which_session_commands_carry_only_while_it_is_connected() -> None:
    heard = Heard()
    heard.beat()
    waiting = heard.device.says()
    heard.report()
    following = heard.device.says()
    heard.wait(2)

    assert (waiting, following) == (Said(), Said(session=FIRST))
    assert heard.device.says() == Said(renew=FIRST)


def test_after_a_loss_its_old_session_does_not_connect_it() -> None:
    heard = connected()
    lost = heard.wait(2)

    assert states(lost) == [DeviceState.LOST]
    assert lost[1:] == [NodeReport(DRIVE, reachable=False)]
    assert heard.beat(FIRST) == []
    assert heard.report(FIRST) == []
    assert heard.beat(SECOND) == []
    assert states(heard.report(SECOND)) == [DeviceState.CONNECTED]


def test_facts_of_before_the_loss_do_not_connect_it() -> None:
    heard = connected()
    heard.wait(2)
    heard.beat(SECOND)

    assert heard.report(FIRST) == []
    assert not heard.device.is_connected


def test_a_report_that_comes_before_the_beat_of_its_session_waits_for_the_next() -> None:
    heard = Heard()

    assert heard.report() == []
    heard.beat()
    assert states(heard.report()) == [DeviceState.CONNECTED]


def test_another_process_begins_from_nothing() -> None:
    heard = connected()
    heard.wait(2)
    other = Incarnation("other")
    heard.begins_anew()

    assert heard.beat(SECOND, other) == []
    heard.wait(0.1)
    heard.beat(SECOND, other)
    assert states(heard.report(SECOND, other)) == [DeviceState.CONNECTED]


def test_a_beat_for_another_supervisor_says_nothing_of_the_session() -> None:
    heard = Heard()
    beat = Beat(BASE, IT, 1, TERMS, Incarnation("second"), 1, FIRST)
    heard.peer.hear(beat, 0)
    heard.device.take_beat(beat, 0, heard.gathering)

    assert heard.report() == []


def test_a_command_for_a_device_that_told_nothing_yet_says_so() -> None:
    heard = Heard()
    heard.beat()
    heard.device.order(AskFacts(1, DRIVE), 0, heard.gathering)

    reason = "device base has not told yet how its nodes are"
    assert heard.gathering.take().inputs == (NodeAnswer(1, DRIVE, False, reason),)


def test_commands_are_numbered() -> None:
    heard = connected()
    for request in (7, 8):
        heard.device.order(AskFacts(request, DRIVE), 0, heard.gathering)

    sent = [message for _, message in heard.gathering.take().sendings]
    assert sent == [
        NodeOrder(SUPERVISOR, WE, 1, FIRST, AskFacts(7, DRIVE), 1),
        NodeOrder(SUPERVISOR, WE, 2, FIRST, AskFacts(8, DRIVE), 1),
    ]
