"""What is known of each error: since when, how often, and which was first."""

import pytest

from domain.events.health import ErrorCleared, ErrorRaised
from domain.health.error_causes import ErrorCauses
from domain.health.error_list import NORMAL, ErrorList, Found
from domain.kept import KeptUnacknowledged
from domain.outbox import Outbox
from domain.parts.system_model import NodeModel, SmhModel
from domain.snapshot import ErrorKey, ErrorState, Severity
from domain.state_and_mode import PartName

LOST = ErrorKey(PartName("arm"), "UNREACHABLE")
OFF = ErrorKey(PartName("base"), "DEVIATES")
LOW = ErrorKey(None, "BATTERY_LOW")
S = ErrorState


def on(message: str = "it is so", state: ErrorState = S.ACTIVE) -> Found:
    return Found(state, message)


@pytest.fixture
def errors() -> ErrorList:
    return ErrorList(Outbox())


def test_an_error_that_was_never_raised_is_normal_with_its_severity(errors: ErrorList) -> None:
    view = errors.view(LOST)
    assert (view.state, view.severity, view.since, view.count) == (S.NORMAL, "urgent", None, 0)
    assert errors.view(OFF).severity is Severity.WARNING
    assert errors.view(LOW).severity is Severity.CRITICAL
    assert not errors.open_ones()


def test_an_error_keeps_since_when_it_is_on_while_what_was_found_changes(errors: ErrorList) -> None:
    errors.note(LOST, on("gone"), 5)
    errors.note(LOST, on("still gone"), 9)
    view = errors.view(LOST)
    assert (view.since, view.message, view.count) == (5, "still gone", 1)


def test_an_error_counts_how_often_it_was_raised_and_pending_does_not_count(
    errors: ErrorList,
) -> None:
    for at in (10, 20):
        errors.note(OFF, on(state=S.PENDING), at)
        assert errors.view(OFF).since == at
        assert not errors.is_on(OFF)
        errors.note(OFF, on(), at + 1)
        assert errors.view(OFF).since == at + 1
        errors.note(OFF, NORMAL, at + 2)
        assert (errors.view(OFF).state, errors.view(OFF).since) == (S.RETURNED, at + 1)
    errors.acknowledge(OFF)
    assert (errors.view(OFF).count, errors.view(OFF).since) == (2, None)


def test_acknowledging_raises_nothing_anew(errors: ErrorList) -> None:
    errors.note(LOW, on(), 5)
    errors.acknowledge(LOW)
    assert errors.view(LOW).state is S.ACKNOWLEDGED
    errors.note(LOW, on(state=S.LATCHED), 9)
    assert (errors.view(LOW).since, errors.view(LOW).count) == (5, 1)
    assert errors.is_on(LOW)


def test_the_first_error_since_none_was_on_is_first_out_even_after_its_end(
    errors: ErrorList,
) -> None:
    errors.note(LOST, on(), 5)
    errors.note(OFF, on(), 6)
    errors.note(LOST, NORMAL, 7)
    assert errors.view(LOST).first_out
    assert not errors.view(OFF).first_out


def test_when_all_errors_have_ended_the_next_one_is_first_out(errors: ErrorList) -> None:
    errors.note(LOST, on(), 5)
    errors.note(LOST, NORMAL, 7)
    assert not errors.view(LOST).first_out
    errors.note(OFF, on(), 8)
    assert errors.view(OFF).first_out


def test_a_pending_error_is_not_first_out(errors: ErrorList) -> None:
    errors.note(OFF, on(state=S.PENDING), 4)
    errors.note(LOST, on(), 5)
    assert errors.view(LOST).first_out


def test_only_a_difference_is_a_change() -> None:
    outbox = Outbox()
    errors = ErrorList(outbox)
    errors.note(LOST, NORMAL, 1)
    assert not outbox.errors
    errors.note(LOST, on(), 1)
    assert outbox.take().errors == {LOST}
    view = errors.view(LOST)
    errors.note(LOST, on(), 3)
    assert not outbox.errors
    assert errors.view(LOST) is view


def test_what_is_forgotten_was_never_raised(errors: ErrorList) -> None:
    errors.note(LOST, on(), 0)
    errors.mark_start()
    errors.forget(LOST)
    assert errors.view(LOST).count == 0
    assert not errors.open_ones()
    errors.note(OFF, on(), 3)
    assert errors.view(OFF).first_out


@pytest.fixture
def outbox() -> Outbox:
    return Outbox()


def told(outbox: Outbox) -> list[str]:
    return [event.kind for event in outbox.take().events if event.kind.startswith("error.")]


