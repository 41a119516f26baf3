"""Types of signals and their error bounds, and the table of the five default signals.

The table and its error bits are those of smart_polaris (`gem_state_manager`); further signals are
declared with the same types.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import NamedTuple

from domain.errors import InvalidValueError
from domain.findings import Fact
from domain.inputs import SignalValue
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import ModeName, PartName
from domain.timebase import Duration, seconds, to_seconds
from domain.windows.settings import WindowSettings

ESTOP_SIGNAL = "estop"
ESTOP = "ESTOP"
STALE_DATA = "STALE_DATA"
STALE_DATA_BIT = 64
DECLARED_BIT = 128
"""Bit shared by the errors of all declared signals; their names tell them apart."""

RATIO = "ratio"
"""Unit of a number from 0 to 1 that messages show as a percentage."""


class SignalKind(StrEnum):
    """Type of the values of a signal."""

    NUMBER = "number"
    BOOLEAN = "boolean"
    ENUMERATION = "enumeration"


class Comparison(StrEnum):
    """How a value is compared with a threshold; above and below are strict."""

    ABOVE = "above"
    BELOW = "below"
    EQUAL = "equal"


_FLOAT32_ROUNDING = 2.0**-22
"""Largest relative error of a value that a sender computed in single precision: two units in the
last place."""

_STOP_WORDS = frozenset({"true", "1", "yes", "on"})


def asks_for_stop(value: object) -> bool:
    """Tell whether the value of a stop asks the robot to stop.

    Senders write true in several ways: True, the number 1, or one of the words true, yes, on and 1.
    Only False releases a stop; there is no such leniency for it.
    """
    if isinstance(value, str):
        return value.strip().lower() in _STOP_WORDS
    return value is True or (isinstance(value, int | float) and value == 1)


def signal_name(name: str) -> str:
    """Return the name of a signal without the leading slash of its topic in ROS."""
    return name.lstrip("/")


def stale_error(name: str) -> str:
    """Return the error of a signal of its own that is stale."""
    return f"{name.upper()}_STALE"


class Recovery(StrEnum):
    """How an error clears once its cause is gone."""

    AUTOMATIC = "automatic"
    ACKNOWLEDGE = "acknowledge"
    """Only after an operator has acknowledged it, before or after the cause was gone."""


class CountsFrom(StrEnum):
    """Where the time of an error begins that is raised only after a time."""

    FIRST_BAD = "first_bad"
    """At the first bad reading after a good one, or after the signal was stale."""
    LAST_GOOD = "last_good"
    """At the last good reading, or at the start: silence counts, too. As in smart_polaris."""


@dataclass(frozen=True, slots=True)
class SignalSpec:
    """Name, type and range of a signal.

    Raises:
        InvalidValueError: Members that do not fit the type, or a stop that is not boolean.
    """

    name: str
    kind: SignalKind
    unit: str = ""
    label: str = ""
    """Its name in messages; empty: `name`."""
    minimum: float | None = None
    maximum: float | None = None
    members: tuple[str, ...] = ()
    """Values of an enumeration, from good to bad."""
    codes: tuple[int, ...] = ()
    """Numeric codes of the members, as in a ROS message; empty: there are none."""
    is_stop: bool = False
    """The value true stops the robot. One source cannot release what another presses, and a
    reading that presses is never rejected.
    """

    def __post_init__(self) -> None:
        if (self.kind is SignalKind.ENUMERATION) is not bool(self.members):
            raise InvalidValueError(
                f"{self.name}: an enumeration needs members; other kinds have none", self.name
            )
        if len(set(self.members)) != len(self.members):
            raise InvalidValueError(f"{self.name}: duplicate member", self.name)
        if self.is_stop and self.kind is not SignalKind.BOOLEAN:
            raise InvalidValueError(f"{self.name}: a stop must be boolean", self.name)

    def checked(self, value: object) -> SignalValue:
        """Return `value` as this signal holds it: a number as a float, -0.0 as 0.0.

        A number that is beyond a limit by no more than the rounding of single precision is that
        limit: a full battery reads 1.0000001.

        Raises:
            InvalidValueError: It has the wrong type, is not finite, out of range or not a member. A
                boolean is not a number, and a number is not a boolean, except that a stop takes all
                that `asks_for_stop`.
        """
        match self.kind:
            case SignalKind.NUMBER:
                return self._checked_number(value)
            case SignalKind.BOOLEAN:
                if self.is_stop and asks_for_stop(value):
                    return True
                if isinstance(value, bool):
                    return value
                raise self._invalid("true or false", value)
            case SignalKind.ENUMERATION:
                if isinstance(value, str) and value in self.members:
                    return value
                if not isinstance(value, bool) and value in self.codes:
                    return self.members[self.codes.index(value)]
                raise self._invalid(f"one of {', '.join(self.members)}", value)

    def _checked_number(self, value: object) -> float:
        number = value if type(value) is float else self._as_float(value)
        if not math.isfinite(number):
            raise self._invalid("a finite number", number)
        if self.minimum is not None and number < self.minimum:
            if number < self.minimum - _rounding(self.minimum):
                raise self._invalid(f"at least {self.minimum:g}", number)
            number = self.minimum
        if self.maximum is not None and number > self.maximum:
            if number > self.maximum + _rounding(self.maximum):
                raise self._invalid(f"at most {self.maximum:g}", number)
            number = self.maximum
        return number or 0.0

    def _as_float(self, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._invalid("a number", value)
        try:
            return float(value)
        except OverflowError:
            return math.inf

    def _invalid(self, wanted: str, value: object) -> InvalidValueError:
        return InvalidValueError(f"{self.name} must be {wanted}, not {value!r:.40}", self.name)


@dataclass(frozen=True, slots=True)
class Bound:
    """Which values of a signal are an error, and after how long."""

    error: str
    comparison: Comparison
    threshold: SignalValue
    clear_threshold: float | None = None
    """For a number: where an active error clears (hysteresis); None: at the threshold."""
    for_: Duration = 0
    """Time after which the error is raised, see `CountsFrom`; 0: at once."""
    bit: int = DECLARED_BIT
    key: str = ""
    """Prefix that tells the settings of several bounds apart, as in `lost_for_s`."""

    def is_met_by(self, value: SignalValue, *, error_is_on: bool = False) -> bool:
        """Tell whether `value` is bad; while the error is active, the clear threshold decides."""
        if self.comparison is Comparison.EQUAL:
            return value == self.threshold
        limit = self.clear_limit if error_is_on else float(self.threshold)
        if self.comparison is Comparison.ABOVE:
            return float(value) > limit
        return float(value) < limit

    @property
    def clear_limit(self) -> float:
        """Return where the error of a number clears."""
        return float(self.threshold) if self.clear_threshold is None else self.clear_threshold

    def facts(self) -> dict[str, Fact]:
        """Return what is bad, and which error that is, as plain values."""
        facts: dict[str, Fact] = {"error": self.error}
        if self.comparison is Comparison.EQUAL:
            facts["bad_value"] = self.threshold
        else:
            facts |= {"bad_side": str(self.comparison), "threshold": self.threshold}
            facts["clear_threshold"] = self.clear_limit
        return {**facts, "for_s": to_seconds(self.for_)}

    def badness(self, value: float) -> float:
        """Return by how much a number exceeds the threshold on its bad side; negative: good."""
        excess = value - float(self.threshold)
        return excess if self.comparison is Comparison.ABOVE else -excess


class Raisable(NamedTuple):
    """An error that can be raised."""

    key: ErrorKey
    """Whose it is, and its name."""
    bit: int
    """Its bit in the error code; 0: it sets none, and the robot is not in ERROR because of it."""


@dataclass(frozen=True, slots=True)
class MonitorSettings:
    """What the value of a monitor is computed from."""

    of: str
    """The signal, which may be a monitor as well."""
    window: WindowSettings

    def facts(self) -> dict[str, Fact]:
        """Return the settings as plain values, with units in the names."""
        length, size = self.window.length, self.window.size
        window = ("window_n", size) if length is None else ("window_s", to_seconds(length))
        return {"of": self.of, "statistic": str(self.window.statistic), window[0]: window[1]}


@dataclass(frozen=True, slots=True)
class ModeLimit:
    """The bound of a signal while a part is in a mode."""

    bound: Bound | None
    """None: no value is bad."""
    part: PartName | None = None
    """None: in all modes of which nothing is said."""
    mode: ModeName | None = None

    @property
    def name(self) -> str:
        """Return in which mode it is in force, as the robot file says."""
        return "default" if self.part is None else f"{self.part}.{self.mode}"


@dataclass(frozen=True, slots=True)
class SignalSettings:
    """A signal with its bounds and settings.

    Raises:
        InvalidValueError: A bound does not fit the signal; `pointer` is
            `<signal>/<setting>`.
    """

    spec: SignalSpec
    bounds: tuple[Bound, ...] = ()
    """Most urgent first; empty for a number that is only shown."""
    stale_after: Duration = seconds(2.0)
    """Readings older than this are stale; 0 turns staleness off."""
    min_on: Duration = seconds(0.2)
    """Minimum time that an error of this signal stays active, so that a short one is seen."""
    clear_for: Duration = 0
    """How long the cause of a value error has to be gone before the error clears."""
    recovery: Recovery = Recovery.AUTOMATIC
    """Recovery of value errors; staleness always recovers automatically."""
    counts_from: CountsFrom = CountsFrom.FIRST_BAD
    """Where `for_` of the bounds begins."""
    part: PartName | None = None
    """Whose errors these are; None: the robot's own."""
    severity: Severity = Severity.CRITICAL
    """How bad its errors are, and that it is stale."""
    monitor: MonitorSettings | None = None
    """None: it is read, and not computed."""
    limits: tuple[ModeLimit, ...] = ()
    """Bounds by mode, of which the first that applies takes the place of `bounds`; all of them have
    the same error."""

    def __post_init__(self) -> None:
        if len({bound.key for bound in self.bounds}) != len(self.bounds):
            raise self._invalid("key", "must differ between bounds")
        for duration, setting in (
            (self.stale_after, "stale_after_s"),
            (self.min_on, "min_on_s"),
            (self.clear_for, "clear_for_s"),
        ):
            if duration < 0:
                raise self._invalid(setting, "must not be negative")
        for bound in (*self.bounds, *self._bounds_of_modes()):
            self._check_bound(bound)

    def with_limit(self, limit: ModeLimit | None) -> "SignalSettings":
        """Return these settings while a limit is in force; None: none is."""
        bound = None if limit is None else limit.bound
        return replace(self, bounds=() if bound is None else (bound,))

    def _bounds_of_modes(self) -> Iterator[Bound]:
        return (limit.bound for limit in self.limits if limit.bound is not None)

    @property
    def value_errors(self) -> tuple[str, ...]:
        """Return the errors that its values can raise, the most urgent first."""
        bounds = (*self.bounds, *self._bounds_of_modes())
        return tuple(dict.fromkeys(bound.error for bound in bounds))

    @property
    def stale_key(self) -> ErrorKey:
        """Return which error it raises while it is stale.

        Critical signals share one of the robot: what it cannot do without is not known.
        """
        if self.severity.stops_task:
            return ErrorKey(None, STALE_DATA)
        return ErrorKey(self.part, stale_error(self.spec.name))

    def can_raise(self) -> dict[str, Raisable]:
        """Return the errors that it can raise, by name."""
        stale, sets_bit = self.stale_key, self.severity.stops_task
        raisable = {}
        for bound in (*self.bounds, *self._bounds_of_modes()):
            key = ErrorKey(self.part, bound.error)
            raisable[bound.error] = Raisable(key, bound.bit if sets_bit else 0)
        if sets_bit:
            raisable[stale.error] = Raisable(stale, STALE_DATA_BIT)
        elif self.stale_after:
            raisable[stale.error] = Raisable(stale, 0)
        return raisable

    def is_worse(self, value: SignalValue, held: SignalValue) -> bool:
        """Tell whether `value` is worse than the one held."""
        return self._badness(value) > self._badness(held)

    def facts(self) -> dict[str, Fact]:
        """Return the settings as plain values, with units in the names."""
        facts: dict[str, Fact] = {"label": self.spec.label} if self.spec.label else {}
        for bound in self.bounds:
            facts |= {_prefixed(bound, name): fact for name, fact in bound.facts().items()}
        if self.monitor is not None:
            facts |= self.monitor.facts()
        facts |= {
            "stale_after_s": to_seconds(self.stale_after),
            "min_on_s": to_seconds(self.min_on),
            "clear_for_s": to_seconds(self.clear_for),
            "recovery": str(self.recovery),
            "severity": str(self.severity),
        }
        if self.part is not None:
            facts["part"] = self.part
        if self.spec.kind is SignalKind.NUMBER:
            facts |= {"minimum": self.spec.minimum, "maximum": self.spec.maximum}
        elif self.spec.members:
            facts["members"] = ", ".join(self.spec.members)
        return facts

    def _badness(self, value: SignalValue) -> float:
        if isinstance(value, str):
            return self.spec.members.index(value)
        if isinstance(value, bool):
            return any(bound.is_met_by(value) for bound in self.bounds)
        return max((bound.badness(value) for bound in self.bounds), default=0.0)

    def _check_bound(self, bound: Bound) -> None:
        is_number = self.spec.kind is SignalKind.NUMBER
        if is_number is (bound.comparison is Comparison.EQUAL):
            words = "must be compared above or below for numbers, and equal for everything else"
            raise self._invalid(_prefixed(bound, "threshold"), words)
        self._check_threshold(bound, "threshold", bound.threshold)
        if bound.for_ < 0:
            raise self._invalid(_prefixed(bound, "for_s"), "must not be negative")
        if bound.clear_threshold is None:
            return
        setting = _prefixed(bound, "clear_threshold")
        if not is_number:
            raise self._invalid(setting, "is for numbers only")
        self._check_threshold(bound, "clear_threshold", bound.clear_threshold)
        if bound.badness(bound.clear_threshold) > 0:
            raise self._invalid(setting, "must be on the good side of the threshold")

    def _check_threshold(self, bound: Bound, name: str, value: SignalValue) -> None:
        try:
            self.spec.checked(value)
        except InvalidValueError as error:
            setting = _prefixed(bound, name)
            raise self._invalid(setting, f"can never be reached: {error.message}") from error

    def _invalid(self, setting: str, what: str) -> InvalidValueError:
        pointer = f"{self.spec.name}/{setting}"
        return InvalidValueError(f"{setting} of {self.spec.name} {what}", pointer)


