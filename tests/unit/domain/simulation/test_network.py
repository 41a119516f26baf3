from itertools import pairwise

import pytest

from domain.computers import SUPERVISOR, ComputerName
from domain.simulation.network import PERFECT, RETRANSMISSION, SimulatedNetwork, Wire
from domain.timebase import Instant, seconds

START = seconds(50.0) + 3
BASE = ComputerName("base")
ARM = ComputerName("arm")
LATER = seconds(3600.0)


class Computers:
    """Sends numbers from the base to the supervisor, and notes what arrives."""

    def __init__(self, wire: Wire = PERFECT, seed: int = 7) -> None:
        self.network = SimulatedNetwork[int](seed)
        self.network.set_wire(START, BASE, SUPERVISOR, wire)

    def send(self, at: Instant, message: int, *, may_be_lost: bool = False) -> None:
        self.network.send(at, BASE, SUPERVISOR, message, may_be_lost=may_be_lost)

    def send_all(self, count: int, *, may_be_lost: bool = False) -> None:
        """Send one each 10 ms."""
        for number in range(count):
            self.send(START + number * seconds(0.01), number, may_be_lost=may_be_lost)

    def arrived(self, until: Instant = START + LATER) -> list[int]:
        return [arrival.message for arrival in self.network.arrivals(until)]


@pytest.mark.parametrize("may_be_lost", [False, True])
def test_a_perfect_wire_delivers_at_once_and_in_order(may_be_lost: bool) -> None:
    computers = Computers()

    for number in range(5):
        computers.send(START, number, may_be_lost=may_be_lost)

    assert computers.network.wake_at() == START
    assert computers.arrived(START) == [0, 1, 2, 3, 4]
    assert computers.network.wake_at() is None


def test_an_arrival_says_from_whom_and_when() -> None:
    computers = Computers(Wire(delay=seconds(0.2)))

    computers.send(START, 1, may_be_lost=True)

    [arrival] = computers.network.arrivals(START + seconds(0.2))
    assert (arrival.sender, arrival.to) == (BASE, SUPERVISOR)
    assert arrival.at == START + seconds(0.2)
    assert arrival.may_be_lost


def test_a_message_is_under_way_for_the_delay() -> None:
    computers = Computers(Wire(delay=seconds(0.2)))

    computers.send(START, 1)

    assert computers.arrived(START + seconds(0.2) - 1) == []
    assert computers.network.wake_at() == START + seconds(0.2)
    assert computers.arrived(START + seconds(0.2)) == [1]


def test_a_direction_is_as_it_was_set_and_the_other_one_is_not() -> None:
    computers = Computers(Wire(is_cut=True))

    computers.send(START, 1)
    computers.network.send(START, SUPERVISOR, BASE, 2, may_be_lost=False)

    assert computers.arrived() == [2]


def test_what_may_be_lost_is_lost_as_often_as_set() -> None:
    computers = Computers(Wire(loss=0.3))

    computers.send_all(1_000, may_be_lost=True)

    assert 650 <= len(computers.arrived()) <= 750


def test_what_must_not_be_lost_is_sent_again_and_all_behind_it_waits() -> None:
    computers = Computers(Wire(loss=0.3))

    computers.send_all(100)

    arrivals = computers.network.arrivals(START + LATER)
    assert [arrival.message for arrival in arrivals] == list(range(100))
    assert max(b.at - a.at for a, b in pairwise(arrivals)) > (RETRANSMISSION - seconds(0.02))


def test_even_a_wire_that_loses_everything_delivers_in_the_end_what_must_not_be_lost() -> None:
    computers = Computers(Wire(loss=1.0))

    computers.send(START, 1)

    assert computers.arrived(START + seconds(20.0)) == [1]


def test_jitter_lets_only_what_may_be_lost_overtake() -> None:
    wire = Wire(jitter=seconds(0.1))
    beats, reports = Computers(wire), Computers(wire)

    beats.send_all(50, may_be_lost=True)
    reports.send_all(50)

    overtaken = beats.arrived()
    assert overtaken != list(range(50))
    assert sorted(overtaken) == list(range(50))
    assert reports.arrived() == list(range(50))


def test_a_second_copy_may_come_after_later_messages() -> None:
    computers = Computers(Wire(duplication=0.5, duplicate_delay=seconds(1.0)))

    computers.send_all(100)

    arrived = computers.arrived()
    assert 130 <= len(arrived) <= 170
    assert list(dict.fromkeys(arrived)) == list(range(100))
    assert arrived != sorted(arrived)


def test_a_cut_loses_what_is_sent_during_it() -> None:
    computers = Computers(Wire(is_cut=True))

    computers.send(START, 1)
    computers.network.set_wire(START + seconds(1.0), BASE, SUPERVISOR, PERFECT)
    computers.send(START + seconds(2.0), 2)

    assert computers.arrived() == [2]


def test_what_was_under_way_when_a_cut_began_arrives() -> None:
    computers = Computers(Wire(delay=seconds(0.2)))

    computers.send(START, 1)
    computers.network.set_wire(START, BASE, SUPERVISOR, Wire(is_cut=True))

    assert computers.arrived() == [1]


def test_a_cut_may_deliver_afterwards_what_must_not_be_lost() -> None:
    computers = Computers(Wire(is_cut=True, keeps=True))
    end = START + seconds(10.0)

    computers.send(START, 1)
    computers.send(START, 2, may_be_lost=True)
    computers.send(START, 3)
    computers.network.set_wire(end, BASE, SUPERVISOR, Wire(delay=seconds(0.1)))
    computers.send(end, 4)

    assert computers.arrived(end) == []
    assert computers.arrived(end + seconds(0.1)) == [1, 3, 4]


def test_a_cut_that_changes_its_kind_goes_on_keeping_what_it_kept() -> None:
    computers = Computers(Wire(is_cut=True, keeps=True))

    computers.send(START, 1)
    computers.network.set_wire(START, BASE, SUPERVISOR, Wire(is_cut=True))
    computers.network.set_wire(START, BASE, SUPERVISOR, PERFECT)

    assert computers.arrived() == [1]


def test_a_computer_that_is_killed_takes_along_what_is_under_way() -> None:
    computers = Computers(Wire(delay=seconds(1.0)))
    network = computers.network
    network.set_wire(START, ARM, BASE, Wire(is_cut=True, keeps=True))

    computers.send(START, 1)
    network.send(START, ARM, BASE, 2, may_be_lost=False)
    network.send(START, ARM, SUPERVISOR, 3, may_be_lost=False)
    network.forget(BASE)
    network.set_wire(START, ARM, BASE, PERFECT)

    assert computers.arrived() == [3]


def test_the_network_is_empty_once_the_last_message_has_arrived() -> None:
    computers = Computers(Wire(delay=seconds(0.2)))
    assert computers.network.empty_at() is None

    computers.send(START, 1)
    computers.send(START + seconds(0.1), 2)

    assert computers.network.empty_at() == START + seconds(0.3)


def test_the_same_seed_leads_to_the_same_arrivals() -> None:
    wire = Wire(
        delay=seconds(0.05), jitter=seconds(0.2), loss=0.3, duplication=0.1, duplicate_delay=9
    )
    first, second, other = Computers(wire), Computers(wire), Computers(wire, seed=8)

    for computers in (first, second, other):
        computers.send_all(200, may_be_lost=True)

    arrivals = first.network.arrivals(START + LATER)
    assert arrivals == second.network.arrivals(START + LATER)
    assert arrivals != other.network.arrivals(START + LATER)
