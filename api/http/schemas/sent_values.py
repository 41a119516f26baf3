"""Values that clients can send as more than one type, with one clear message per error."""

import math
import re
from typing import Annotated, Any

from pydantic import AfterValidator, AwareDatetime, BeforeValidator, PlainValidator, WithJsonSchema
from pydantic_core import PydanticCustomError

from domain.health.signals import signal_name
from domain.inputs import SignalValue
from domain.parameters import ParameterValue

MAX_TEXT = 4_096
"""Largest length of a string value, in characters."""

MAX_ITEMS = 1_024
"""Largest number of items of a list value."""

_SCALARS = (bool, int, float, str)
_INT64 = range(-(2**63), 2**63)


def read_signal_value(value: object) -> SignalValue:
    """Return a boolean, a finite number as a float, or a string.

    Raises:
        PydanticCustomError: It is none of these; 1 is not a boolean, and "1" is not a number.
    """
    if isinstance(value, bool):
        return value
    if isinstance(value, str) and len(value) <= MAX_TEXT:
        return value
    if isinstance(value, int | float):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if math.isfinite(number):
            return number
    raise PydanticCustomError(
        "invalid_value", "a signal value must be a boolean, a finite number or a short string"
    )


def read_parameter_value(value: object) -> ParameterValue:
    """Return a value of a ROS 2 parameter; a list becomes a tuple.

    A list of integers and doubles becomes a list of doubles, as `[0.5, 1]` is meant.

    Raises:
        PydanticCustomError: It is not a parameter value, or is too long.
    """
    if isinstance(value, list) and len(value) > MAX_ITEMS:
        message = "a parameter list must have at most {limit} items"
        raise PydanticCustomError("invalid_parameter", message, {"limit": MAX_ITEMS})
    items: list[Any] = value if isinstance(value, list) else [value]
    kinds = {type(item) for item in items}
    if kinds == {int, float}:
        items, kinds = [float(item) for item in items], {float}
    if kinds == {str} and max(map(len, items)) > MAX_TEXT:
        message = "a parameter string must have at most {limit} characters"
        raise PydanticCustomError("invalid_parameter", message, {"limit": MAX_TEXT})
    if len(kinds) > 1 or not all(_is_scalar(item) for item in items):
        raise PydanticCustomError(
            "invalid_parameter",
            "a parameter must be a boolean, a 64-bit integer, a finite number, a string,"
            " or a list of one of these",
        )
    found: ParameterValue = tuple(items) if isinstance(value, list) else items[0]
    return found


def _is_scalar(value: object) -> bool:
    if type(value) is int:
        return value in _INT64
    if type(value) is float:
        return math.isfinite(value)
    return type(value) in _SCALARS


def read_date(value: object) -> object:
    """Return a moment as it was sent, if it begins with a date.

    Raises:
        PydanticCustomError: It does not. Seconds since 1970 are not taken: 17 or 1.7e12 are one
            misplaced factor away from another year.
    """
    if isinstance(value, str) and _DATE.match(value):
        return value
    raise PydanticCustomError(
        "invalid_moment", "a moment must be RFC 3339 with an offset, as in 2026-05-04T12:00:00Z"
    )


def split_label(value: object) -> object:
    """Return `active.FAST` as an object with state and mode; other values unchanged."""
    if not isinstance(value, str):
        return value
    state, _, mode = value.partition(".")
    return {"state": state, "mode": mode or None}


_SCALAR_SCHEMAS: list[dict[str, Any]] = [
    {"type": "boolean"},
    {"type": "number"},
    {"type": "string", "maxLength": MAX_TEXT},
]
_PARAMETER_SCALARS: list[dict[str, Any]] = [
    {"type": "boolean"},
    {"type": "integer", "minimum": _INT64[0], "maximum": _INT64[-1]},
    {"type": "number"},
    {"type": "string", "maxLength": MAX_TEXT},
]

_DATE = re.compile(r"\d{4}-\d\d-\d\d[Tt ]")

SentMoment = Annotated[AwareDatetime, BeforeValidator(read_date)]
"""A moment, as in RFC 3339."""

SentSignalName = Annotated[str, AfterValidator(signal_name)]
"""The name of a signal, also with the leading slash of its topic."""

SentSignalValue = Annotated[
    bool | float | str,
    PlainValidator(read_signal_value),
    WithJsonSchema({"anyOf": _SCALAR_SCHEMAS}),
]
SentParameter = Annotated[
    Any,
    PlainValidator(read_parameter_value),
    WithJsonSchema(
        {
            "anyOf": [
                *_PARAMETER_SCALARS,
                *(
                    {"type": "array", "items": scalar, "maxItems": MAX_ITEMS}
                    for scalar in _PARAMETER_SCALARS
                ),
            ]
        }
    ),
]
"""Validates to a `ParameterValue`; as in ROS 2, 1 is an integer and 1.0 a double."""
