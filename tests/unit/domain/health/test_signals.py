import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.errors import InvalidValueError
from domain.health.signals import (
    DECLARED_BIT,
    Bound,
    Comparison,
    Recovery,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.inputs import SignalValue
from domain.snapshot import Severity
from domain.state_and_mode import PartName
from domain.timebase import seconds
from tests.support.tables import text_table

DEFAULTS = {item.spec.name: item for item in default_signals()}

# smart_polaris, README and SystemStateStamped.msg
TABLE = [
    # signal, error, its bit, comparison, threshold, for how long in s
    ("battery_level", "BATTERY_LOW", 1, "below", 0.5, 0.0),
    ("estop", "ESTOP", 2, "equal", True, 0.0),
    ("gps_accuracy", "GPS_LOST", 4, "above", 200.0, 15.0),
    ("signal_strength", "SIGNAL_LOST", 8, "equal", "NOT_CONNECTED", 10.0),
    ("signal_strength", "SIGNAL_LOW", 16, "equal", "LOW_SIGNAL", 20.0),
    ("temperature", "TEMPERATURE_HIGH", 32, "above", 55.0, 0.0),
]


def test_the_defaults_are_the_table_of_smart_polaris() -> None:
    rows = [
        (item.spec.name, c.error, c.bit, c.comparison.value, c.threshold, c.for_ / seconds(1))
        for item in default_signals()
        for c in item.bounds
    ]

    assert sorted(rows, key=lambda row: row[2]) == TABLE


def test_every_signal_is_stale_after_two_seconds_and_shows_errors_for_a_fifth_of_one() -> None:
    for item in default_signals():
        assert item.stale_after == seconds(2)
        assert item.min_on == seconds(0.2)
        assert item.recovery is Recovery.AUTOMATIC


TAKEN: list[tuple[str, object, SignalValue]] = [
    ("battery_level", 0, 0.0),
    ("battery_level", 1, 1.0),
    ("battery_level", -0.0, 0.0),
    ("temperature", -40, -40.0),
    ("temperature", 1e308, 1e308),
    ("gps_accuracy", 5e-324, 5e-324),
    ("estop", True, True),
    ("signal_strength", "LOW_SIGNAL", "LOW_SIGNAL"),
]


@pytest.mark.parametrize(("signal", "value", "held"), TAKEN)
def test_a_possible_value_is_taken(signal: str, value: object, held: SignalValue) -> None:
    checked = DEFAULTS[signal].spec.checked(value)

    assert checked == held
    assert type(checked) is type(held)
    assert not str(checked).startswith("-0.0")


REFUSED: list[tuple[str, object, str]] = [
    ("battery_level", math.nan, "battery_level must be a finite number, not nan"),
    ("battery_level", math.inf, "battery_level must be a finite number, not inf"),
    ("temperature", -math.inf, "temperature must be a finite number, not -inf"),
    ("temperature", 10**400, "temperature must be a finite number, not inf"),
    ("battery_level", 1.5, "battery_level must be at most 1, not 1.5"),
    ("battery_level", 1.000001, "battery_level must be at most 1, not 1.000001"),
    ("battery_level", -1e-6, "battery_level must be at least 0, not -1e-06"),
    ("gps_accuracy", -1, "gps_accuracy must be at least 0, not -1.0"),
    ("battery_level", True, "battery_level must be a number, not True"),
    ("battery_level", "0.5", "battery_level must be a number, not '0.5'"),
    ("battery_level", None, "battery_level must be a number, not None"),
    ("estop", 2, "estop must be true or false, not 2"),
    ("estop", 0.0, "estop must be true or false, not 0.0"),
    ("estop", "false", "estop must be true or false, not 'false'"),
    ("signal_strength", 7, "must be one of CONNECTED, LOW_SIGNAL, NOT_CONNECTED, not 7"),
    ("signal_strength", "connected", "must be one of CONNECTED, LOW_SIGNAL, NOT_CONNECTED, not"),
    ("signal_strength", ["CONNECTED"], "must be one of CONNECTED, LOW_SIGNAL, NOT_CONNECTED"),
]


@pytest.mark.parametrize(("signal", "value", "message"), REFUSED)
def test_an_impossible_value_is_refused_by_name(signal: str, value: object, message: str) -> None:
    with pytest.raises(InvalidValueError) as refusal:
        DEFAULTS[signal].spec.checked(value)

    assert message in refusal.value.message
    assert refusal.value.pointer == signal


def test_a_refusal_does_not_repeat_a_page_of_text() -> None:
    with pytest.raises(InvalidValueError) as refusal:
        DEFAULTS["estop"].spec.checked("x" * 100_000)

    assert len(refusal.value.message) < 100


VOLTAGE = SignalSpec("voltage", SignalKind.NUMBER, "V", minimum=0.0, maximum=60.0)
LOW = Bound("VOLTAGE_LOW", Comparison.BELOW, 20.0)


@text_table("""
    voltage | an error that is off | an error that is on
    19.9    | begins               | stays on
    20.0    | stays off            | stays on
    21.9    | stays off            | stays on
    22.0    | stays off            | ends
""")
def test_an_error_that_is_on_ends_only_at_the_clear_threshold(
    voltage: str, an_error_that_is_off: str, an_error_that_is_on: str
) -> None:
    bound = Bound("VOLTAGE_LOW", Comparison.BELOW, 20.0, clear_threshold=22.0)
    begins, stays = an_error_that_is_off == "begins", an_error_that_is_on == "stays on"

    assert bound.is_met_by(float(voltage)) is begins
    assert bound.is_met_by(float(voltage), error_is_on=True) is stays


def test_a_declared_error_has_the_bit_that_all_declared_ones_share() -> None:
    assert LOW.bit == DECLARED_BIT == 128


def test_worse_is_judged_on_both_sides_where_both_are_errors() -> None:
    high = Bound("VOLTAGE_HIGH", Comparison.ABOVE, 30.0, key="high")
    settings = SignalSettings(VOLTAGE, (LOW, high))

    assert settings.is_worse(31.0, 25.0)
    assert settings.is_worse(19.0, 25.0)
    assert not settings.is_worse(25.0, 31.0)


FACTS = {
    "battery_level": {
        "label": "battery",
        "error": "BATTERY_LOW",
        "bad_side": "below",
        "threshold": 0.5,
        "clear_threshold": 0.5,
        "for_s": 0.0,
        "stale_after_s": 2.0,
        "min_on_s": 0.2,
        "clear_for_s": 0.0,
        "recovery": "automatic",
        "severity": "critical",
        "minimum": 0.0,
        "maximum": 1.0,
    },
    "signal_strength": {
        "label": "signal strength",
        "lost_error": "SIGNAL_LOST",
        "lost_bad_value": "NOT_CONNECTED",
        "lost_for_s": 10.0,
        "low_error": "SIGNAL_LOW",
        "low_bad_value": "LOW_SIGNAL",
        "low_for_s": 20.0,
        "stale_after_s": 2.0,
        "min_on_s": 0.2,
        "clear_for_s": 0.0,
        "recovery": "automatic",
        "severity": "critical",
        "members": "CONNECTED, LOW_SIGNAL, NOT_CONNECTED",
    },
    "estop": {
        "label": "e-stop",
        "error": "ESTOP",
        "bad_value": True,
        "for_s": 0.0,
        "stale_after_s": 2.0,
        "min_on_s": 0.2,
        "clear_for_s": 0.0,
        "recovery": "automatic",
        "severity": "critical",
    },
}


@pytest.mark.parametrize("signal", FACTS)
def test_settings_can_be_shown_as_plain_values(signal: str) -> None:
    assert DEFAULTS[signal].facts() == FACTS[signal]


def test_the_settings_tell_whose_error_it_is_unless_it_is_the_robots_own() -> None:
    of_a_part = replace(DEFAULTS["temperature"], part=PartName("drive"), severity=Severity.URGENT)
    facts = of_a_part.facts()
    assert (facts["part"], facts["severity"]) == ("drive", "urgent")
    assert "label" not in facts


def declare(*bounds: Bound, spec: SignalSpec = VOLTAGE) -> SignalSettings:
    return SignalSettings(spec, bounds)


def low(threshold: SignalValue = 20.0, clear: float | None = None, for_: int = 0) -> Bound:
    return Bound("LOW", Comparison.BELOW, threshold, clear, for_)


RELAY = SignalSpec("relay", SignalKind.BOOLEAN)
KIND = "threshold of {} must be compared above or below for numbers, and equal for everything else"
UNFIT = [
    (VOLTAGE, low(threshold=-1.0), "voltage/threshold"),
    (VOLTAGE, low(threshold=math.nan), "voltage/threshold"),
    (VOLTAGE, low(threshold=True), "voltage/threshold"),
    (VOLTAGE, low(clear=61.0), "voltage/clear_threshold"),
    (VOLTAGE, low(clear=19.0), "voltage/clear_threshold"),
    (VOLTAGE, low(for_=-1), "voltage/for_s"),
    (VOLTAGE, Bound("ODD", Comparison.EQUAL, 20.0), "voltage/threshold"),
    (RELAY, Bound("ODD", Comparison.ABOVE, threshold=True), "relay/threshold"),
    (RELAY, Bound("ODD", Comparison.EQUAL, 1.0), "relay/threshold"),
    (RELAY, Bound("ODD", Comparison.EQUAL, threshold=True, clear_threshold=0.5), "relay/clear"),
    (DEFAULTS["signal_strength"].spec, Bound("ODD", Comparison.EQUAL, "GONE"), "strength/thr"),
]


@pytest.mark.parametrize(("spec", "bound", "pointer"), UNFIT)
def test_a_condition_that_does_not_fit_its_signal_is_refused(
    spec: SignalSpec, bound: Bound, pointer: str
) -> None:
    with pytest.raises(InvalidValueError) as refusal:
        declare(bound, spec=spec)

    assert pointer in refusal.value.pointer


@pytest.mark.parametrize(
    ("spec", "bound", "message"),
    [
        (VOLTAGE, low(for_=-1), "for_s of voltage must not be negative"),
        (
            VOLTAGE,
            low(clear=19.0),
            "clear_threshold of voltage must be on the good side of the threshold",
        ),
        (
            VOLTAGE,
            low(clear=61.0),
            "clear_threshold of voltage can never be reached: voltage must be at most 60, not 61.0",
        ),
        (
            RELAY,
            Bound("ODD", Comparison.EQUAL, threshold=True, clear_threshold=0.5),
            "clear_threshold of relay is for numbers only",
        ),
        (VOLTAGE, Bound("ODD", Comparison.EQUAL, 20.0), KIND.format("voltage")),
        (RELAY, Bound("ODD", Comparison.ABOVE, threshold=True), KIND.format("relay")),
    ],
)
def test_a_condition_that_does_not_fit_is_refused_in_words(
    spec: SignalSpec, bound: Bound, message: str
) -> None:
    with pytest.raises(InvalidValueError) as refusal:
        declare(bound, spec=spec)

    assert refusal.value.message == message


def test_a_clear_threshold_may_be_the_threshold_itself() -> None:
    assert declare(low(clear=20.0)).facts()["clear_threshold"] == 20.0


@pytest.mark.parametrize(
    ("stale_after", "min_on", "pointer"),
    [(-1, 0, "voltage/stale_after_s"), (0, -1, "voltage/min_on_s")],
)
def test_a_time_is_not_negative(stale_after: int, min_on: int, pointer: str) -> None:
    with pytest.raises(InvalidValueError) as refusal:
        SignalSettings(VOLTAGE, (low(),), stale_after, min_on)

    assert refusal.value.pointer == pointer
    assert refusal.value.message == f"{pointer.partition('/')[2]} of voltage must not be negative"


def test_two_conditions_are_told_apart_by_their_keys() -> None:
    with pytest.raises(InvalidValueError) as refusal:
        declare(low(), Bound("HIGH", Comparison.ABOVE, 30.0))

    assert refusal.value.message == "key of voltage must differ between bounds"
    assert refusal.value.pointer == "voltage/key"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: SignalSpec("gear", SignalKind.ENUMERATION),
            "gear: an enumeration needs members; other kinds have none",
        ),
        (
            lambda: SignalSpec("gear", SignalKind.ENUMERATION, members=("D", "D")),
            "gear: duplicate member",
        ),
        (
            lambda: SignalSpec("gear", SignalKind.NUMBER, members=("D",)),
            "gear: an enumeration needs members; other kinds have none",
        ),
        (
            lambda: SignalSpec("gear", SignalKind.NUMBER, is_stop=True),
            "gear: a stop must be boolean",
        ),
    ],
)
def test_a_signal_that_contradicts_itself_is_refused(make: object, message: str) -> None:
    assert callable(make)
    with pytest.raises(InvalidValueError) as refusal:
        make()

    assert refusal.value.pointer == "gear"
    assert refusal.value.message == message


