"""The other computers of the robot, in words.

`web/js/base/device_words.js` has the same rules; one test runs both over the same cases.
"""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

Json: TypeAlias = Mapping[str, Any]

_WORDS = {"lost": "lost", "conflict": "in conflict", "never_seen": "not seen yet", "late": "late"}
"""What each connection is called that is not as it should be, the worst first."""
_LEADS = {
    "nobody": "no supervisor yet",
    "supervisor": "the supervisor's word counts",
    "cut_off": "cut off",
    "device": "acts alone",
}
_NAMED = 3


def is_away(device: Json | None) -> bool:
    """Tell whether nothing is known of what a device does now; None: there is no such device."""
    return device is not None and device["state"] not in ("connected", "late")


def amiss(devices: Mapping[str, Json]) -> list[Json]:
    """Return the devices that are not as they should be, the worst first.

    Args:
        devices: By name, as in frames.
    """
    order = list(_WORDS)
    found = [device for device in devices.values() if device["state"] in _WORDS]
    return sorted(found, key=lambda device: order.index(device["state"]))


def state_words(device: Json) -> str:
    """Return how the connection to a device is, such as "not seen yet"."""
    return _WORDS.get(device["state"], str(device["state"]))


def device_problems(devices: Mapping[str, Json]) -> list[str]:
    """Return which devices are away, the first few; one that is only late is not worth a word."""
    away = [device for device in amiss(devices) if is_away(device)]
    told = [f"device {device['device']} is {state_words(device)}" for device in away[:_NAMED]]
    left = len(away) - _NAMED
    return told if left <= 0 else [*told, f"{left} more such devices"]


def not_stopped_words(devices: Mapping[str, Json]) -> str:
    """Return which devices may not be stopped under an emergency stop; empty: all are heard."""
    names = [device["device"] for device in amiss(devices) if is_away(device)]
    if not names:
        return ""
    verb = "is" if len(names) == 1 else "are"
    return f"{_named(names)} {verb} not known to be stopped"


def stop_places(stop: Json) -> str:
    """Return where the emergency stop is engaged; empty: only at the service that says so.

    Args:
        stop: The emergency stop; an older service does not say where it is.
    """
    places = list(dict.fromkeys(each["device"] for each in stop.get("stops", ())))
    if all(device is None for device in places):
        return ""
    silent = stop["not_heard"]
    return _named([_place(device) + " (not heard)" * (device in silent) for device in places])


def own_words(this: Json) -> str:
    """Return which device the service runs on, and whose word counts there."""
    return f"device {this['device']}: {_LEADS[this['lead']]}"


def heard_last(device: Json | None) -> str | None:
    """Return when a device that is away was heard last; None: it is heard, or never was."""
    if device is None or not is_away(device) or device["state"] == "never_seen":
        return None
    return str(device["heard_at"] or device["since_at"])


def _place(device: str | None) -> str:
    if device is None:
        return "here"
    return "at the supervisor" if device == "supervisor" else f"at device {device}"


def _named(names: Sequence[str]) -> str:
    left = len(names) - _NAMED
    first = list(names) if left <= 0 else [*names[:_NAMED], f"{left} more"]
    *others, last = first
    return f"{', '.join(others)} and {last}" if others else last
