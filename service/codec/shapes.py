"""Shapes of plain types, texts from a list, arrays, mappings and paths."""

import base64
import binascii
import sys
from collections.abc import Mapping
from enum import StrEnum
from functools import cache
from typing import Any

from domain.arrays import np
from domain.errors import InvalidValueError, shortened
from domain.paths.path import Path
from service.codec.errors import CodecError
from service.codec.json_text import SPECIAL_FLOATS, Json
from service.codec.shape import Shape, as_it_is

_ROW = 3
"""Numbers of a waypoint: x, y and yaw."""
_LARGEST = int(sys.float_info.max)


def _read_float(plain: Json) -> float:
    """Return a number. An integer remains one: where a float is expected, Python allows both."""
    if type(plain) is float:
        return plain
    if type(plain) is int:
        if abs(plain) > _LARGEST:
            raise CodecError("this integer is too large for a number")
        return plain
    name = plain.get("float")
    if len(plain) != 1 or type(name) is not str or name not in SPECIAL_FLOATS:
        raise CodecError(f'expected a number, or {{"float": {"|".join(SPECIAL_FLOATS)}}}')
    return SPECIAL_FLOATS[name]


PLAIN: Mapping[Any, Shape] = {
    type(None): Shape((type(None),), as_it_is),
    bool: Shape((bool,), as_it_is),
    int: Shape((int,), as_it_is),
    float: Shape((float, int, dict), _read_float, is_of=(float, int)),
    str: Shape((str,), as_it_is),
}


@cache
def of_enum(kind: type[StrEnum]) -> Shape:
    """Return the shape of an enumeration: the text of the member."""
    members = {member.value: member for member in kind}

    def read(plain: Json) -> StrEnum:
        try:
            return members[plain]
        except KeyError:
            known = ", ".join(members)
            raise CodecError(f"{shortened(plain)!r} is none of {known}") from None

    return Shape((str,), read, is_of=(kind,))


@cache
def of_tuple(item: Shape) -> Shape:
    """Return the shape of a tuple of any length: a list."""
    read_item, write_item = item.checked(), item.write

    def read(plain: Json) -> tuple[Any, ...]:
        values: list[Any] = []
        try:
            values.extend(map(read_item, plain))
        except CodecError as error:
            raise error.inside(len(values)) from None
        return tuple(values)

    def write(value: tuple[Any, ...]) -> Json:
        assert write_item is not None
        return [write_item(part) for part in value]

    return Shape((list,), read, None if write_item is None else write, is_of=(tuple,))


@cache
def of_mapping(value: Shape) -> Shape:
    """Return the shape of a mapping from texts: an object."""
    read_value, write_value = value.checked(), value.write

    def read(plain: Json) -> dict[str, Any]:
        values = {}
        for key, item in plain.items():
            try:
                values[key] = read_value(item)
            except CodecError as error:
                raise error.inside(key) from None
        return values

    def write(mapping: Mapping[str, Any]) -> Json:
        if write_value is None:
            return mapping if type(mapping) is dict else dict(mapping)
        return {key: write_value(item) for key, item in mapping.items()}

    return Shape((dict,), read, write, is_of=(dict, Mapping))


def _write_path(path: Path) -> str:
    return base64.b64encode(path.waypoints.astype("<f8", copy=False).tobytes()).decode("ascii")


def _read_path(plain: str) -> Path:
    try:
        numbers = np.frombuffer(base64.b64decode(plain, validate=True), "<f8")
        return Path(numbers.reshape(-1, _ROW))
    except (binascii.Error, ValueError) as error:
        raise CodecError(f"not waypoints in base64: {error}") from None
    except InvalidValueError as error:
        raise CodecError(error.message) from None


PATH = Shape((str,), _read_path, _write_path, is_of=(Path,))
"""Waypoints as base64 of little-endian float64, so that each bit is kept."""