@pytest.mark.parametrize(
    ("code", "member"),
    [(0, "NOT_CONNECTED"), (1, "CONNECTED"), (2, "LOW_SIGNAL"), (2.0, "LOW_SIGNAL")],
)
def test_the_signal_strength_may_be_given_by_its_number(code: float, member: str) -> None:
    """smart_polaris, `SignalStrengthStamped.msg`."""
    strength = next(s.spec for s in default_signals() if s.spec.name == "signal_strength")

    assert strength.checked(code) == member


@pytest.mark.parametrize("value", [3, 1.5, -1, True, False, "1"])
def test_what_is_no_number_of_a_signal_strength_is_refused(value: object) -> None:
    strength = next(s.spec for s in default_signals() if s.spec.name == "signal_strength")

    with pytest.raises(InvalidValueError):
        strength.checked(value)


def test_a_pressed_stop_is_worse_than_a_released_one() -> None:
    stop = DEFAULTS["estop"]

    assert stop.is_worse(True, False)
    assert not stop.is_worse(False, True)
    assert not stop.is_worse(True, True)


def test_of_named_values_the_later_in_the_list_is_the_worse_one() -> None:
    strength = DEFAULTS["signal_strength"]

    assert strength.is_worse("NOT_CONNECTED", "LOW_SIGNAL")
    assert not strength.is_worse("CONNECTED", "LOW_SIGNAL")