def _rounding(limit: float) -> float:
    """Return what single precision may add to a value at a limit; at 0, to one of about 1."""
    return _FLOAT32_ROUNDING * (abs(limit) or 1.0)


def _prefixed(bound: Bound, setting: str) -> str:
    return f"{bound.key}_{setting}" if bound.key else setting


_NUMBER, _ABOVE, _BELOW = SignalKind.NUMBER, Comparison.ABOVE, Comparison.BELOW
_EQUAL = Comparison.EQUAL

_DEFAULT_SIGNALS = (
    SignalSettings(
        SignalSpec("battery_level", _NUMBER, RATIO, "battery", minimum=0.0, maximum=1.0),
        (Bound("BATTERY_LOW", _BELOW, 0.5, bit=1),),
    ),
    SignalSettings(
        SignalSpec(ESTOP_SIGNAL, SignalKind.BOOLEAN, label="e-stop", is_stop=True),
        (Bound(ESTOP, _EQUAL, threshold=True, bit=2),),
    ),
    SignalSettings(
        SignalSpec("gps_accuracy", _NUMBER, "mm", "GPS accuracy", minimum=0.0),
        (Bound("GPS_LOST", _ABOVE, 200.0, for_=seconds(15.0), bit=4),),
        counts_from=CountsFrom.LAST_GOOD,
    ),
    SignalSettings(
        SignalSpec(
            "signal_strength",
            SignalKind.ENUMERATION,
            label="signal strength",
            members=("CONNECTED", "LOW_SIGNAL", "NOT_CONNECTED"),
            codes=(1, 2, 0),
        ),
        (
            Bound("SIGNAL_LOST", _EQUAL, "NOT_CONNECTED", for_=seconds(10.0), bit=8, key="lost"),
            Bound("SIGNAL_LOW", _EQUAL, "LOW_SIGNAL", for_=seconds(20.0), bit=16, key="low"),
        ),
        counts_from=CountsFrom.LAST_GOOD,
    ),
    SignalSettings(
        SignalSpec("temperature", _NUMBER, "°C"),
        (Bound("TEMPERATURE_HIGH", _ABOVE, 55.0, bit=32),),
    ),
)


def default_signals() -> tuple[SignalSettings, ...]:
    """Return the five signals of smart_polaris with its thresholds and error bits.

    Its README specifies inclusive times (">= 15 s"), which its code misses by one instant; this
    follows the README. Staleness is on here, and off there.

    Source: smart_polaris, README, `state_manager.cpp` and `SystemStateStamped.msg`.
    """
    return _DEFAULT_SIGNALS
