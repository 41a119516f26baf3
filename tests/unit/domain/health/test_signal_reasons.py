from typing import NamedTuple

import pytest

from domain.health.error_slot import ErrorSlot
from domain.health.held_readings import HeldReadings
from domain.health.signal_reasons import (
    kept_reason,
    pressed_reason,
    restored_reason,
    stale_reason,
    value_reason,
)
from domain.health.signals import (
    Bound,
    Comparison,
    Recovery,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.inputs import Reading, SignalValue
from domain.timebase import seconds
from tests.support.tables import table

DEFAULTS = {item.spec.name: item for item in default_signals()}


class Judged(NamedTuple):
    """A value of a signal that causes an error, and what is told of it."""

    signal: str
    value: SignalValue
    words: str
    bad_for_s: float = 0.0
    bound: int = 0


@table(
    {
        "a battery that is low": Judged(
            signal="battery_level", value=0.42, words="battery 42 % is below 50 %"
        ),
        "a share that no float holds exactly": Judged(
            signal="battery_level", value=0.29, words="battery 29 % is below 50 %"
        ),
        "a battery just below its limit": Judged(
            signal="battery_level", value=0.4999999, words="battery 49.99999 % is below 50 %"
        ),
        "a motor that is hot": Judged(
            signal="temperature", value=60.0, words="temperature 60 °C is above 55 °C"
        ),
        "a number too long to write out": Judged(
            signal="temperature", value=1e308, words="temperature 1e+308 °C is above 55 °C"
        ),
        "an accuracy that has been bad for long": Judged(
            signal="gps_accuracy",
            value=250.0,
            bad_for_s=15,
            words="GPS accuracy 250 mm is above 200 mm, no good reading for 15 s",
        ),
        "a lost connection": Judged(
            signal="signal_strength",
            value="NOT_CONNECTED",
            bad_for_s=10,
            words="signal strength is NOT_CONNECTED, no CONNECTED reading for 10 s",
        ),
        "a weak connection, by its second bound": Judged(
            signal="signal_strength",
            bound=1,
            value="LOW_SIGNAL",
            bad_for_s=10,
            words="signal strength is LOW_SIGNAL, no CONNECTED reading for 10 s",
        ),
    }
)
def test_a_value_is_told_with_its_limit_and_unit(row: Judged) -> None:
    settings = DEFAULTS[row.signal]
    bound = settings.bounds[row.bound]

    assert value_reason(settings, bound, row.value, seconds(row.bad_for_s)) == row.words


def test_a_value_between_the_two_thresholds_is_told_with_the_one_it_has_to_reach() -> None:
    bound = Bound("BATTERY_LOW", Comparison.BELOW, 0.5, clear_threshold=0.55)
    settings = SignalSettings(DEFAULTS["battery_level"].spec, (bound,))

    assert value_reason(settings, bound, 0.52, 0) == "battery 52 % is still below 55 %"


@pytest.mark.parametrize(
    ("for_s", "words"), [(0, "bumper is true"), (3, "bumper has been true for 3 s")]
)
def test_a_declared_boolean_is_told_by_its_name(for_s: float, words: str) -> None:
    bound = Bound("BUMPED", Comparison.EQUAL, threshold=True, for_=seconds(for_s))
    settings = SignalSettings(SignalSpec("bumper", SignalKind.BOOLEAN), (bound,))

    assert value_reason(settings, bound, True, bound.for_) == words


@pytest.mark.parametrize(
    ("for_s", "counted_s", "time"),
    [
        (3, 3, "3 s"),
        (0.25, 0.25, "0.25 s"),
        (0.25, 0.29, "0.25 s"),
        (3, 1234.567, "1234.5 s"),
        (3, 2.99, "2.9 s"),
        (3, 3.099_999_999, "3 s"),
    ],
)
def test_a_time_is_never_told_longer_than_it_was(for_s: float, counted_s: float, time: str) -> None:
    bound = Bound("OVERLOAD", Comparison.ABOVE, 1500.0, for_=seconds(for_s))
    settings = SignalSettings(SignalSpec("load", SignalKind.NUMBER, "kg"), (bound,))
    told = value_reason(settings, bound, 1800.0, seconds(counted_s))

    assert told == f"load 1800 kg has been above 1500 kg for {time}"


def test_no_time_is_told_of_an_error_that_did_not_have_to_wait() -> None:
    bound = Bound("SLOW", Comparison.EQUAL, "LOW", for_=seconds(20))
    spec = SignalSpec("radio", SignalKind.ENUMERATION, members=("GOOD", "LOW"))
    settings = SignalSettings(spec, (bound,))

    assert value_reason(settings, bound, "LOW", seconds(0.05)) == "radio is LOW"
    assert value_reason(settings, bound, "LOW", seconds(20)) == "radio is LOW, not GOOD for 20 s"


def test_an_enumeration_that_is_an_error_at_once_is_told_without_a_time() -> None:
    bound = Bound("GEAR_LOST", Comparison.EQUAL, "N")
    spec = SignalSpec("gear", SignalKind.ENUMERATION, members=("D", "N"))

    assert value_reason(SignalSettings(spec, (bound,)), bound, "N", 0) == "gear is N"


@pytest.mark.parametrize(
    ("sources", "words"),
    [
        (["api"], "e-stop is pressed (source api)"),
        (["api", "pad"], "e-stop is pressed (sources api, pad)"),
        (list("abc"), "e-stop is pressed (sources a, b, c)"),
        (list("abcd"), "e-stop is pressed (sources a, b, c and 1 more)"),
        (list("abcde"), "e-stop is pressed (sources a, b, c and 2 more)"),
    ],
)
def test_a_pressed_stop_is_told_with_who_presses_it(sources: list[str], words: str) -> None:
    readings = HeldReadings(DEFAULTS["estop"])
    for at, source in enumerate(sources):
        readings.take(Reading("estop", True), source, at)

    assert pressed_reason(readings, DEFAULTS["estop"].spec) == words


@pytest.mark.parametrize(
    ("is_seen", "words"),
    [(True, "no reading of temperature for 2 s"), (False, "no reading of temperature yet")],
)
def test_a_silent_signal_is_told_apart_from_one_never_heard(is_seen: bool, words: str) -> None:
    assert stale_reason(DEFAULTS["temperature"], is_seen=is_seen) == words


def test_a_silent_signal_says_why_its_source_is_silent() -> None:
    words = stale_reason(DEFAULTS["temperature"], "no such file", is_seen=True)
    assert words == "no reading of temperature for 2 s: no such file"


@pytest.mark.parametrize(
    ("recovery", "words"),
    [
        (
            Recovery.AUTOMATIC,
            "battery no longer causes BATTERY_LOW, which stays active for at least 0.2 s",
        ),
        (
            Recovery.ACKNOWLEDGE,
            "battery no longer causes BATTERY_LOW, which waits for acknowledgement",
        ),
    ],
)
def test_an_error_without_a_cause_is_told_with_what_keeps_it_on(
    recovery: Recovery, words: str
) -> None:
    slot = ErrorSlot(seconds(0.2), recovery)
    slot.update("BATTERY_LOW", 0)
    slot.update(None, 1)

    assert kept_reason(DEFAULTS["battery_level"], slot) == words


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0.49999951, "battery 49.999951 % is below 50 %"),
        (0.49999999995, "battery 49.999999995 % is below 50 %"),
        (0.49999999999999994, "battery 49.999999999999993 % is below 50 %"),
    ],
)
def test_a_value_has_as_many_digits_as_tell_it_from_its_limit(value: float, words: str) -> None:
    settings = DEFAULTS["battery_level"]

    assert value_reason(settings, settings.bounds[0], value, 0) == words


