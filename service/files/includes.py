"""What a robot file includes: templates, merged with its own keys."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from domain.errors import InvalidValueError
from service.files.monitor_templates import Parameter, read_template

INCLUDE = "include"
MAX_INCLUDED = 100
"""Templates in a robot file."""
Keys: TypeAlias = tuple[int | str, ...]
"""Keys and places in lists that lead to a value."""

_NAMED_BLOCKS: tuple[tuple[str, ...], ...] = (
    ("signals",),
    ("ros2", "signals"),
    ("ros2", "statistics"),
)
"""Blocks of a robot file, by name of a signal, to which templates add."""


class InvalidIncludeError(ValueError):
    """What cannot be included; `keys` lead to it. Whoever reads robot files says where that is."""

    def __init__(self, message: str, *keys: int | str) -> None:
        super().__init__(message)
        self.message = message
        self.keys: Keys = (INCLUDE, *keys)


@dataclass(frozen=True, slots=True)
class Merged:
    """A robot file with what it includes."""

    data: Any
    """As plain values; `include` is still there."""
    _own: Mapping[str, Any]
    _origins: Mapping[Keys, int]
    """Which item of `include` brought a signal."""

    def place_of(self, keys: Keys) -> Keys:
        """Return the keys with which the robot file itself says what other keys lead to."""
        origins = (self._origins.get(keys[:depth]) for depth in (2, 3))
        origin = next((place for place in origins if place is not None), None)
        return keys if origin is None or _has(self._own, keys) else (INCLUDE, origin)


def with_includes(own: object) -> Merged:
    """Return the plain values of a robot file with those of the templates that it includes.

    What the file itself says about a signal goes before what a template says.

    Raises:
        InvalidIncludeError: A template or parameter is unknown, one is missing, or two templates
            bring the same signal.
    """
    if not isinstance(own, Mapping):
        # What is no mapping is told by the validation that follows.
        return Merged(own, {}, {})
    merged = dict(own)
    origins: dict[Keys, int] = {}
    for place, name, parameters in _items(own.get(INCLUDE, [])):
        try:
            brought = read_template(name).filled(parameters)
        except InvalidValueError as error:
            below = (name, error.pointer) if error.pointer in parameters else ()
            raise InvalidIncludeError(error.message, place, *below) from error
        for block in _NAMED_BLOCKS:
            for signal, settings in _at(brought, block).items():
                first = origins.setdefault((*block, signal), place)
                if first != place:
                    words = f"an earlier template has {signal} already; give one another name"
                    raise InvalidIncludeError(words, place)
                _put_below(merged, (*block, signal), settings)
    return Merged(merged, own, origins)


def _items(include: object) -> Iterator[tuple[int, str, Mapping[str, Parameter]]]:
    """Yield place, name and parameters of each template."""
    if not isinstance(include, list):
        raise InvalidIncludeError("expected a list of templates, such as [cpu, memory]")
    if len(include) > MAX_INCLUDED:
        raise InvalidIncludeError(f"at most {MAX_INCLUDED} templates", MAX_INCLUDED)
    for place, item in enumerate(include):
        match item:
            case str():
                yield place, item, {}
            case dict() if len(item) == 1:
                ((name, parameters),) = item.items()
                yield place, name, _checked(parameters, place, name)
            case _:
                words = "expected the name of a template, or a name with its parameters below it"
                raise InvalidIncludeError(words, place)


def _checked(parameters: object, place: int, name: str) -> Mapping[str, Parameter]:
    if not isinstance(parameters, dict):
        raise InvalidIncludeError(f"expected the parameters of {name} below it", place, name)
    for parameter, value in parameters.items():
        if not isinstance(value, bool | int | float | str):
            words = f"{parameter} must be a number, a word or true or false"
            raise InvalidIncludeError(words, place, name, parameter)
    return parameters


def _at(data: Mapping[str, Any], keys: tuple[str, ...]) -> Mapping[str, Any]:
    for key in keys:
        data = data.get(key, {})
    return data


def _put_below(data: dict[str, Any], keys: tuple[str, ...], settings: Mapping[str, Any]) -> None:
    """Add settings below those that are there; maps on the way are copied, not changed."""
    for key in keys[:-1]:
        below = data.get(key)
        if below is not None and not isinstance(below, Mapping):
            return
        data[key] = dict(below or {})
        data = data[key]
    own = data.get(keys[-1], {})
    if isinstance(own, Mapping):
        data[keys[-1]] = {**settings, **own}


def _has(data: object, keys: Keys) -> bool:
    """Tell whether keys lead to something."""
    for key in keys:
        if not isinstance(data, Mapping) or key not in data:
            return False
        data = data[key]
    return True
