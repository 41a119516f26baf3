"""Converts between ROS messages and plain values as in JSON.

Imports no ROS: a message class itself lists its fields and their types. Values are checked in full,
since ROS does not do so: a wrong type in a field aborts the process.
"""

import importlib
import math
import re
from array import array
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from typing import Any, TypeAlias

from domain.arrays import np
from domain.errors import InvalidValueError
from service.ros.graph.graph import Fields, Message, UnknownFieldError, UnknownTypeError

_TYPE_NAME = re.compile(r"(?P<folder>[a-z]\w*/(?:msg|srv))/(?P<name>[A-Za-z]\w*)", re.ASCII)
_ACTION_TYPE_NAME = re.compile(
    r"(?P<folder>[a-z]\w*/action)/(?P<name>[A-Za-z][A-Za-z0-9]*)(?:_(?P<piece>[A-Za-z]+))?",
    re.ASCII,
)
_ACTION_PIECE = re.compile(r"[a-z]\w*/[A-Za-z]\w*_(?:Goal|Result|Feedback)", re.ASCII)
_SEQUENCE = re.compile(r"sequence<(?P<element>.+?)(?:, (?P<most>\d+))?>")
_ARRAY = re.compile(r"(?P<element>.+)\[(?P<length>\d+)\]")
_STRING = re.compile(r"w?string(?:<(?P<most>\d+)>)?")
_INTEGER = re.compile(r"(?P<unsigned>u?)int(?P<bits>8|16|32|64)")
Check: TypeAlias = Callable[[object, str], Any]
"""Takes a value and the path to it, and returns the value for the field."""
_LARGEST = {"float": (2 - 2**-23) * 2.0**127, "double": math.inf}


def find_type(type_name: str) -> Any:  # noqa: ANN401  # a class of ROS, which has no types of ours
    """Return the class of a type.

    Args:
        type_name: As `std_msgs/msg/Bool`, `lifecycle_msgs/srv/GetState`,
            `nav2_msgs/action/FollowPath`, or for what an action consists of
            `nav2_msgs/action/FollowPath_SendGoal`, `_GetResult`, `_FeedbackMessage`, `_Goal`.

    Raises:
        UnknownTypeError: The type is not installed on this machine.
    """
    match = _TYPE_NAME.fullmatch(type_name) or _ACTION_TYPE_NAME.fullmatch(type_name)
    if match is None:
        raise UnknownTypeError(type_name)
    try:
        module = importlib.import_module(match["folder"].replace("/", "."))
        kind = getattr(module, match["name"])
        piece = match.groupdict().get("piece")
        return kind if piece is None else _piece_of(kind, piece)
    except (ImportError, AttributeError) as error:
        raise UnknownTypeError(type_name) from error


def _piece_of(action: Any, name: str) -> Any:  # noqa: ANN401  # classes of ROS
    """Return one of the types that an action consists of.

    Raises:
        AttributeError: There is no such piece.
    """
    if name in ("SendGoal", "GetResult"):
        return getattr(action.Impl, f"{name}Service")
    return getattr(action.Impl if name == "FeedbackMessage" else action, name)


def require_field(type_name: str, path: Sequence[str | int]) -> None:
    """Check that messages of a type have a field; the length of a list is not checked.

    Args:
        type_name: As `sensor_msgs/msg/BatteryState`.
        path: Names of fields, and indices of lists.

    Raises:
        UnknownTypeError: There is no such type.
        UnknownFieldError: It has no such field.
    """
    kind = type_name.replace("/msg/", "/")
    for step in path:
        items = _SEQUENCE.fullmatch(kind) or _ARRAY.fullmatch(kind)
        if items is not None and isinstance(step, int):
            kind = items["element"]
            continue
        fields: Mapping[str, str] = {}
        if items is None and "/" in kind:
            fields = find_type(kind.replace("/", "/msg/")).get_fields_and_field_types()
        if step not in fields:
            raise UnknownFieldError(type_name, ".".join(map(str, path)), tuple(fields))
        kind = fields[str(step)]


def fill(message: Message, fields: Fields) -> None:
    """Set the fields of a message; fields that are left out keep their values.

    A nested message is replaced as a whole: fields that are left out of it get their ROS default.

    Args:
        message: Of any type.
        fields: By name; a `byte` is a number, and an integer is accepted for a float.

    Raises:
        InvalidValueError: A field is unknown, or its value has a wrong type; the message is
            unchanged. The error's pointer leads to the value, as `/status/0/level`.
    """
    for name, value in _values(message, fields, "").items():
        setattr(message, name, value)


