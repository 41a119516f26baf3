"""Texts of the monitor for single values: pure functions."""

from collections.abc import Mapping
from datetime import datetime
from typing import Any

Json = Mapping[str, Any]

UNKNOWN = "?"


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


def value_words(signal: Json) -> str:
    """Return the value of a signal with its unit."""
    value, unit = signal["value"], signal["unit"]
    if value is None:
        return UNKNOWN
    if isinstance(value, bool):
        if signal["signal"] == "estop":
            return "pressed" if value else "released"
        return "yes" if value else "no"
    if isinstance(value, str):
        return value.lower().replace("_", " ")
    if unit == "ratio":
        return f"{value * 100:.4g} %"
    return f"{value:.6g} {unit}".rstrip()


def verdict_words(signal: Json, pending_s: float | None) -> str:
    """Return the errors of a signal, or "ok".

    Args:
        signal: As in frames.
        pending_s: How long an error has been pending, s; None: none is.
    """
    error, pending = signal["error"], signal["pending"]
    said = [error] if error else []
    if signal["stale"] and error != "STALE_DATA":
        said.append("stale")
    if pending is not None and pending_s is not None:
        said.append(f"{pending['error']} in {duration(pending['needs_s'] - pending_s + 0.999)}")
    return ", ".join(said) or "ok"


def metres(value: float) -> str:
    """Return "412 m"; with a decimal below 10 m."""
    return f"{value:.1f} m" if abs(value) < 10 else f"{value:.0f} m"


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
