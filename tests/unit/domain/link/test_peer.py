"""What one computer knows of another: who answers by its name, and how well."""

from dataclasses import replace

from domain.computers import SUPERVISOR, ComputerName, DeviceState, Incarnation
from domain.link.messages import Beat, Refused, Terms
from domain.link.peer import Heard, Own, Peer, Said
from domain.link.settings import LinkSettings
from domain.link.stops import OwnStops
from domain.timebase import Instant, seconds
from tests.support.linked_pair import BASE, TERMS

WE = Incarnation("we")
A, B = Incarnation("a"), Incarnation("b")
OTHER_TERMS = replace(TERMS, model="n")


class Wire:
    """What the supervisor knows of the device `base`; beats of it are made by hand."""

    def __init__(self, name: ComputerName = BASE) -> None:
        self.now: Instant = 0
        self.peer = Peer(name, Own(SUPERVISOR, WE, TERMS), OwnStops(), LinkSettings(), 0)
        self.sent = self.peer.beat(Said(), 0)
        self._seqs: dict[Incarnation, int] = {}

    def wait(self, for_s: float) -> None:
        self.now += seconds(for_s)
        self.peer.pass_time(self.now)
        self.sent = self.peer.beat(Said(), self.now)

    def hear(
        self,
        process: Incarnation,
        terms: Terms = TERMS,
        refused: tuple[Refused, ...] = (),
        *,
        echoes: bool = True,
        skips: int = 0,
    ) -> Heard:
        """Hear the next beat of a process, which echoes the last one that we sent."""
        seq = self._seqs[process] = self._seqs.get(process, 0) + 1 + skips
        beat = Beat(self.peer.name, process, seq, terms, refused=refused)
        if echoes:
            beat = replace(beat, heard=WE, heard_seq=self.sent.seq)
        return self.peer.hear(beat, self.now)


def test_the_first_process_that_fits_is_dealt_with_and_leased_once_it_echoes() -> None:
    wire = Wire()

    assert wire.hear(A, echoes=False) is Heard.NEWS
    assert wire.peer.incarnation == A
    assert wire.peer.state() is DeviceState.NEVER_SEEN
    assert wire.hear(A) is Heard.LEASE
    assert wire.peer.state() is DeviceState.CONNECTED
    assert wire.peer.reason(wire.now) == ""


def test_our_beat_echoes_the_newest_one_that_was_heard() -> None:
    wire = Wire()
    wire.hear(A)
    wire.hear(A, skips=3)
    wire.wait(0.1)

    assert (wire.sent.heard, wire.sent.heard_seq) == (A, 5)
    assert (wire.peer.beats_heard, wire.peer.beats_missed) == (2, 3)


def test_a_beat_of_before_is_nothing() -> None:
    wire = Wire()
    wire.hear(A, skips=8)
    old = Beat(BASE, A, 3, TERMS, heard=WE, heard_seq=wire.sent.seq)

    assert wire.peer.hear(old, wire.now) is Heard.NOTHING


def test_nobody_takes_the_place_of_a_process_that_lives() -> None:
    wire = Wire()
    wire.hear(A)
    for _ in range(30):
        wire.wait(0.1)
        wire.hear(B)
        wire.hear(A)

    assert wire.peer.incarnation == A
    assert wire.peer.refused == "another process is device base"
    assert [refused.code for refused in wire.peer.beat(Said(), wire.now).refused] == [
        "DEVICE_CONFLICT"
    ]


def test_a_second_supervisor_has_a_code_of_its_own() -> None:
    wire = Wire(SUPERVISOR)
    for _ in range(3):
        wire.hear(A)
        wire.hear(B)
        wire.wait(0.1)

    assert wire.sent.refused[0].code == "SECOND_SUPERVISOR"


def test_a_process_waits_until_the_other_was_silent_for_long_enough() -> None:
    wire = Wire()
    wire.hear(A)
    wire.wait(1.4)
    wire.hear(B)
    waiting = (wire.peer.incarnation, wire.peer.refused)
    wire.wait(0.1)
    wire.hear(B)

    assert waiting == (A, "")
    assert wire.peer.incarnation == B
    assert wire.peer.state() is DeviceState.CONNECTED


def test_a_process_that_is_not_known_to_live_is_no_conflict() -> None:
    wire = Wire()
    wire.hear(A)
    for _ in range(5):
        wire.wait(0.1)
        wire.hear(B, echoes=False)
        wire.hear(A)

    assert wire.peer.refused == ""


def test_a_beat_of_before_of_a_process_that_waits_is_nothing() -> None:
    wire = Wire()
    wire.hear(A)
    wire.hear(B, skips=8)
    old = Beat(BASE, B, 3, OTHER_TERMS)

    assert wire.peer.hear(old, wire.now) is Heard.NOTHING
    assert wire.peer.refused == ""


def test_a_process_that_does_not_fit_is_refused_at_once_and_forgotten_when_silent() -> None:
    wire = Wire()
    wire.hear(B, OTHER_TERMS)
    state, reason = wire.peer.state(), wire.peer.reason(wire.now)
    wire.wait(1.5)

    assert (state, reason) == (
        DeviceState.CONFLICT,
        "device base is not dealt with: it runs another model",
    )
    assert wire.peer.incarnation is None
    assert wire.peer.state() is DeviceState.NEVER_SEEN
    assert wire.peer.reason(wire.now) == "device base has not been heard yet"


def test_a_misfit_beside_the_process_that_is_dealt_with_changes_nothing_but_a_note() -> None:
    wire = Wire()
    wire.hear(A)
    wire.hear(B, OTHER_TERMS)

    assert wire.peer.state() is DeviceState.CONNECTED
    assert wire.peer.refused == "it runs another model"


def test_who_says_that_it_refuses_us_is_in_conflict_until_it_says_so_no_more() -> None:
    wire = Wire()
    told = Refused(WE, "OTHER_MODEL", "it runs another model")
    wire.hear(A, refused=(Refused(B, "OTHER_MODEL", "x"),), echoes=False)
    others = wire.peer.state()
    wire.hear(A, refused=(told,), echoes=False)
    refused = wire.peer.state()
    wire.hear(A, echoes=False)

    assert (others, refused) == (DeviceState.NEVER_SEEN, DeviceState.CONFLICT)
    assert wire.peer.state() is DeviceState.NEVER_SEEN


def test_a_refusal_of_somebody_who_went_silent_counts_no_more() -> None:
    wire = Wire()
    wire.hear(A, refused=(Refused(WE, "OTHER_MODEL", "x"),), echoes=False)
    wakes: Instant = wire.peer.lease.heard_at or 0
    wire.wait(1.5)

    assert wire.peer.state() is DeviceState.NEVER_SEEN
    assert wakes + seconds(1.5) == wire.now


def test_a_process_that_was_replaced_comes_back_like_any_other() -> None:
    wire = Wire()
    wire.hear(A)
    wire.wait(1.5)
    wire.hear(B)
    wire.wait(1.5)

    assert wire.hear(A) is Heard.LEASE
    assert wire.peer.incarnation == A


def test_it_wakes_for_the_next_beat_and_for_what_ends() -> None:
    wire = Wire()
    beat = wire.peer.wake_at()
    wire.hear(A)
    wire.peer.next_beat_at = seconds(100)
    late = wire.peer.wake_at()
    wire.peer.pass_time(seconds(0.5))
    lost = wire.peer.wake_at()
    ended = wire.peer.pass_time(lost)

    assert (beat, late, lost, ended) == (seconds(0.1), seconds(0.5), seconds(1.5), True)
    assert wire.peer.reason(lost) == "device base has not been heard for 1.5 s"
