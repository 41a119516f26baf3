from domain.health.emergency_stop import EmergencyStop
from domain.snapshot import EmergencyStopView

RELEASED = EmergencyStopView(engaged=False, by=None, reason=None, since=None, standstill_at=None)


def test_it_starts_released_by_nobody() -> None:
    assert EmergencyStop().view() == RELEASED


def test_it_shows_who_engaged_it_why_and_when() -> None:
    stop = EmergencyStop()

    assert stop.engage("anna", "child on the track", now=7)
    assert stop.view() == EmergencyStopView(
        engaged=True, by="anna", reason="child on the track", since=7, standstill_at=None
    )


def test_whoever_engages_it_second_does_not_hide_who_was_first() -> None:
    stop = EmergencyStop()
    stop.engage("anna", "child on the track", now=7)
    before = stop.view()

    assert not stop.engage("bert", "me too", now=9)
    assert stop.view() is before


def test_it_shows_who_released_it() -> None:
    stop = EmergencyStop()
    stop.engage("anna", "child on the track", now=7)

    assert stop.release("bert", "track is clear", now=20)
    assert stop.view() == EmergencyStopView(
        engaged=False, by="bert", reason="track is clear", since=20, standstill_at=None
    )


def test_releasing_what_is_released_changes_nothing() -> None:
    stop = EmergencyStop()

    assert not stop.release("bert", "just in case", now=3)
    assert stop.view() == RELEASED


def test_the_first_standstill_after_the_stop_is_kept() -> None:
    stop = EmergencyStop()
    stop.engage("anna", "child on the track", now=7)

    assert stop.note_standstill(now=9)
    assert not stop.note_standstill(now=12)
    assert stop.view() == EmergencyStopView(
        engaged=True, by="anna", reason="child on the track", since=7, standstill_at=9
    )


def test_a_vehicle_that_stands_without_a_stop_is_no_news() -> None:
    stop = EmergencyStop()

    assert not stop.note_standstill(now=9)
    assert stop.view() == RELEASED


def test_another_stop_waits_for_a_standstill_of_its_own() -> None:
    stop = EmergencyStop()
    stop.engage("anna", "child on the track", now=7)
    stop.note_standstill(now=9)
    stop.release("bert", "track is clear", now=20)
    stop.engage("anna", "another child", now=30)

    assert stop.view().standstill_at is None
