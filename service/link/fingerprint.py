"""Fingerprints of what two computers of a robot must have in common.

They are taken over what was read and not over the text of a file: comments, order of keys within a
parameter and line ends do not count. What has its default is left out, so that the next minor
release, which knows more settings, takes the same fingerprint of the same file.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from enum import Enum
from typing import Any

from domain.parts.system_model import SmhModel

_DIGITS = 32


def model_fingerprint(model: SmhModel) -> str:
    """Return the fingerprint of a model: of all that decides what its parts do."""
    return fingerprint_of(
        {
            "nodes": model.nodes,
            "systems": model.systems,
            "mode_settings": model.mode_settings,
            "errors": model.errors,
            "reactions": model.reactions,
        }
    )


def fingerprint_of(value: object) -> str:
    """Return the fingerprint of a value of the domain, or of a text: 32 hexadecimal digits.

    The order of mappings counts, as that of the modes of a part does.
    """
    text = json.dumps(_plain(value), ensure_ascii=True, separators=(",", ":"))
    return hashlib.sha256(text.encode("ascii")).hexdigest()[:_DIGITS]


def _plain(value: object) -> Any:  # noqa: ANN401  # as in JSON
    if isinstance(value, Enum):
        return value.value
    if is_dataclass(value) and not isinstance(value, type):
        own = {
            field.name: _plain(getattr(value, field.name))
            for field in fields(value)
            if field.init and field.compare and getattr(value, field.name) != _default(field)
        }
        return [type(value).__name__, own]
    if isinstance(value, Mapping):
        return [[_plain(key), _plain(item)] for key, item in value.items()]
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    if isinstance(value, frozenset | set):
        return sorted(map(_plain, value), key=repr)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError(f"{type(value).__name__} has no fingerprint")


def _default(field: Field[Any]) -> object:
    if field.default is not MISSING:
        return field.default
    return MISSING if field.default_factory is MISSING else field.default_factory()
