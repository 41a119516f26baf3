"""What one input leads to, and what caused what."""

from domain.actor import Actor
from domain.commands import AskFacts
from domain.computers import ComputerName
from domain.events.changes import ChangeRequested
from domain.events.health import ErrorRaised, SignalPending, SignalRead
from domain.events.parts import NodeReported
from domain.events.service import TimeWasDue
from domain.identifiers import ChangeId
from domain.outbox import Outbox, Outputs
from domain.state_and_mode import PartName

ARM = PartName("arm")
READ = SignalRead("test", {"battery_level": 0.1})
RAISED = ErrorRaised("BATTERY_LOW", "battery 10 % is below 50 %", 0.1, 0.5)


def test_an_input_from_which_nothing_follows_leaves_no_trace() -> None:
    outbox = Outbox()
    outbox.begin(5, READ, Actor("alice"))
    assert outbox.take() == Outputs()


def test_what_follows_from_an_input_points_at_it() -> None:
    outbox = Outbox()
    outbox.begin(5, READ, Actor("alice"))
    outbox.emit(RAISED)
    read, raised = outbox.take().events
    assert (read.event, read.cause) == (READ, None)
    assert (raised.event, raised.cause) == (RAISED, read.id)


def test_all_events_of_an_input_have_its_time_and_actor() -> None:
    outbox = Outbox()
    outbox.begin(5, READ, actor=Actor("alice"))
    outbox.emit(RAISED)
    assert {(event.at, event.actor.label) for event in outbox.take().events} == {(5, "alice")}


def test_an_input_is_recorded_once_however_much_follows_from_it() -> None:
    outbox = Outbox()
    outbox.begin(5, READ)
    first, second = outbox.record_input(), outbox.record_input()
    outbox.emit(RAISED)
    assert first == second
    assert [event.kind for event in outbox.take().events] == ["signal.read", "error.raised"]


def test_a_nearer_cause_is_told_instead_of_the_input_which_then_leaves_no_trace() -> None:
    outbox = Outbox()
    outbox.begin(5, READ)
    pending = outbox.emit(SignalPending("gps_accuracy", "GPS_LOST"))
    outbox.take()
    outbox.begin(20, TimeWasDue())
    outbox.emit(RAISED, cause=pending)
    (raised,) = outbox.take().events
    assert (raised.kind, raised.cause) == ("error.raised", pending)


def test_the_cause_of_an_input_is_kept() -> None:
    outbox = Outbox()
    outbox.begin(5, NodeReported(ARM), cause=3)
    outbox.record_input()
    assert outbox.take().events[0].cause == 3


def test_a_new_input_is_not_mistaken_for_the_one_before() -> None:
    outbox = Outbox()
    outbox.begin(5, READ, actor=Actor("alice"))
    before = outbox.record_input()
    outbox.begin(6, NodeReported(ARM))
    assert outbox.record_input() != before
    assert [(e.at, e.kind, e.actor.label) for e in outbox.take().events] == [
        (5, "signal.read", "alice"),
        (6, "node.reported", ""),
    ]


def test_ids_rise_by_one_over_all_inputs() -> None:
    outbox = Outbox()
    ids = []
    for at in range(3):
        outbox.begin(at, READ)
        outbox.emit(RAISED)
        ids += [event.id for event in outbox.take().events]
    assert ids == [1, 2, 3, 4, 5, 6]


def test_numbers_of_commands_are_never_given_twice() -> None:
    outbox = Outbox()
    first = outbox.next_request()
    outbox.take()
    assert [first, outbox.next_request(), outbox.next_request()] == [1, 2, 3]


def test_what_was_taken_is_not_there_a_second_time() -> None:
    outbox = Outbox()
    outbox.begin(5, ChangeRequested(ARM))
    outbox.record_input()
    outbox.command(AskFacts(1, ARM))
    outbox.change = ChangeId("c1")
    outbox.parts.add(ARM)
    outbox.signals.add("estop")
    outbox.system_state = True
    taken = outbox.take()
    assert taken.commands == (AskFacts(1, ARM),)
    assert taken.change == ChangeId("c1")
    assert taken.parts == {ARM}
    assert taken.signals == {"estop"}
    assert taken.system_state
    assert outbox.take() == Outputs()


def test_devices_that_changed_are_told_once() -> None:
    outbox = Outbox()
    outbox.devices.add(ComputerName("arm"))

    assert outbox.take().devices == {"arm"}
    assert outbox.take() == Outputs()
