"""Checks the fields of incoming messages."""

from collections.abc import Mapping
from enum import Enum
from typing import Any, TypeAlias

from domain.errors import InvalidValueError


class Kind(Enum):
    """The type of a field; the value describes it in error messages."""

    BOOLEAN = "true or false"
    UINT8 = "a whole number from 0 to 255"
    INT32 = "a whole number of 32 bits"
    UINT32 = "a whole number of 32 bits, at least 0"
    UINT64 = "a whole number of 64 bits, at least 0"
    NUMBER = "a number"
    TEXT = "a text"
    LIST = "a list"


Shape: TypeAlias = "Mapping[str, Kind | Shape]"
"""Fields of a message, in the order of its definition."""

EMPTY: Shape = {}
HEADER: Shape = {
    "stamp": {
        "sec": Kind.INT32,
        "nanosec": Kind.UINT32,
        "secs": Kind.UINT32,
        "nsecs": Kind.UINT32,
    },
    "frame_id": Kind.TEXT,
    "seq": Kind.UINT32,
}
"""The headers of ROS 2 and of ROS 1, whose clients are in use with rosbridge."""
CHANGE_STATE: Shape = {"transition": {"id": Kind.UINT8, "label": Kind.TEXT}}
CHANGE_MODE: Shape = {"mode_name": Kind.TEXT}
START_TASK: Shape = {
    "file": Kind.TEXT,
    "start_index": Kind.UINT64,
    "controller": Kind.TEXT,
    "speed_mps": Kind.NUMBER,
}
DRIVE_WAYPOINTS: Shape = {
    "waypoints": Kind.LIST,
    "start_index": Kind.UINT64,
    "controller": Kind.TEXT,
    "speed_mps": Kind.NUMBER,
}
"""Of its waypoints each is to be checked as `WAYPOINT`, which takes long if there are many."""
WAYPOINT: Shape = {"x_m": Kind.NUMBER, "y_m": Kind.NUMBER, "yaw_rad": Kind.NUMBER}

_DEFAULTS: Mapping[Kind, bool | int | float | str | tuple[()]] = {
    Kind.BOOLEAN: False,
    Kind.UINT8: 0,
    Kind.INT32: 0,
    Kind.UINT32: 0,
    Kind.UINT64: 0,
    Kind.NUMBER: 0.0,
    Kind.TEXT: "",
    Kind.LIST: (),
}
_MAX_NUMBER = 2**1023
"""A larger integer is beyond a float of 64 bits, and would fail wherever it becomes one."""
_RANGES: Mapping[Kind, range] = {
    Kind.UINT8: range(2**8),
    Kind.INT32: range(-(2**31), 2**31),
    Kind.UINT32: range(2**32),
    Kind.UINT64: range(2**64),
}


def checked(shape: Shape, fields: object, pointer: str = "") -> dict[str, Any]:
    """Return a message with all its fields; those left out get the ROS default.

    Args:
        shape: The fields of the type.
        fields: The message as received.
        pointer: Its place in a larger message.

    Raises:
        InvalidValueError: A field is unknown or has a wrong type; `pointer` names it, as in
            `transition/id`.
    """
    if not isinstance(fields, Mapping):
        raise InvalidValueError(f"{pointer or 'a message'} must have fields by name", pointer)
    for name in fields:
        if name not in shape:
            known = f"known: {', '.join(shape)}" if shape else "no fields are expected"
            message = f"there is no field {name!r:.100}; {known}"
            raise InvalidValueError(message, _below(pointer, f"{name:.100}"))
    return {
        name: _checked_field(kind, fields.get(name), name in fields, _below(pointer, name))
        for name, kind in shape.items()
    }


def _checked_field(kind: "Kind | Shape", value: object, is_given: bool, pointer: str) -> object:
    if not isinstance(kind, Kind):
        return checked(kind, value if is_given else {}, pointer)
    if not is_given:
        return _DEFAULTS[kind]
    if not _fits(kind, value):
        raise InvalidValueError(f"{pointer} must be {kind.value}, not {_shown(value)}", pointer)
    return value


def _shown(value: object) -> str:
    """Return a wrong value for an error message.

    Nested values are only named by their type: writing them out may take as long as several ticks,
    and may exceed the recursion limit.
    """
    if isinstance(value, Mapping):
        return "fields"
    return "a list" if isinstance(value, list) else f"{value!r:.40}"


def _fits(kind: Kind, value: object) -> bool:
    """Tell whether a value is of a kind; booleans and numbers are different kinds."""
    if kind is Kind.TEXT:
        return isinstance(value, str)
    if kind is Kind.LIST:
        return isinstance(value, list)
    if kind is Kind.BOOLEAN or isinstance(value, bool):
        return kind is Kind.BOOLEAN and isinstance(value, bool)
    if kind is Kind.NUMBER:
        return isinstance(value, float) or (isinstance(value, int) and abs(value) <= _MAX_NUMBER)
    return isinstance(value, int) and value in _RANGES[kind]


def _below(pointer: str, name: str) -> str:
    return f"{pointer}/{name}" if pointer else name
