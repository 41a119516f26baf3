from domain.health.error_slot import ErrorSlot
from domain.health.signals import Recovery


def automatic(min_on: int = 5) -> ErrorSlot:
    return ErrorSlot(min_on, Recovery.AUTOMATIC)


def acknowledged(min_on: int = 0) -> ErrorSlot:
    return ErrorSlot(min_on, Recovery.ACKNOWLEDGE)


def test_a_short_error_stays_on_for_the_least_time_and_no_longer() -> None:
    slot = automatic()
    slot.update("ESTOP", 10)
    slot.update(None, 11)
    slot.update(None, 14)
    assert (slot.error, slot.wake_at) == ("ESTOP", 15)

    slot.update(None, 15)
    assert (slot.error, slot.wake_at) == (None, None)


def test_a_long_error_ends_with_its_cause() -> None:
    slot = automatic()
    slot.update("ESTOP", 10)
    slot.update(None, 40)

    assert slot.error is None


def test_time_alone_ends_no_error_whose_cause_is_there() -> None:
    slot = automatic()
    slot.update("ESTOP", 10)
    assert slot.wake_at is None

    slot.update("ESTOP", 99)
    assert slot.error == "ESTOP"


def test_another_error_takes_the_place_of_the_first_at_once() -> None:
    slot = automatic()
    slot.update("SIGNAL_LOST", 10)
    slot.update("SIGNAL_LOW", 11)
    assert (slot.error, slot.since) == ("SIGNAL_LOW", 11)

    slot.update(None, 12)
    assert slot.wake_at == 16


def test_a_cause_that_comes_back_in_time_continues_the_same_error() -> None:
    slot = automatic()
    slot.update("ESTOP", 10)
    slot.update(None, 11)
    slot.update("ESTOP", 13)
    slot.update(None, 15)

    assert slot.error is None


def test_the_error_that_holds_at_the_start_ends_with_its_cause_however_early() -> None:
    slot = automatic()
    slot.begin_with("STALE_DATA", 100)
    slot.update(None, 100)

    assert slot.error is None


def test_an_error_waits_for_its_acknowledgement() -> None:
    slot = acknowledged()
    slot.update("ESTOP", 10)
    slot.update(None, 11)
    assert (slot.error, slot.waits_for_acknowledgement, slot.wake_at) == ("ESTOP", True, None)

    slot.acknowledge()
    slot.update(None, 90)
    assert slot.error is None


def test_an_acknowledgement_is_remembered_until_the_cause_is_gone() -> None:
    slot = acknowledged()
    slot.update("ESTOP", 10)
    slot.acknowledge()
    slot.update("ESTOP", 11)
    assert slot.error == "ESTOP"

    slot.update(None, 12)
    assert slot.error is None


def test_an_acknowledgement_does_not_shorten_the_least_time() -> None:
    slot = acknowledged(min_on=5)
    slot.update("ESTOP", 10)
    slot.acknowledge()
    slot.update(None, 11)

    assert (slot.error, slot.wake_at) == ("ESTOP", 15)


def test_a_new_rise_needs_a_new_acknowledgement() -> None:
    slot = acknowledged()
    slot.update("ESTOP", 10)
    slot.acknowledge()
    slot.update(None, 11)
    slot.update("ESTOP", 12)
    slot.update(None, 13)

    assert slot.error == "ESTOP"


def test_a_rise_while_the_error_is_still_kept_on_needs_a_new_acknowledgement() -> None:
    slot = acknowledged(min_on=5)
    slot.update("ESTOP", 10)
    slot.acknowledge()
    slot.update(None, 11)
    slot.update("ESTOP", 12)
    slot.update(None, 20)

    assert slot.waits_for_acknowledgement


def test_acknowledging_one_error_does_not_acknowledge_the_one_that_takes_its_place() -> None:
    slot = acknowledged()
    slot.update("SIGNAL_LOST", 10)
    slot.acknowledge()
    slot.update("SIGNAL_LOW", 11)
    slot.update(None, 12)

    assert slot.error == "SIGNAL_LOW"


def test_nothing_is_acknowledged_in_advance() -> None:
    slot = acknowledged()
    slot.acknowledge()
    slot.update("ESTOP", 10)
    slot.update(None, 11)

    assert slot.error == "ESTOP"


def test_an_error_of_an_earlier_run_waits_without_a_cause() -> None:
    slot = acknowledged(min_on=5)
    slot.restore("TEMPERATURE_HIGH", 10)
    slot.update(None, 100)
    assert (slot.error, slot.since, slot.waits_for_acknowledgement) == (
        "TEMPERATURE_HIGH",
        10,
        True,
    )

    slot.acknowledge()
    slot.update(None, 100)
    assert slot.error is None


def test_an_error_clears_once_its_cause_has_been_gone_for_long_enough() -> None:
    slot = ErrorSlot(5, Recovery.AUTOMATIC, clear_for=20)
    slot.update("ESTOP", 10)
    slot.update(None, 12)
    assert slot.wake_at == 32
    slot.update("ESTOP", 31)
    slot.update(None, 40)
    slot.update(None, 59)
    assert (slot.error, slot.since) == ("ESTOP", 10)
    slot.update(None, 60)
    assert slot.error is None