def test_a_number_without_a_unit_is_told_without_a_space() -> None:
    bound = Bound("TOO_MANY", Comparison.ABOVE, 3.0)
    settings = SignalSettings(SignalSpec("people", SignalKind.NUMBER), (bound,))

    assert value_reason(settings, bound, 7.0, 0) == "people 7 is above 3"


def test_a_value_beyond_the_threshold_is_told_with_that_and_not_with_the_clear_threshold() -> None:
    bound = Bound("BATTERY_LOW", Comparison.BELOW, 0.5, clear_threshold=0.55)
    settings = SignalSettings(DEFAULTS["battery_level"].spec, (bound,))

    assert value_reason(settings, bound, 0.42, 0) == "battery 42 % is below 50 %"


def test_all_good_members_are_told() -> None:
    bound = Bound("GEAR_LOST", Comparison.EQUAL, "N", for_=seconds(3))
    spec = SignalSpec("gear", SignalKind.ENUMERATION, members=("D", "R", "N"))
    words = value_reason(SignalSettings(spec, (bound,)), bound, "N", seconds(3))

    assert words == "gear is N, not D or R for 3 s"


def test_an_error_of_an_earlier_run_is_told_with_what_was_measured_then() -> None:
    measured = "temperature 60 °C is above 55 °C"

    assert restored_reason(measured) == (
        "before the restart: temperature 60 °C is above 55 °C; waits for acknowledgement"
    )
