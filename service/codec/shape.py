"""How values of one type are written as plain JSON and read back."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeAlias

from service.codec.errors import CodecError
from service.codec.json_text import Json

Write: TypeAlias = Callable[[Any], Json]
Read: TypeAlias = Callable[[Json], Any]

JSON_TYPES: Mapping[type, str] = {
    type(None): "null",
    bool: "true or false",
    int: "an integer",
    float: "a number",
    str: "a text",
    list: "a list",
    dict: "an object",
}


@dataclass(frozen=True, slots=True)
class Shape:
    """A type in records."""

    takes: tuple[type, ...]
    """What it is in JSON: keys of `JSON_TYPES`."""
    read: Read
    """Returns the value, of JSON of one of these types; raises CodecError."""
    write: Write | None = None
    """Returns the JSON of a value; None: it is written as it is."""
    is_of: tuple[type, ...] | None = None
    """Classes of its values, where a union has to tell; None: the same as `takes`."""

    def checked(self) -> Read:
        """Return `read` for JSON of any type."""
        if self.read is as_it_is:
            return _checked_as_it_is(self.takes)
        return _checked(self.takes, self.read)


# Thousands of fields are of few shapes: each needs one function only.
@cache
def _checked(takes: tuple[type, ...], read: Read) -> Read:
    def check(plain: Json) -> Any:  # noqa: ANN401  # whatever the type is
        if type(plain) not in takes:
            raise unexpected(takes, plain)
        return read(plain)

    return check


@cache
def _checked_as_it_is(takes: tuple[type, ...]) -> Read:
    def check(plain: Json) -> Json:
        if type(plain) not in takes:
            raise unexpected(takes, plain)
        return plain

    return check


def as_it_is(plain: Json) -> Json:
    """Return the value itself."""
    return plain


def unexpected(takes: Iterable[type], plain: Json) -> CodecError:
    """Return the error for JSON of another type than expected."""
    expected = " or ".join(dict.fromkeys(JSON_TYPES[kind] for kind in takes))
    return CodecError(f"expected {expected}, not {JSON_TYPES[type(plain)]}")
