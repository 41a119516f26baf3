"""The lease of one computer on another, by the clock of one of them."""

from domain.link.lease import Lease
from domain.link.settings import LinkSettings
from domain.timebase import Instant, seconds


class Told:
    """A lease that begins held: a beat was sent at 0 s and echoed at 0.1 s."""

    def __init__(self) -> None:
        self.lease = Lease(LinkSettings())
        self.seqs: dict[float, int] = {}
        self.send(0)
        self.hear(0.1, echo_of=0)

    def send(self, at_s: float) -> None:
        self.seqs[at_s] = self.lease.note_sent(seconds(at_s))

    def hear(self, at_s: float, echo_of: float | None = None) -> bool:
        now: Instant = seconds(at_s)
        self.lease.note_heard(now)
        begins = echo_of is not None and self.lease.take_echo(self.seqs[echo_of], now)
        self.lease.judge(now)
        return begins

    def ends(self, at_s: float) -> bool:
        return self.lease.judge(seconds(at_s))


def test_a_lease_begins_with_the_echo_of_a_beat() -> None:
    lease = Lease(LinkSettings())
    seq = lease.note_sent(0)
    lease.note_heard(seconds(0.05))
    heard_only = lease.is_held

    assert lease.take_echo(seq, seconds(0.1))
    assert (heard_only, lease.is_held, lease.round_trip) == (False, True, seconds(0.1))


def test_it_is_late_after_half_a_second_of_silence_and_lost_after_one_and_a_half() -> None:
    told = Told()
    told.send(0.2)
    told.hear(0.3, echo_of=0.2)

    assert told.lease.wake_at() == seconds(0.8)
    assert not told.ends(0.79)
    assert not told.lease.is_late
    assert not told.ends(0.8)
    assert told.lease.is_late
    assert told.lease.wake_at() == seconds(1.7)
    assert told.ends(1.7), "the beat that was echoed was sent 1.5 s ago"
    assert not told.lease.is_held
    assert told.lease.wake_at() is None


def test_who_is_heard_but_does_not_hear_us_is_late_and_lost_just_the_same() -> None:
    told = Told()
    for tenth in range(2, 15):
        told.hear(tenth / 10, echo_of=0)

    assert told.lease.is_late
    assert told.lease.why_late(seconds(1.4)) == "has not heard this computer for 1.3 s"
    assert told.ends(1.5)
    assert told.lease.why_lost(seconds(1.5)) == "does not hear this computer"


def test_a_long_but_steady_delay_is_neither_late_nor_lost() -> None:
    told = Told()
    for tenth in range(1, 50):
        at = tenth / 10
        told.send(at)
        if tenth > 4:
            told.hear(at, echo_of=(tenth - 4) / 10)
            assert told.lease.is_held
            assert not told.lease.is_late, at


def test_what_echoes_a_beat_of_before_the_loss_gives_no_lease_back() -> None:
    told = Told()
    told.send(1.4)
    assert told.ends(1.5)

    assert not told.hear(1.6, echo_of=1.4)
    told.send(1.7)
    assert told.hear(1.8, echo_of=1.7)


def test_an_echo_that_arrives_late_gives_no_lease_back() -> None:
    told = Told()
    assert told.ends(1.5)
    told.send(1.6)

    assert not told.hear(3.1, echo_of=1.6)


def test_an_echo_of_what_was_never_sent_or_was_echoed_counts_for_nothing() -> None:
    told = Told()

    assert not told.lease.take_echo(99, seconds(0.2))
    assert not told.lease.take_echo(-1, seconds(0.2))
    assert not told.lease.take_echo(told.seqs[0], seconds(0.2))
    assert told.lease.round_trip == seconds(0.1)


def test_beats_in_a_burst_are_remembered_up_to_a_bound() -> None:
    lease = Lease(LinkSettings())
    first = lease.note_sent(0)
    last = [lease.note_sent(0) for _ in range(2_000)][-1]

    assert not lease.was_sent_lately(first, 0)
    assert lease.was_sent_lately(last, 0)
    assert not lease.was_sent_lately(last, seconds(1.5))
    assert lease.next_seq == last + 1


def test_of_another_process_nothing_was_heard() -> None:
    told = Told()
    told.ends(1.5)
    told.lease.forget()

    assert told.lease.is_silent(seconds(1.5))
    assert told.lease.heard_at is None
    assert told.lease.why_lost(seconds(1.5)) == "has not been heard yet"


def test_who_is_silent_says_since_when() -> None:
    told = Told()

    assert not told.lease.is_silent(seconds(1.59))
    assert told.lease.is_silent(seconds(1.6))
    assert told.lease.why_lost(seconds(2.2)) == "has not been heard for 2.1 s"
    assert told.lease.why_late(seconds(1)) == "has not been heard for 0.9 s"


def test_without_anything_heard_there_is_no_lease() -> None:
    lease = Lease(LinkSettings())

    assert not lease.take_echo(lease.note_sent(0), 0)
