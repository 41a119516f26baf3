"""Plain values as JSON text and back; strict JSON, in which NaN and infinities are objects.

`{"float": "nan"}` cannot be taken for a text, and every program that reads JSON can read it.
"""

import math
from collections.abc import Mapping
from typing import Any, TypeAlias

from pydantic_core import from_json, to_json

from service.codec.errors import CodecError

Json: TypeAlias = Any
"""None, bool, int, float, str, or lists and dictionaries of them."""

SPECIAL_FLOATS: Mapping[str, float] = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}


def to_text(value: Json) -> bytes:
    """Return a value as JSON; tuples are lists.

    Raises:
        CodecError: It holds half a surrogate pair, or an object that JSON does not have.
    """
    try:
        text = to_json(value, inf_nan_mode="constants")
        # The letters may belong to a text; then the second pass changes nothing. One letter alone
        # is found much faster, and a path of many waypoints has none of them.
        if (b"N" in text and b"NaN" in text) or (b"I" in text and b"Infinity" in text):
            text = to_json(_with_objects(value))
    except ValueError as error:
        raise CodecError(f"cannot be written as JSON: {error}") from error
    return text


def from_text(text: bytes, most_bytes: int) -> Json:
    """Return the value that a JSON text holds.

    Args:
        text: UTF-8.
        most_bytes: Largest size of the text.

    Raises:
        CodecError: It is too long or too deep, or it is not JSON.
    """
    if len(text) > most_bytes:
        raise CodecError(f"a record has at most {most_bytes} bytes, not {len(text)}")
    try:
        return from_json(text, allow_inf_nan=False)
    except ValueError as error:
        raise CodecError(f"not JSON: {error}") from error


def _with_objects(value: Json) -> Json:
    """Return a copy in which floats that JSON does not have are objects."""
    if isinstance(value, float) and not math.isfinite(value):
        return {"float": str(value)}
    if isinstance(value, dict):
        return {key: _with_objects(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_with_objects(item) for item in value]
    return value