def fields_of(message: Message) -> dict[str, Any]:
    """Return all fields of a message by name, as `fill` takes them."""
    return {name: _plain(getattr(message, name)) for name in message.get_fields_and_field_types()}


def _plain(value: Any) -> Any:  # noqa: ANN401  # whatever a field holds
    match value:
        case bytes():
            return value[0]
        case array() | np.ndarray():
            return value.tolist()
        case list() | tuple():
            return [_plain(item) for item in value]
        case _ if hasattr(value, "get_fields_and_field_types"):
            return fields_of(value)
    return value


def _values(message: Message, fields: object, path: str) -> dict[str, Any]:
    if not isinstance(fields, Mapping):
        raise _wrong(path, "a mapping of fields", fields)
    types = message.get_fields_and_field_types()
    values = {}
    for name, value in fields.items():
        where = f"{path}/{name}"
        if name not in types:
            known = ", ".join(types) or "none"
            raise InvalidValueError(f"{where}: no such field; known: {known}", where)
        values[name] = _checked(types[name])(value, where)
    return values


@cache
def _checked(kind: str) -> Check:
    """Return the check for values of a type; cached, since messages come often."""
    if match := _SEQUENCE.fullmatch(kind):
        most = None if match["most"] is None else int(match["most"])
        return partial(_sequence, _checked(match["element"]), most)
    if match := _ARRAY.fullmatch(kind):
        return partial(_array, _checked(match["element"]), int(match["length"]))
    if "/" in kind:
        folder = "/action/" if _ACTION_PIECE.fullmatch(kind) else "/msg/"
        return partial(_nested, find_type(kind.replace("/", folder)))
    if match := _STRING.fullmatch(kind):
        return partial(_text, None if match["most"] is None else int(match["most"]))
    if match := _INTEGER.fullmatch(kind):
        bits = int(match["bits"])
        least, beyond = (0, 2**bits) if match["unsigned"] else (-(2 ** (bits - 1)), 2 ** (bits - 1))
        return partial(_integer, least, beyond)
    if kind in _LARGEST:
        return partial(_float, kind)
    return {"octet": _octet, "boolean": _boolean}.get(kind, partial(_unknown, kind))


def _sequence(check: Check, most: int | None, value: object, path: str) -> list[Any]:
    items = _items(check, value, path)
    if most is not None and len(items) > most:
        raise _wrong(path, f"a list of at most {most}", value)
    return items


def _array(check: Check, length: int, value: object, path: str) -> list[Any]:
    items = _items(check, value, path)
    if len(items) != length:
        raise _wrong(path, f"a list of {length}", value)
    return items


def _items(check: Check, value: object, path: str) -> list[Any]:
    if not isinstance(value, list | tuple):
        raise _wrong(path, "a list", value)
    return [check(item, f"{path}/{index}") for index, item in enumerate(value)]


def _nested(kind: Callable[[], Message], value: object, path: str) -> Message:
    nested = kind()
    for name, inner in _values(nested, value, path).items():
        setattr(nested, name, inner)
    return nested


def _unknown(kind: str, _value: object, path: str) -> Any:  # noqa: ANN401  # it never returns
    raise InvalidValueError(f"{path} has the type {kind}, which JSON cannot hold", path)


def _octet(value: object, path: str) -> bytes:
    return bytes([_integer(0, 256, value, path)])


def _boolean(value: object, path: str) -> bool:
    if not isinstance(value, bool):
        raise _wrong(path, "true or false", value)
    return value


def _text(most: int | None, value: object, path: str) -> str:
    if not isinstance(value, str) or not _can_be_sent(value):
        raise _wrong(path, "a text", value)
    if most is not None and len(value) > most:
        raise _wrong(path, f"a text of at most {most} characters", value)
    return value


def _can_be_sent(text: str) -> bool:
    # A null character would end the string in ROS; a lone surrogate cannot be encoded.
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return "\0" not in text


def _integer(least: int, beyond: int, value: object, path: str) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not least <= value < beyond:
        raise _wrong(path, f"a whole number from {least} to {beyond - 1}", value)
    return value


def _float(kind: str, value: object, path: str) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise _wrong(path, "a number", value)
    try:
        number = float(value)
    except OverflowError as error:
        raise _wrong(path, f"a number that a {kind} can hold", value) from error
    if _LARGEST[kind] < abs(number) < math.inf:
        raise _wrong(path, f"a number that a {kind} can hold", value)
    return number


def _wrong(path: str, wanted: str, value: object) -> InvalidValueError:
    return InvalidValueError(f"{path or 'a message'} must be {wanted}, not {value!r:.40}", path)
