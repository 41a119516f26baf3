"""What operators have yet to see: what is kept of it, and how much."""

import pytest

from domain.health.alarm import QUIET, Alarm, Evidence
from domain.health.alarms import MAX_KEPT, MAX_RETURNED, Alarms
from domain.kept import Keeping, KeptUnacknowledged
from domain.outbox import Outbox
from domain.snapshot import ErrorKey, ErrorState, ErrorView, Severity

LOW = ErrorKey(None, "BATTERY_LOW")
ON = Alarm(Evidence(ErrorState.ACTIVE), unseen=True, raised=3)
SEEN = ON.acknowledged()
RETURNED = Alarm(unseen=True, raised=3, ended=4)


def view(name: str = "BATTERY_LOW", value: float = 0.4) -> ErrorView:
    key = ErrorKey(None, name)
    return ErrorView(key, Severity.CRITICAL, ErrorState.ACTIVE, True, "low", value, 0.5, 3, 1)


@pytest.fixture
def outbox() -> Outbox:
    return Outbox()


@pytest.fixture
def alarms(outbox: Outbox) -> Alarms:
    alarms = Alarms(outbox)
    alarms.mark_start()
    return alarms


def test_what_is_not_known_is_quiet(alarms: Alarms) -> None:
    assert alarms[LOW] is QUIET


def test_an_error_is_kept_from_when_it_was_raised_until_somebody_saw_it(
    alarms: Alarms, outbox: Outbox
) -> None:
    alarms.put(view(), ON)
    kept = KeptUnacknowledged(None, "BATTERY_LOW", "low", 3, 0.4, 0.5)
    assert outbox.take().kept == (Keeping(KeptUnacknowledged, "BATTERY_LOW", kept),)
    alarms.put(view(value=0.3), ON)
    alarms.put(view(), RETURNED)
    assert not outbox.take().kept
    alarms.put(view(), QUIET)
    assert outbox.take().kept == (Keeping(KeptUnacknowledged, "BATTERY_LOW", None),)


def test_what_is_on_since_the_start_is_not_kept(outbox: Outbox) -> None:
    alarms = Alarms(outbox)
    alarms.put(view(), ON)
    alarms.mark_start()
    assert alarms.is_from_start(LOW)
    alarms.put(view(value=0.3), ON)
    assert not outbox.take().kept
    alarms.put(view(), QUIET)
    assert not alarms.is_from_start(LOW)


def test_what_an_earlier_run_left_has_to_be_seen_though_it_is_on_since_the_start(
    outbox: Outbox,
) -> None:
    alarms = Alarms(outbox)
    alarms.put(view(), ON)
    alarms.mark_start()
    alarms.restore(KeptUnacknowledged(None, "BATTERY_LOW", "low", 3))
    assert not alarms.is_from_start(LOW)
    alarms.put(view(), SEEN)
    assert outbox.take().kept == (Keeping(KeptUnacknowledged, "BATTERY_LOW", None),)


def test_only_so_many_are_kept(alarms: Alarms, outbox: Outbox) -> None:
    for number in range(MAX_KEPT + 5):
        alarms.put(view(str(number)), ON)
    assert len(outbox.take().kept) == MAX_KEPT


def test_of_too_many_that_returned_the_oldest_is_named(alarms: Alarms) -> None:
    named = [alarms.put(view(str(number)), RETURNED) for number in range(MAX_RETURNED + 1)]
    assert named == [None] * MAX_RETURNED + [ErrorKey(None, "0")]
