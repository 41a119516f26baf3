from dataclasses import replace

import pytest

from domain.findings import Blocker
from domain.health.signal_monitor import SignalMonitor, StopCause
from domain.health.signals import (
    STALE_DATA,
    Bound,
    Comparison,
    Recovery,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.inputs import Reading, SignalValue, SourceFault
from domain.timebase import Instant, seconds

START = seconds(500)
DEFAULTS = {item.spec.name: item for item in default_signals()}


def engaged(since: Instant) -> tuple[StopCause, ...]:
    return (StopCause("emergency stop is engaged", since),)


class Story:
    """One signal whose times are seconds after the start; it never grows stale."""

    def __init__(self, settings: SignalSettings) -> None:
        self.monitor = SignalMonitor(replace(settings, stale_after=0, min_on=0), START)

    def read(self, at_s: float, value: SignalValue) -> None:
        name = self.monitor.settings.spec.name
        self.monitor.receive(Reading(name, value), "pad", START + seconds(at_s))

    def error(self, at_s: float) -> str | None:
        self.monitor.judge(START + seconds(at_s))
        return self.monitor.view.error

    @property
    def wakes_at_s(self) -> float | None:
        at = self.monitor.wake_at()
        return None if at is None else (at - START) / seconds(1)


def test_the_limit_belongs_to_the_time() -> None:
    gps = Story(DEFAULTS["gps_accuracy"])
    gps.read(0, 100.0)
    gps.read(1, 201.0)

    gps.monitor.judge(START + seconds(15) - 1)
    assert gps.monitor.view.error is None
    assert gps.error(15) == "GPS_LOST"


def test_silence_after_the_last_good_reading_counts_as_bad() -> None:
    gps = Story(DEFAULTS["gps_accuracy"])
    gps.read(0, 100.0)
    gps.read(20, 201.0)

    assert gps.error(20) == "GPS_LOST"


def test_the_time_counts_from_the_start_if_nothing_was_ever_good() -> None:
    gps = Story(DEFAULTS["gps_accuracy"])
    gps.read(14, 201.0)

    assert gps.wakes_at_s == 15


def test_one_good_reading_starts_the_time_again() -> None:
    gps = Story(DEFAULTS["gps_accuracy"])
    for at_s, value in ((1, 201.0), (14, 200.0), (14.1, 201.0)):
        gps.read(at_s, value)

    assert gps.wakes_at_s == 29


LOAD = SignalSettings(
    SignalSpec("load", SignalKind.NUMBER, "kg"),
    (Bound("OVERLOAD", Comparison.ABOVE, 1500.0, for_=seconds(3)),),
)


def test_for_a_further_signal_silence_before_the_first_bad_reading_does_not_count() -> None:
    load = Story(LOAD)
    load.read(0, 100.0)
    load.read(6, 1800.0)
    assert load.monitor.view.error is None
    assert load.monitor.view.pending_since == START + seconds(6)
    assert load.wakes_at_s == 9

    load.monitor.judge(START + seconds(9) - 1)
    assert load.monitor.view.error is None
    assert load.error(9) == "OVERLOAD"
    assert told(load.monitor) == [("OVERLOAD", "load 1800 kg has been above 1500 kg for 3 s")]


def test_its_first_reading_of_all_may_be_the_first_bad_one() -> None:
    load = Story(LOAD)
    load.read(60, 1800.0)

    assert load.wakes_at_s == 63


def test_its_time_goes_on_with_further_bad_readings_and_begins_anew_after_a_good_one() -> None:
    load = Story(LOAD)
    for at_s, value in ((1, 1800.0), (2, 1900.0), (3.5, 1500.0), (3.6, 1600.0)):
        load.read(at_s, value)

    assert load.wakes_at_s == pytest.approx(6.6)


def test_a_signal_that_was_not_heard_meanwhile_is_not_known_to_have_been_bad() -> None:
    load = SignalMonitor(replace(LOAD, stale_after=seconds(2)), START)
    load.receive(Reading("load", 1800.0), "pad", START)
    stale_at = START + seconds(2) + 1
    assert load.wake_at() == stale_at

    load.judge(stale_at)
    assert (load.view.stale, load.view.pending_error) == (True, None)
    assert load.wake_at() is None
    load.receive(Reading("load", 1800.0), "pad", START + seconds(5))
    assert load.view.pending_since == START + seconds(5)
    load.receive(Reading("load", 1800.0), "pad", START + seconds(6.5))
    load.judge(START + seconds(8))

    assert load.view.error == "OVERLOAD"


def test_an_error_outlasts_that_its_signal_is_not_heard() -> None:
    load = SignalMonitor(replace(LOAD, stale_after=seconds(4)), START)
    load.receive(Reading("load", 1800.0), "pad", START)
    load.judge(START + seconds(3))
    load.judge(START + seconds(9))
    load.receive(Reading("load", 1700.0), "pad", START + seconds(10))

    assert load.view.error == "OVERLOAD"
    assert load.view.pending_error is None
    assert dict(told(load))["OVERLOAD"] == "load 1700 kg has been above 1500 kg for 3 s"


def test_the_time_that_is_told_is_what_was_measured() -> None:
    gps, radio = Story(DEFAULTS["gps_accuracy"]), Story(DEFAULTS["signal_strength"])
    gps.read(0, 100.0)
    gps.read(100.17, 300.0)
    radio.read(0, "CONNECTED")
    radio.read(1, "NOT_CONNECTED")
    radio.error(10)
    assert [message for _, message in (*told(gps.monitor), *told(radio.monitor))] == [
        "GPS accuracy 300 mm is above 200 mm, no good reading for 100.1 s",
        "signal strength is NOT_CONNECTED, no CONNECTED reading for 10 s",
    ]
    radio.read(12.34, "LOW_SIGNAL")

    assert told(radio.monitor) == [
        ("SIGNAL_LOW", "signal strength is LOW_SIGNAL, no CONNECTED reading for 12.3 s")
    ]


def test_what_is_counted_is_shown_with_how_long_it_takes() -> None:
    gps = Story(DEFAULTS["gps_accuracy"])
    gps.read(3, 100.0)
    gps.read(4, 201.0)

    view = gps.monitor.view
    assert (view.pending_error, view.pending_since, view.pending_needs) == (
        "GPS_LOST",
        START + seconds(3),
        seconds(15),
    )


def test_weak_and_lost_share_one_timer() -> None:
    radio = Story(DEFAULTS["signal_strength"])
    radio.read(0, "CONNECTED")
    radio.read(1, "LOW_SIGNAL")
    assert radio.monitor.view.pending_error == "SIGNAL_LOW"
    assert radio.wakes_at_s == 20

    radio.read(5, "NOT_CONNECTED")
    assert radio.monitor.view.pending_error == "SIGNAL_LOST"
    assert radio.wakes_at_s == 10


def test_a_weak_signal_after_a_lost_one_is_an_error_at_once() -> None:
    radio = Story(DEFAULTS["signal_strength"])
    radio.read(0, "NOT_CONNECTED")
    assert radio.error(10) == "SIGNAL_LOST"

    radio.read(11, "LOW_SIGNAL")
    assert radio.monitor.view.error == "SIGNAL_LOW"
    radio.read(12, "NOT_CONNECTED")
    assert radio.monitor.view.error == "SIGNAL_LOST"
    radio.read(13, "CONNECTED")
    assert radio.monitor.view.error is None


def test_a_weak_signal_after_a_connected_one_has_its_time_even_while_the_old_error_is_kept() -> (
    None
):
    settings = replace(DEFAULTS["signal_strength"], recovery=Recovery.ACKNOWLEDGE)
    radio = Story(settings)
    radio.read(0, "NOT_CONNECTED")
    radio.error(10)
    radio.read(11, "CONNECTED")
    radio.read(12, "LOW_SIGNAL")
    assert radio.monitor.view.error == "SIGNAL_LOST"
    assert radio.monitor.view.pending_error == "SIGNAL_LOW"

    assert radio.error(31) == "SIGNAL_LOW"


def test_an_error_that_is_on_ends_at_the_clear_threshold() -> None:
    low = Bound("BATTERY_LOW", Comparison.BELOW, 0.5, clear_threshold=0.55)
    battery = Story(replace(DEFAULTS["battery_level"], bounds=(low,)))
    errors = []
    for at_s, value in enumerate((0.52, 0.49, 0.54, 0.55, 0.52)):
        battery.read(at_s, value)
        errors.append(battery.monitor.view.error)

    assert errors == [None, "BATTERY_LOW", "BATTERY_LOW", None, None]


def test_the_time_begins_again_between_the_thresholds_only_while_the_error_is_off() -> None:
    lost = Bound("GPS_LOST", Comparison.ABOVE, 200.0, clear_threshold=150.0, for_=seconds(15))
    gps = Story(replace(DEFAULTS["gps_accuracy"], bounds=(lost,)))
    gps.read(0, 201.0)
    gps.read(10, 180.0)
    gps.read(11, 201.0)
    assert gps.wakes_at_s == 25

    assert gps.error(25) == "GPS_LOST"
    gps.read(26, 180.0)
    assert gps.monitor.view.error == "GPS_LOST"


def test_a_graver_error_of_the_same_signal_has_its_own_time() -> None:
    spec = SignalSpec("motor_temperature", SignalKind.NUMBER)
    severe = Bound("MOTOR_BURNING", Comparison.ABOVE, 90.0, for_=seconds(5), key="burning")
    mild = Bound("MOTOR_HOT", Comparison.ABOVE, 70.0, key="hot")
    motor = Story(SignalSettings(spec, (severe, mild)))
    motor.read(0, 20.0)
    motor.read(1, 95.0)
    assert motor.monitor.view.error == "MOTOR_HOT"
    assert motor.monitor.view.pending_error == "MOTOR_BURNING"
    assert motor.wakes_at_s == 6

    assert motor.error(6) == "MOTOR_BURNING"
    assert motor.wakes_at_s is None


def test_an_engaged_stop_is_not_delayed_by_what_delays_its_readings() -> None:
    pressed = Bound("ESTOP", Comparison.EQUAL, threshold=True, for_=seconds(1))
    stop = Story(replace(DEFAULTS["estop"], bounds=(pressed,)))
    stop.read(0, False)
    stop.read(0.5, True)
    assert stop.monitor.view.error is None

    stop.monitor.set_engaged(engaged(START + seconds(0.6)), START + seconds(0.6))
    assert stop.monitor.view.error == "ESTOP"


def test_readings_go_on_being_judged_while_the_stop_is_engaged() -> None:
    pressed = Bound("ESTOP", Comparison.EQUAL, threshold=True, for_=seconds(1))
    stop = Story(replace(DEFAULTS["estop"], bounds=(pressed,)))
    stop.monitor.set_engaged(engaged(START), START)
    stop.read(9, False)
    stop.monitor.set_engaged((), START + seconds(9.1))
    stop.read(9.5, True)

    assert stop.wakes_at_s == 10.5


def test_all_that_engage_a_stop_are_told() -> None:
    stop = Story(DEFAULTS["estop"])
    for causes in (engaged(START), (*engaged(START), StopCause("engaged at device arm", START))):
        stop.monitor.set_engaged(causes, START + seconds(1))

        assert [reason.message for reason in stop.monitor.reasons()] == [
            cause.message for cause in causes
        ]


def test_a_reading_is_stale_when_it_is_strictly_older_than_the_limit() -> None:
    monitor = SignalMonitor(DEFAULTS["temperature"], START)
    monitor.receive(Reading("temperature", 20.0), "pad", START)
    limit = START + seconds(2)

    monitor.judge(limit)
    assert not monitor.view.stale
    assert monitor.wake_at() == limit + 1

    monitor.judge(limit + 1)
    assert monitor.view.stale
    assert monitor.errors == {STALE_DATA}


@pytest.mark.parametrize(("stale_after", "errors"), [(seconds(2), {STALE_DATA}), (0, set())])
def test_a_signal_never_seen_is_good_only_where_staleness_is_off(
    stale_after: int, errors: set[str]
) -> None:
    monitor = SignalMonitor(replace(DEFAULTS["temperature"], stale_after=stale_after), START)

    assert monitor.errors == errors
    assert monitor.view.stale is bool(errors)


def test_a_signal_whose_source_fails_becomes_stale_in_its_own_time_and_says_why() -> None:
    monitor = SignalMonitor(DEFAULTS["temperature"], START)
    monitor.receive(Reading("temperature", 20.0), "file", START)
    monitor.note_fault(SourceFault("temperature", "file", "no such file"), START + seconds(1))
    assert monitor.view.source_fault == "no such file"
    assert not monitor.view.stale

    monitor.judge(START + seconds(2) + 1)
    (reason,) = monitor.reasons()
    assert reason.message == "no reading of temperature for 2 s: no such file"


def test_only_a_reading_of_the_same_source_ends_its_fault() -> None:
    monitor = SignalMonitor(DEFAULTS["temperature"], START)
    monitor.note_fault(SourceFault("temperature", "file", "no such file"), START)

    monitor.receive(Reading("temperature", 20.0), "pad", START)
    assert monitor.view.source_fault == "no such file"

    monitor.receive(Reading("temperature", 20.0), "file", START)
    assert monitor.view.source_fault is None


def test_a_stop_is_as_fresh_as_its_newest_reading_of_any_source() -> None:
    monitor = SignalMonitor(DEFAULTS["estop"], START)
    monitor.receive(Reading("estop", False), "a person, once", START)
    monitor.receive(Reading("estop", False), "relay", START + seconds(1.9))
    monitor.judge(START + seconds(3))

    assert not monitor.view.stale


def test_a_pressed_stop_is_shown_with_who_presses_it() -> None:
    monitor = SignalMonitor(DEFAULTS["estop"], START)
    monitor.receive(Reading("estop", True), "pad", START)
    monitor.receive(Reading("estop", False), "relay", START + 1)

    assert (monitor.view.value, monitor.view.source) == (True, "pad")
    assert monitor.view.received_at == START + 1


def test_the_view_is_the_same_object_until_something_changes() -> None:
    monitor = SignalMonitor(DEFAULTS["temperature"], START)
    monitor.receive(Reading("temperature", 20.0), "pad", START)
    before = monitor.view
    monitor.judge(START + seconds(1))
    assert monitor.view is before

    monitor.receive(Reading("temperature", 20.0), "pad", START + seconds(1))
    assert monitor.view is not before


# --- why an error is on --------------------------------------------------------------------------


def told(monitor: SignalMonitor) -> list[tuple[str, str]]:
    return [(reason.code, reason.message) for reason in monitor.reasons()]


def test_a_bad_value_is_told_with_its_threshold_and_since_when_it_is_an_error() -> None:
    battery = Story(DEFAULTS["battery_level"])
    battery.read(3, 0.42)

    assert list(battery.monitor.reasons()) == [
        Blocker(
            code="BATTERY_LOW",
            message="battery 42 % is below 50 %",
            path=("battery_level",),
            value=0.42,
            threshold=0.5,
            since=START + seconds(3),
            refuses=False,
        )
    ]
    assert battery.monitor.errors == battery.monitor.present == {"BATTERY_LOW"}


def test_a_good_value_has_no_reason() -> None:
    battery = Story(DEFAULTS["battery_level"])
    battery.read(3, 0.9)

    assert told(battery.monitor) == []


def test_an_error_that_was_waited_for_is_told_with_how_long_it_took() -> None:
    gps = Story(DEFAULTS["gps_accuracy"])
    gps.read(0, 100.0)
    gps.read(1, 201.0)
    gps.error(15)

    message = "GPS accuracy 201 mm is above 200 mm, no good reading for 15 s"
    assert told(gps.monitor) == [("GPS_LOST", message)]


def test_an_error_kept_after_its_cause_is_told_as_that_until_it_is_acknowledged() -> None:
    monitor = SignalMonitor(
        replace(DEFAULTS["temperature"], stale_after=0, recovery=Recovery.ACKNOWLEDGE), START
    )
    monitor.receive(Reading("temperature", 60.0), "pad", START)
    monitor.receive(Reading("temperature", 20.0), "pad", START + seconds(1))
    (reason,) = monitor.reasons()
    assert "waits for acknowledgement" in reason.message
    assert (reason.value, reason.threshold) == (None, None)
    assert monitor.errors == {"TEMPERATURE_HIGH"}
    assert monitor.present == set()

    monitor.acknowledge("STALE_DATA", START + seconds(2))
    assert monitor.errors == {"TEMPERATURE_HIGH"}
    monitor.acknowledge("TEMPERATURE_HIGH", START + seconds(2))
    assert monitor.errors == set()
    assert told(monitor) == []


def test_a_stop_is_told_once_for_the_latch_and_once_for_who_presses_it() -> None:
    stop = Story(DEFAULTS["estop"])
    stop.monitor.set_engaged(engaged(START + seconds(1)), START + seconds(1))
    stop.read(2, True)
    latch, pressed = stop.monitor.reasons()

    assert (latch.message, latch.value, latch.since) == (
        "emergency stop is engaged",
        True,
        START + seconds(1),
    )
    assert (pressed.message, pressed.value, pressed.since) == (
        "e-stop is pressed (source pad)",
        True,
        START + seconds(2),
    )
    assert latch.code == pressed.code == "ESTOP"


def test_a_signal_never_read_and_one_read_too_long_ago_are_told_apart() -> None:
    monitor = SignalMonitor(DEFAULTS["temperature"], START)
    (never,) = monitor.reasons()
    assert (never.code, never.message) == (STALE_DATA, "no reading of temperature yet")
    assert (never.value, never.threshold, never.since) == (None, 2.0, START)

    monitor.receive(Reading("temperature", 20.0), "pad", START + seconds(1))
    monitor.judge(START + seconds(3) + 1)
    assert told(monitor) == [(STALE_DATA, "no reading of temperature for 2 s")]


def test_staleness_that_has_just_ended_stays_on_for_a_moment_and_says_so() -> None:
    monitor = SignalMonitor(DEFAULTS["temperature"], START)
    monitor.receive(Reading("temperature", 20.0), "pad", START)
    monitor.judge(START + seconds(2) + 1)
    monitor.receive(Reading("temperature", 20.0), "pad", START + seconds(2.1))
    (reason,) = monitor.reasons()

    assert reason.code == STALE_DATA
    assert "stays active for at least 0.2 s" in reason.message
    assert monitor.wake_at() == START + seconds(2.2) + 1


def test_an_error_of_an_earlier_run_says_what_was_measured_until_something_is_read() -> None:
    settings = replace(DEFAULTS["temperature"], stale_after=0, recovery=Recovery.ACKNOWLEDGE)
    monitor = SignalMonitor(settings, START)
    monitor.restore("TEMPERATURE_HIGH", START - seconds(9), "temperature 60 °C", START)
    (waits,) = monitor.reasons()
    assert (waits.code, waits.since) == ("TEMPERATURE_HIGH", START - seconds(9))
    assert waits.message == "before the restart: temperature 60 °C; waits for acknowledgement"
    assert monitor.view.needs_acknowledgement
    assert monitor.present == set()

    monitor.receive(Reading("temperature", 20.0), "pad", START + seconds(1))
    (waits,) = monitor.reasons()
    assert waits.message == (
        "temperature no longer causes TEMPERATURE_HIGH, which waits for acknowledgement"
    )


@pytest.mark.parametrize(
    ("error", "recovery", "waits"),
    [
        ("TEMPERATURE_HIGH", Recovery.ACKNOWLEDGE, True),
        ("TEMPERATURE_HIGH", Recovery.AUTOMATIC, False),
        ("TEMPERATURE_LOW", Recovery.ACKNOWLEDGE, False),
        (STALE_DATA, Recovery.ACKNOWLEDGE, False),
    ],
)
def test_which_errors_wait_for_acknowledgement(error: str, recovery: Recovery, waits: bool) -> None:
    monitor = SignalMonitor(replace(DEFAULTS["temperature"], recovery=recovery), START)

    assert monitor.waits_with(error) is waits
