"""Shapes of classes and of unions, derived from the type hints of the core.

Nothing is guessed from a record: what may be built is settled by the hints, before one is read.
"""

import types
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from enum import StrEnum
from typing import Any, Union, get_args, get_origin, get_type_hints

from domain.errors import PilothouseError, near_match, shortened
from domain.events.event import Event
from domain.events.kinds import EVENTS
from domain.paths.path import Path
from service.codec.errors import CodecError
from service.codec.json_text import Json
from service.codec.names import NAMES
from service.codec.shape import JSON_TYPES, Read, Shape, Write
from service.codec.shapes import PATH, PLAIN, of_enum, of_mapping, of_tuple
from service.codec.writers import writer_of

TAG = "is"
"""Key of the name of a class; as a keyword of Python, it is never the name of a field."""


class Shapes:
    """Derives shapes; each class and each union has one.

    Most classes are in several unions. Each is derived once, which takes less than half the memory.
    """

    def __init__(self) -> None:
        self._classes: dict[type, Shape] = {}
        self._named: dict[type, Write] = {}
        """Writers that put the name of the class first."""
        self._fields: dict[type, Mapping[str, Shape]] = {}
        self._unions: dict[tuple[Any, ...], Shape] = {}

    def of(self, hint: Any) -> Shape:  # noqa: ANN401  # a type hint of any form
        """Return the shape of a type hint.

        Raises:
            TypeError: Records cannot hold such values, or a class has no name in `NAMES`.
        """
        hint = getattr(hint, "__supertype__", hint)
        if hint in PLAIN:
            return PLAIN[hint]
        if hint is Path:
            return PATH
        origin, arguments = get_origin(hint), get_args(hint)
        if origin in (Union, types.UnionType):
            members = tuple(_members(hint))
            if members not in self._unions:
                self._unions[members] = self._of_union(members)
            return self._unions[members]
        if origin is tuple and arguments[1:] == (...,):
            return of_tuple(self.of(arguments[0]))
        if origin is Mapping and self.of(arguments[0]) is PLAIN[str]:
            return of_mapping(self.of(arguments[1]))
        if origin is type:
            return _of_names(tuple(_members(arguments[0])))
        if hint is Event:
            return self.of_named(tuple(EVENTS.values()))
        if isinstance(hint, type) and issubclass(hint, StrEnum):
            return of_enum(hint)
        if isinstance(hint, type) and is_dataclass(hint):
            return self._of_class(hint)
        raise TypeError(f"no record can hold {hint!r}")

    def of_named(self, kinds: tuple[type, ...]) -> Shape:
        """Return the shape of a union of classes: an object that names its class."""
        writers: dict[type, Write] = {}
        readers: dict[str, Read] = {}
        for kind in kinds:
            name = _name_of(kind)
            writers[kind], readers[name] = self._named_writer(kind, name), self._of_class(kind).read

        def write(value: Any) -> Json:  # noqa: ANN401  # one of `kinds`
            try:
                writer = writers[type(value)]
            except KeyError:
                raise CodecError(f"{type(value).__name__} is no such record") from None
            return writer(value)

        def read(plain: Json) -> Any:  # noqa: ANN401  # one of `kinds`
            name = plain.get(TAG)
            if type(name) is not str:
                raise CodecError(f"{TAG!r} must name the kind of the record")
            if name not in readers:
                near = near_match(name, tuple(readers))
                hint = "" if near is None else f"; did you mean {near}?"
                raise CodecError(f"unknown kind of record {shortened(name)!r}{hint}")
            return readers[name](plain)

        return Shape((dict,), read, write, is_of=kinds)

    def _of_class(self, kind: type) -> Shape:
        if kind not in self._classes:
            # A class that holds others of its kind, as a tree does, meets this shape of itself.
            self._classes[kind] = Shape(
                (dict,),
                lambda plain: self._classes[kind].read(plain),
                lambda value: _written(self._classes[kind], value),
                is_of=(kind,),
            )
            shapes = self._of_fields(kind)
            read, write = _reader(kind, shapes), writer_of(kind, shapes, {})
            self._classes[kind] = Shape((dict,), read, write, is_of=(kind,))
        return self._classes[kind]

    def _named_writer(self, kind: type, name: str) -> Write:
        if kind not in self._named:
            self._named[kind] = writer_of(kind, self._of_fields(kind), {TAG: name})
        return self._named[kind]

    def _of_fields(self, kind: type) -> Mapping[str, Shape]:
        if kind not in self._fields:
            hints = get_type_hints(kind)
            self._fields[kind] = {item.name: self.of(hints[item.name]) for item in fields(kind)}
        return self._fields[kind]

    def _of_union(self, members: tuple[Any, ...]) -> Shape:
        classes = tuple(m for m in members if isinstance(m, type) and m in NAMES)
        shapes = [self.of(member) for member in members if member not in classes]
        if classes:
            shapes.append(self.of_named(classes) if classes[1:] else self.of(classes[0]))
        readers: dict[type, list[Read]] = {}
        for shape in shapes:
            for taken in shape.takes:
                readers.setdefault(taken, []).append(shape.read)
        for taken, candidates in readers.items():
            if len(candidates) > 1 and taken not in (int, list):
                raise TypeError(f"{JSON_TYPES[taken]} does not tell which of {members} it is")
        return Shape(tuple(readers), _read_one_of(readers), _write_one_of(shapes))