def test_of_a_number_without_conditions_no_value_is_worse() -> None:
    assert not SignalSettings(VOLTAGE).is_worse(31.0, 25.0)


def test_a_value_equal_to_that_of_the_condition_meets_it() -> None:
    lost = DEFAULTS["signal_strength"].bounds[0]

    assert lost.is_met_by("NOT_CONNECTED")
    assert not lost.is_met_by("CONNECTED")


def test_a_boolean_without_conditions_is_never_worse() -> None:
    settings = SignalSettings(RELAY)

    assert not settings.is_worse(True, False)


@pytest.mark.parametrize("value", [True, 1, 1.0, "true", "True", " TRUE ", "1", "yes", "ON"])
def test_all_that_asks_for_a_stop_stops(value: object) -> None:
    assert _spec("estop").checked(value) is True


@pytest.mark.parametrize(
    "value", [None, 0, 0.0, "", "false", "0", "off", "maybe", [], {}, [True], math.nan]
)
def test_only_false_releases_a_stop(value: object) -> None:
    assert _spec("estop").checked(False) is False
    with pytest.raises(InvalidValueError, match="estop must be true or false"):
        _spec("estop").checked(value)


@pytest.mark.parametrize(
    ("name", "value", "taken"),
    [
        ("battery_level", 1.0000001, 1.0),
        ("battery_level", float(np.nextafter(np.float32(1), np.float32(2))), 1.0),
        ("battery_level", -5.96e-8, 0.0),
        ("gps_accuracy", -1e-7, 0.0),
    ],
)
def test_the_rounding_of_single_precision_is_taken_at_each_limit(
    name: str, value: float, taken: float
) -> None:
    assert _spec(name).checked(value) == taken


@given(st.floats(-1e6, 1e6, width=32), st.booleans())
def test_a_limit_in_single_precision_is_taken_and_a_percent_beyond_it_is_not(
    limit: float, is_maximum: bool
) -> None:
    spec = SignalSpec(
        "load",
        SignalKind.NUMBER,
        minimum=None if is_maximum else limit,
        maximum=limit if is_maximum else None,
    )
    beyond = np.float32(math.inf if is_maximum else -math.inf)
    off = max(abs(limit), 1.0) * (0.01 if is_maximum else -0.01)

    if abs(limit) > 1e-30:
        assert spec.checked(float(np.nextafter(np.float32(limit), beyond))) == limit
    with pytest.raises(InvalidValueError):
        spec.checked(limit + off)


def _spec(name: str) -> SignalSpec:
    return next(item.spec for item in default_signals() if item.spec.name == name)