def test_what_is_raised_silently_is_on_and_ends_without_a_trace(outbox: Outbox) -> None:
    errors = ErrorList(outbox)
    errors.mark_start()
    errors.note(OFF, on(state=S.PENDING), 1)
    errors.raise_silently(OFF, on(), 2)
    assert (errors.is_on(OFF), errors.is_silent(OFF)) == (True, True)
    errors.clear(OFF)
    assert (errors.view(OFF).state, errors.view(OFF).count) == (S.NORMAL, 0)
    assert not errors.open_ones()
    outputs = outbox.take()
    assert (outputs.kept, [e for e in outputs.events if e.kind.startswith("error.")]) == ((), [])


def test_once_it_is_told_it_ends_as_any_other(outbox: Outbox) -> None:
    errors = ErrorList(outbox)
    errors.raise_silently(OFF, on(), 2)
    errors.tell_raised(OFF)
    assert not errors.is_silent(OFF)
    errors.clear(OFF)
    assert (errors.view(OFF).state, errors.view(OFF).count) == (S.RETURNED, 1)
    assert told(outbox) == ["error.raised", "error.cleared"]


def test_what_is_on_already_is_not_silent_again(outbox: Outbox) -> None:
    errors = ErrorList(outbox)
    errors.raise_(OFF, on(), 2)
    errors.raise_silently(OFF, on("still so"), 3)
    assert (errors.is_silent(OFF), errors.view(OFF).message) == (False, "still so")


def test_what_an_earlier_run_left_stays_to_be_seen_and_kept(outbox: Outbox) -> None:
    errors = ErrorList(outbox)
    errors.mark_start()
    errors.restore(KeptUnacknowledged(OFF.part, OFF.error, "base is slow", 3, 0.2, 0.9), 5)
    before = errors.view(OFF)
    errors.note(OFF, on("base is unknown", S.PENDING), 6)
    errors.raise_silently(OFF, on("base is unknown"), 7)
    errors.clear(OFF)
    assert errors.view(OFF) == before
    assert (before.state, before.message, before.since) == (S.RETURNED, "base is slow", 3)
    assert outbox.take().kept == ()


def test_what_is_pending_does_not_hide_what_nobody_has_seen(errors: ErrorList) -> None:
    errors.note(OFF, on("base is slow"), 1)
    errors.note(OFF, NORMAL, 2)
    errors.note(OFF, on("base is unknown", S.PENDING), 3)
    errors.note(OFF, NORMAL, 4)
    assert (errors.view(OFF).state, errors.view(OFF).message) == (S.RETURNED, "base is slow")


def test_open_errors_have_the_names_by_which_clients_know_them(errors: ErrorList) -> None:
    errors.note(LOW, on(), 1)
    errors.note(LOST, on(), 2)
    errors.note(OFF, on(state=S.PENDING), 3)
    assert list(errors.open_ones()) == ["BATTERY_LOW", "arm.UNREACHABLE", "base.DEVIATES"]


def test_errors_of_parts_are_counted_by_name_while_they_are_on(errors: ErrorList) -> None:
    errors.note(LOW, on(), 1)
    errors.note(LOST, on(), 1)
    errors.note(ErrorKey(PartName("base"), "UNREACHABLE"), on(), 1)
    errors.note(LOST, NORMAL, 2)
    assert errors.parts_with == {"UNREACHABLE": 1}


def test_what_turns_out_to_follow_from_another_error_of_the_same_moment_was_not_first() -> None:
    arm = PartName("arm")
    model = SmhModel({arm: NodeModel(arm)}, {})
    errors = ErrorList(Outbox(), ErrorCauses(model))
    deviates = ErrorKey(arm, "DEVIATES")
    errors.note(deviates, on(), 5)
    assert errors.view(deviates).first_out

    errors.note(LOST, on(), 5)
    errors.renew_roots(deviates)

    assert errors.view(deviates).roots == (LOST,)
    assert [errors.view(key).first_out for key in (LOST, deviates)] == [True, False]


def test_an_error_of_a_device_is_told_as_one() -> None:
    outbox = Outbox()
    arm, node = PartName("arm"), PartName("manipulator")
    model = SmhModel({node: NodeModel(node)}, {})
    errors = ErrorList(outbox, ErrorCauses(model, devices={arm: (node,)}))
    key = ErrorKey(arm, "LOST")
    errors.raise_(key, on(), 5)
    errors.clear(key)

    raised, cleared = [e.event for e in outbox.take().events if e.kind.startswith("error.")]

    assert isinstance(raised, ErrorRaised)
    assert isinstance(cleared, ErrorCleared)
    assert raised.of_device
    assert cleared.of_device
    assert (raised.notable, cleared.notable) == (False, False)
    assert errors.view(key).severity is Severity.URGENT
