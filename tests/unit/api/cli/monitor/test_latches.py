from api.cli.monitor.latches import holds_after, stop_after
from tests.support.monitor import AT, event, hold, stop


def test_a_hold_that_is_set_is_the_newest() -> None:
    said = event(1, "hold.set", "anna", owner="operator", reason="loading")

    assert holds_after((hold("x"),), said) == (hold("x"), hold("operator", "loading", "anna"))


def test_a_hold_that_is_known_already_is_there_once() -> None:
    said = event(1, "hold.set", "anna", owner="operator", reason="loading")
    once = holds_after((), said)

    assert holds_after(once, said) == once


def test_a_hold_of_pilothouse_itself_is_set_by_nobody() -> None:
    said = event(1, "hold.set", "anna", owner="error", reason="smoke")

    assert holds_after((), said) == (hold("error", "smoke"),)


def test_a_hold_that_is_released_is_gone() -> None:
    assert holds_after((hold("x"), hold("y")), event(1, "hold.released", owner="x")) == (hold("y"),)


def test_a_request_changes_no_hold() -> None:
    said = event(1, "hold.requested", owner="x", reason="other")

    assert holds_after((hold("x"),), said) == (hold("x"),)


def test_the_stop_is_engaged_by_somebody_and_later_the_vehicle_stands() -> None:
    engaged = stop_after(stop(), event(1, "emergency_stop.engaged", "anna", reason="smoke"))

    assert engaged == stop(engaged=True, by="anna", reason="smoke", since_at=AT)
    stands = stop_after(engaged, event(2, "emergency_stop.standstill"))
    assert stands == {**engaged, "standstill_at": AT}


def test_the_stop_is_released() -> None:
    engaged = stop(engaged=True, by="anna", reason="smoke", since_at=AT, standstill_at=AT)

    released = stop_after(engaged, event(3, "emergency_stop.released", "ben", reason=""))

    assert released == stop(by="ben", reason="", since_at=AT)


def test_other_events_leave_the_stop_as_it_is() -> None:
    assert stop_after(stop(), event(1, "task.started", task="t1")) == stop()
