"""Messages that tell why an error of a signal is active."""

from domain.health.error_slot import ErrorSlot
from domain.health.held_readings import HeldReadings
from domain.health.signals import (
    RATIO,
    Bound,
    CountsFrom,
    SignalKind,
    SignalSettings,
    SignalSpec,
)
from domain.inputs import SignalValue
from domain.timebase import Duration, seconds, to_seconds

_NAMED_SOURCES = 3
_TENTH = seconds(0.1)


def value_reason(
    settings: SignalSettings, bound: Bound, value: SignalValue, counted: Duration
) -> str:
    """Return what is wrong with a value, such as "battery 42 % is below 50 %".

    Args:
        settings: Settings of the signal.
        bound: The bound whose error is active.
        value: The value held.
        counted: Time that had counted when the error was raised; see `CountsFrom`.
    """
    spec = settings.spec
    time = _measured(counted, bound.for_)
    if spec.kind is SignalKind.NUMBER:
        return _number_reason(settings, bound, float(value), time)
    said = str(value).lower() if isinstance(value, bool) else value
    if not time:
        return f"{_label(spec)} is {said}"
    good = " or ".join(_good_members(settings))
    if settings.counts_from is CountsFrom.LAST_GOOD:
        return f"{_label(spec)} is {said}, no {good or 'good'} reading for {time}"
    if not good:
        return f"{_label(spec)} has been {said} for {time}"
    return f"{_label(spec)} is {said}, not {good} for {time}"


def unknown_reason(settings: SignalSettings, bound: Bound, last: SignalValue) -> str:
    """Return why an error of a monitor is still active although its value is unknown.

    Args:
        settings: Settings of the monitor.
        bound: The bound whose error is active.
        last: The last value that was known.
    """
    was = value_reason(settings, bound, last, 0)
    return f"{was} as last known; too few readings of it now"


def pressed_reason(readings: HeldReadings, spec: SignalSpec) -> str:
    """Return who presses a stop, such as "e-stop is pressed (source api)"."""
    sources = [held.source for held in readings.pressing]
    named = ", ".join(sources[:_NAMED_SOURCES])
    more = len(sources) - _NAMED_SOURCES
    if more > 0:
        named += f" and {more} more"
    return f"{_label(spec)} is pressed (source{'s' if len(sources) > 1 else ''} {named})"


def stale_reason(settings: SignalSettings, fault: str = "", *, is_seen: bool) -> str:
    """Return that there is no reading yet, or none that is recent enough.

    Args:
        settings: Settings of the signal.
        fault: Why its source gives none; empty: it does not say.
        is_seen: Whether there ever was one.
    """
    since = f"for {_duration(settings.stale_after)}" if is_seen else "yet"
    stale = f"no reading of {settings.spec.name} {since}"
    return f"{stale}: {fault}" if fault else stale


def kept_reason(settings: SignalSettings, slot: ErrorSlot) -> str:
    """Return why an error is still active although its cause is gone."""
    gone = f"{_label(settings.spec)} no longer causes {slot.error}, which"
    if slot.waits_for_acknowledgement:
        return f"{gone} waits for acknowledgement"
    if settings.clear_for:
        return f"{gone} ends once that has lasted {_duration(settings.clear_for)}"
    return f"{gone} stays active for at least {_duration(settings.min_on)}"


def restored_reason(measured: str) -> str:
    """Return why an error is active that was raised before a restart, and nothing read since.

    Args:
        measured: What was measured when it was raised.
    """
    return f"before the restart: {measured}; waits for acknowledgement"


def _number_reason(settings: SignalSettings, bound: Bound, value: float, time: str) -> str:
    spec = settings.spec
    # Between the two thresholds, the value has not reached the clear threshold.
    is_beyond = bound.is_met_by(value)
    limit = float(bound.threshold) if is_beyond else bound.clear_limit
    comparison = f"{bound.comparison} {_quantity(spec, limit)}"
    subject = f"{_label(spec)} {_quantity(spec, value, limit)}"
    if not is_beyond:
        return f"{subject} is still {comparison}"
    if not time:
        return f"{subject} is {comparison}"
    if settings.counts_from is CountsFrom.LAST_GOOD:
        return f"{subject} is {comparison}, no good reading for {time}"
    return f"{subject} has been {comparison} for {time}"


def _measured(counted: Duration, needed: Duration) -> str:
    """Return a time in words, rounded down so that it is never more; empty: none was needed."""
    tenths = counted // _TENTH * _TENTH
    told = max(tenths, needed) if counted >= needed else tenths
    return _duration(told) if needed and told else ""


def _quantity(spec: SignalSpec, value: float, other: float | None = None) -> str:
    """Format a number with its unit, with enough digits to tell it from `other`."""
    scale, unit = (100.0, "%") if spec.unit == RATIO else (1.0, spec.unit)
    for digits in (6, 9, 12, 17):
        text = f"{value * scale:.{digits}g}"
        if other is None or text != f"{other * scale:.{digits}g}":
            break
    return f"{text} {unit}".rstrip()


def _duration(duration: Duration) -> str:
    return f"{to_seconds(duration):g} s"


def _good_members(settings: SignalSettings) -> list[str]:
    return [
        member
        for member in settings.spec.members
        if not any(bound.is_met_by(member) for bound in settings.bounds)
    ]


def _label(spec: SignalSpec) -> str:
    return spec.label or spec.name
