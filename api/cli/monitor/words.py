"""Texts of the monitor for single values: pure functions."""

import math
from collections.abc import Mapping
from datetime import datetime
from typing import Any

Json = Mapping[str, Any]

UNKNOWN = "?"

_FIVE_DIGITS = 1e4
_MOST_DECIMALS = 6
_DECIMALS: Mapping[str, int] = {
    **dict.fromkeys(("mm", "ms", "W", "B", "kB", "MB"), 0),
    **dict.fromkeys(("°C", "K", "cm", "s", "min", "°", "Hz", "1/s", "kg", "N", "Nm", "%", "GB"), 1),
    **dict.fromkeys(("m", "km", "m/s", "rad/s", "V", "A", "bar"), 2),
    "rad": 3,
}
"""Decimals of the units that one meets on robots, so that a number does not change its width."""


def duration(seconds: float) -> str:
    """Return "12 s", "3 min 5 s" or "2 h 4 min", in whole seconds for easy reading."""
    whole = int(max(0.0, seconds))
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def time_of_day(seconds: float) -> str:
    """Return the local time of day.

    Args:
        seconds: Since 1970.
    """
    return datetime.fromtimestamp(seconds).astimezone().strftime("%H:%M:%S")


def date_and_time(seconds: float) -> str:
    """Return the local date and time, as in "Mon May  4 12:00:00 2026".

    Args:
        seconds: Since 1970.
    """
    return datetime.fromtimestamp(seconds).astimezone().ctime()


def label(pair: Json | None) -> str:
    """Return "active.FAST", as in ROS 2; nothing for none."""
    if pair is None:
        return ""
    if pair["state"] == "unknown":
        return UNKNOWN
    return f"{pair['state']}.{pair['mode']}" if pair["mode"] else str(pair["state"])


def starred(text: str, *, inferred: bool) -> str:
    """Return a state or mode, with `(*)` behind one that was inferred; nothing for none."""
    return f"{text}(*)" if text and inferred else text


def value_words(signal: Json, *, is_stop_engaged: bool = False) -> str:
    """Return the value of a signal with its unit; the stop is engaged whatever its signal says.

    Args:
        signal: As in frames.
        is_stop_engaged: Whether the emergency stop is engaged.
    """
    said = _plain_value(signal)
    is_stop = signal["signal"] == "estop"
    return f"stop engaged (signal: {said})" if is_stop and is_stop_engaged else said


def _plain_value(signal: Json) -> str:
    value, unit = signal["value"], signal["unit"]
    if value is None:
        return UNKNOWN
    if isinstance(value, bool):
        if signal["signal"] == "estop":
            return "pressed" if value else "not pressed"
        return "yes" if value else "no"
    if isinstance(value, str):
        return value.lower().replace("_", " ")
    if unit == "ratio":
        return f"{round(value * 100, 1):g} %"
    return f"{figure(value, unit)} {unit}".rstrip()


def figure(value: float, unit: str) -> str:
    """Return a number with the digits of its unit, more for a small one.

    Five digits count where the unit is not known: 1800.1, 0.012346, 123456.
    """
    usual = _DECIMALS.get(unit)
    if usual is not None and abs(value) < _FIVE_DIGITS:
        is_small = 0 < abs(value) < 1
        decimals = max(usual, 1 - math.floor(math.log10(abs(value)))) if is_small else usual
        if decimals <= _MOST_DECIMALS:
            return f"{value:.{decimals}f}"
    whole = f"{value:.0f}"
    return whole if abs(value) >= _FIVE_DIGITS else f"{value:.5g}"


def setter(target: Json | None) -> str:
    """Return who set a target in force, such as "rule slow_down"; empty: it was requested.

    Args:
        target: As in frames; None: there is none.
    """
    if target is None or target["because"] == "requested":
        return ""
    return f"{target['because']} {target['rule'] or ''}".rstrip()


def setter_and_reason(target: Json | None) -> str:
    """Return who set a target in force and why, such as "invariant: temperature is 55 °C".

    Args:
        target: As in frames; None: there is none.
    """
    who = setter(target)
    if not who or target is None or not target["blockers"]:
        return who
    return f"{who}: {target['blockers'][0]['message']}"


def verdict_words(signal: Json, pending_s: float | None, *, is_live: bool = True) -> str:
    """Return the errors of a signal, or "ok"; nothing is ok that was never received.

    Args:
        signal: As in frames.
        pending_s: How long an error has been pending, s; None: none is.
        is_live: Whether there is contact with the service.
    """
    error, pending = signal["error"], signal["pending"]
    said = [error] if error else []
    if signal["source_fault"]:
        said.append(f"no reading: {signal['source_fault']}")
    elif signal["stale"] and error != "STALE_DATA":
        said.append("stale")
    if not is_live:
        return f"was {', '.join(said)}" if said else "no contact"
    if pending is not None and pending_s is not None:
        said.append(f"{pending['error']} in {duration(pending['needs_s'] - pending_s + 0.999)}")
    return ", ".join(said) or ("ok" if signal["received_at"] else "no data")


def metres(value: float) -> str:
    """Return "412 m"; with a decimal below 10 m."""
    return f"{value:.1f} m" if abs(value) < 10 else f"{value:.0f} m"


def speed(value_mps: float) -> str:
    """Return "2.8 m/s"; with a second decimal below 1 m/s."""
    return f"{value_mps:.2f} m/s" if abs(value_mps) < 1 else f"{value_mps:.1f} m/s"


def percent(share: float) -> str:
    """Return whole percent; 100 only at the end."""
    return f"{int(share * 100 + 1e-9)} %"


def waypoint_words(task: Json) -> str:
    """Return "waypoint 41 of 66", counted from 1."""
    count = task["waypoint_count"]
    return f"waypoint {min(task['target_index'] + 1, count)} of {count}"


def end_words(task: Json) -> str:
    """Return "task t1 aborted at 12:03:04: left the path (60 m of 799 m in 1 min 5 s)"."""
    ended_s = datetime.fromisoformat(task["ended_at"]).timestamp()
    took_s = ended_s - datetime.fromisoformat(task["created_at"]).timestamp()
    how = task["status"].lower()
    why = f": {task['reason']}" if task["reason"] and task["reason"] != how else ""
    way = f"{metres(task['distance_m'])} of {metres(task['length_m'])} in {duration(took_s)}"
    return f"task {task['id']} {how} at {time_of_day(ended_s)}{why} ({way})"


def drive_words(task: Json, vehicle: Json | None) -> str:
    """Return "2.8 of 2.8 m/s, 0.03 m left of the path": actual and cruise speed, deviation."""
    speed = None if vehicle is None else vehicle["speed_mps"]
    now = UNKNOWN if speed is None else f"{speed:.1f}"
    words = f"{now} of {task['speed_mps']:.1f} m/s"
    error = task["cross_track_error_m"]
    if error is None:
        return words
    if abs(error) < 0.005:
        return f"{words}, on the path"
    return f"{words}, {abs(error):.2f} m {'left' if error > 0 else 'right'} of the path"