def _written(shape: Shape, value: Any) -> Json:  # noqa: ANN401  # of the shape
    assert shape.write is not None
    return shape.write(value)


def _members(hint: Any) -> Iterator[Any]:  # noqa: ANN401  # a type hint
    """Yield the members of a union, and what is no union itself."""
    if get_origin(hint) in (Union, types.UnionType):
        yield from get_args(hint)
    else:
        yield hint


def _name_of(kind: type) -> str:
    try:
        return NAMES[kind]
    except KeyError:
        raise TypeError(f"{kind.__name__} has no name for records") from None


def _of_names(kinds: tuple[type, ...]) -> Shape:
    """Return the shape of a class itself, as of `type[Kept]`: its name."""
    names = {kind: _name_of(kind) for kind in kinds}
    by_name = {name: kind for kind, name in names.items()}

    def read(plain: Json) -> type:
        try:
            return by_name[plain]
        except KeyError:
            raise CodecError(f"unknown kind of record {shortened(plain)!r}") from None

    return Shape((str,), read, names.__getitem__)


def _reader(kind: type, shapes: Mapping[str, Shape]) -> Read:
    """Return the function that reads an object of a class."""
    rows = tuple(
        (item.name, shapes[item.name].checked(), not _has_default(item)) for item in fields(kind)
    )

    def read(plain: Json) -> Any:  # noqa: ANN401  # of the class
        values = {}
        for name, read_field, is_required in rows:
            if name in plain:
                try:
                    values[name] = read_field(plain[name])
                except CodecError as error:
                    raise error.inside(name) from None
            elif is_required:
                raise CodecError(f"{kind.__name__} needs the field {name!r}")
        try:
            return kind(**values)
        except PilothouseError as error:
            raise CodecError(error.message) from None

    return read


def _has_default(item: "Field[Any]") -> bool:
    return item.default is not MISSING or item.default_factory is not MISSING


def _read_one_of(readers: Mapping[type, list[Read]]) -> Read:
    """Return the function that reads JSON by its type; of several arrays, the first that fits."""

    def read(plain: Json) -> Any:  # noqa: ANN401  # of a member of the union
        *others, last = readers[type(plain)]
        for candidate in others:
            try:
                return candidate(plain)
            except CodecError:
                continue
        return last(plain)

    return read


def _write_one_of(shapes: list[Shape]) -> Write | None:
    writers = [(shape.is_of or shape.takes, shape.write) for shape in shapes if shape.write]
    if not writers:
        return None
    if len(writers) > 1:
        raise TypeError("a union has one member at most that is not written as it is")
    ((is_of, write),) = writers

    def write_one(value: Any) -> Json:  # noqa: ANN401  # of a member of the union
        return write(value) if isinstance(value, is_of) else value

    return write_one
