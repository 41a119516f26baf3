from api.cli.monitor.store import Robot
from api.cli.monitor.view import Contact, Level, seconds_of
from tests.support.monitor import AT, after, frame, robot, view


def test_an_age_is_counted_on_the_clock_of_the_service() -> None:
    assert view(robot(), later_s=2.5).age_s(AT) == 2.5


def test_an_age_is_never_negative() -> None:
    assert view(robot()).age_s(after(1)) == 0.0


def test_a_time_is_seconds_since_1970() -> None:
    assert seconds_of("1970-01-01T00:01:00.250Z") == 60.25


def test_without_contact_what_lasts_is_only_known_until_the_last_frame() -> None:
    known = robot(frame(after(2)))

    assert view(known, later_s=30.0).known_for_s(AT) == 30.0
    assert view(known, Contact(Level.LOST, 28.0), 30.0).known_for_s(AT) == 2.0
    assert view(Robot(), Contact(Level.LOST, 28.0), 30.0).known_for_s(AT) == 30.0
