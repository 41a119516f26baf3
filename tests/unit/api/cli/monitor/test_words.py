from datetime import datetime

import pytest

from api.cli.monitor import words
from tests.support.monitor import after, signal, task


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (-3.0, "0 s"),
        (0.9, "0 s"),
        (59.9, "59 s"),
        (185.0, "3 min 5 s"),
        (7440.0, "2 h 4 min"),
    ],
)
def test_a_duration_is_told_in_whole_units(seconds: float, text: str) -> None:
    assert words.duration(seconds) == text


@pytest.mark.parametrize(
    ("pair", "text"),
    [
        (None, ""),
        ({"state": "active", "mode": "FAST"}, "active.FAST"),
        ({"state": "inactive", "mode": None}, "inactive"),
        ({"state": "unknown", "mode": None}, "?"),
    ],
)
def test_state_and_mode_are_one_label(pair: words.Json | None, text: str) -> None:
    assert words.label(pair) == text


def test_only_something_that_is_inferred_has_a_star() -> None:
    assert words.starred("active", inferred=True) == "active(*)"
    assert words.starred("active", inferred=False) == "active"
    assert words.starred("", inferred=True) == ""


@pytest.mark.parametrize(
    ("given", "text"),
    [
        (signal("battery_level", 0.42, "ratio"), "42 %"),
        (signal("battery_level", 0.4257, "ratio"), "42.6 %"),
        (signal("temperature", 30.0, "°C"), "30.0 °C"),
        (signal("estop", value=True), "pressed"),
        (signal("estop", value=False), "not pressed"),
        (signal("lights", value=True), "yes"),
        (signal("lights", value=False), "no"),
        (signal("signal_strength", "NOT_CONNECTED"), "not connected"),
        (signal("temperature", None, "°C"), "?"),
        (signal("count", 12), "12"),
    ],
)
def test_a_value_is_told_as_a_person_would(given: words.Json, text: str) -> None:
    assert words.value_words(given) == text


def test_a_signal_is_ok_or_all_that_is_wrong_with_it() -> None:
    assert words.verdict_words(signal("x"), None) == "ok"
    assert words.verdict_words(signal("x", stale=True), None) == "stale"
    assert words.verdict_words(signal("x", error="E", stale=True), None) == "E, stale"


def test_that_a_signal_is_stale_is_said_once() -> None:
    stale = signal("x", error="STALE_DATA", stale=True)

    assert words.verdict_words(stale, None) == "STALE_DATA"


def test_why_a_source_gives_no_reading_is_said_instead() -> None:
    lost = signal("x", stale=True, source_fault="no bus /dev/i2c-1")

    assert words.verdict_words(lost, None) == "no reading: no bus /dev/i2c-1"
    assert words.verdict_words({**lost, "error": "STALE_DATA"}, None) == (
        "STALE_DATA, no reading: no bus /dev/i2c-1"
    )


def test_an_error_that_is_coming_is_counted_down() -> None:
    coming = signal("x", pending={"error": "GPS_LOST", "needs_s": 15.0})

    assert words.verdict_words(coming, 0.0) == "GPS_LOST in 15 s"
    assert words.verdict_words(coming, 14.5) == "GPS_LOST in 1 s"
    assert words.verdict_words(coming, 15.0) == "GPS_LOST in 0 s"


def test_short_ways_have_a_decimal() -> None:
    assert words.metres(9.94) == "9.9 m"
    assert words.metres(336.4) == "336 m"


def test_all_is_done_only_when_it_is() -> None:
    assert words.percent(0.9999) == "99 %"
    assert words.percent(1.0) == "100 %"


def test_waypoints_are_counted_from_one_and_not_beyond_the_last() -> None:
    assert words.waypoint_words(task(target_index=40)) == "waypoint 41 of 66"
    assert words.waypoint_words(task(target_index=66)) == "waypoint 66 of 66"


@pytest.mark.parametrize(
    ("error_m", "speed_mps", "text"),
    [
        (0.031, 2.71, "2.7 of 2.8 m/s, 0.03 m left of the path"),
        (-1.5, 2.8, "2.8 of 2.8 m/s, 1.50 m right of the path"),
        (0.004, 0.0, "0.0 of 2.8 m/s, on the path"),
        (None, None, "? of 2.8 m/s"),
    ],
)
def test_how_it_drives_is_what_there_is_and_what_was_asked(
    error_m: float | None, speed_mps: float | None, text: str
) -> None:
    drives = task(cross_track_error_m=error_m)

    assert words.drive_words(drives, {"speed_mps": speed_mps}) == text


def test_where_no_vehicle_is_known_its_speed_is_not() -> None:
    assert words.drive_words(task(cross_track_error_m=None), None) == "? of 2.8 m/s"


def test_the_time_of_day_is_local() -> None:
    assert words.time_of_day(0.0)[2:3] == ":"
    assert len(words.time_of_day(0.0)) == len("12:00:00")


def test_date_and_time_are_as_those_of_the_mode_monitor() -> None:
    at = datetime(2026, 5, 4, 12, 0, 5).astimezone().timestamp()

    assert words.date_and_time(at) == "Mon May  4 12:00:05 2026"


def test_how_a_task_ended_is_told_with_its_way_and_time() -> None:
    ended = task("ABORTED", reason="left the path", ended_at=after(12), distance_m=60.0)

    told = words.end_words(ended)

    assert told.startswith("task t1 aborted at ")
    assert told.endswith(": left the path (60 m of 800 m in 12 s)")


def test_a_reason_that_says_the_same_is_left_out() -> None:
    ended = task("CANCELED", reason="canceled", ended_at=after(1))

    assert "canceled" in words.end_words(ended)
    assert words.end_words(ended).count("canceled") == 1
