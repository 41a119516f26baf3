"""What is known of a connection follows from the messages that pass."""

from domain.computers import SUPERVISOR, ComputerName, Connection, Incarnation
from domain.link.messages import Beat, Terms
from domain.timebase import Instant, seconds
from service.link.status import LinkStatus

ARM = ComputerName("arm")
OURS = Incarnation("0" * 32)
THEIRS = Incarnation("1" * 32)
BEAT = seconds(0.1)


def sent(seq: int) -> Beat:
    return Beat(SUPERVISOR, OURS, seq, Terms("model", "ownership"))


def heard(seq: int, echo: int = 0, of: Incarnation | None = OURS) -> Beat:
    return Beat(ARM, THEIRS, seq, Terms("model", "ownership"), of, echo)


def at(time_s: float) -> Instant:
    return seconds(1_000.0 + time_s)


def beating(*times_s: float) -> LinkStatus:
    """Return the status of a link on which beats came at these times."""
    status = LinkStatus({ARM: BEAT})
    for seq, time_s in enumerate(times_s, start=1):
        status.note_heard(ARM, heard(seq), at(time_s))
    return status


def test_of_a_computer_that_never_spoke_nothing_is_known() -> None:
    assert LinkStatus({ARM: BEAT}).of(ARM, at(5)) == Connection()


def test_it_tells_when_a_computer_was_last_heard() -> None:
    assert beating(0.0, 0.1).of(ARM, at(3)).heard_at == at(0.1)


def test_where_every_beat_comes_none_is_lost() -> None:
    status = beating(*(n / 10 for n in range(200)))

    assert status.of(ARM, at(19.9)).lost_share == 0


def test_of_three_beats_of_which_one_is_lost_a_third_is() -> None:
    status = beating(*(n / 10 for n in range(300) if n % 3))

    share = status.of(ARM, at(29.9)).lost_share

    assert share is not None
    assert abs(share - 1 / 3) < 0.02


def test_a_computer_that_fell_silent_loses_every_beat_in_the_end() -> None:
    status = beating(*(n / 10 for n in range(100)))

    assert status.of(ARM, at(30)).lost_share == 1


def test_the_round_trip_is_measured_by_the_echo_of_the_newest_beat() -> None:
    status = LinkStatus({ARM: BEAT})
    for seq in (1, 2, 3):
        status.note_sent(ARM, sent(seq), at(seq / 10))
    status.note_heard(ARM, heard(7, echo=2), at(0.25))

    assert status.of(ARM, at(1)).round_trip == seconds(0.25) - seconds(0.2)


def test_an_echo_of_another_run_of_this_computer_measures_nothing() -> None:
    status = LinkStatus({ARM: BEAT})
    status.note_sent(ARM, sent(1), at(0))
    status.note_heard(ARM, heard(7, echo=1, of=THEIRS), at(9))

    assert status.of(ARM, at(9)).round_trip is None


def test_what_cannot_be_read_is_counted() -> None:
    status = LinkStatus({ARM: BEAT})
    status.note_left_out(ARM)

    assert status.of(ARM, at(0)).dropped == 1


def test_a_computer_that_does_not_belong_to_the_robot_is_not_measured() -> None:
    status = LinkStatus({ARM: BEAT})
    stranger = ComputerName("stranger")
    status.note_heard(stranger, heard(1), at(0))
    status.note_sent(stranger, sent(1), at(0))
    status.note_left_out(stranger)

    assert status.of(stranger, at(1)) == Connection()
