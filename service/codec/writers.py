"""Functions that write the objects of one class.

Every input is written on the event loop, so what depends on the class alone is settled once.
"""

from collections.abc import Callable, Mapping
from dataclasses import Field, fields
from operator import attrgetter
from typing import Any

from service.codec.shape import Shape, Write


def writer_of(kind: type, shapes: Mapping[str, Shape], head: Mapping[str, str]) -> Write:
    """Return the function that writes an object of a class.

    A field that holds its default is left out, if that is None, a text or `()`; not if it is a
    number, since 0 equals 0.0, -0.0 and False.

    Args:
        kind: A dataclass.
        shapes: The shape of each field.
        head: What comes before the fields.
    """
    always = [item.name for item in fields(kind) if not _may_be_left_out(item)]
    keys, values_of = (*head, *always), _values_of(always)
    texts = tuple(head.values())
    written = [(name, own) for name in always if (own := shapes[name].write) is not None]
    others = [
        (item.name, item.default, shapes[item.name].write)
        for item in fields(kind)
        if _may_be_left_out(item)
    ]

    def write(value: Any) -> dict[str, Any]:  # noqa: ANN401  # of the class
        plain = dict(zip(keys, texts + values_of(value)))  # noqa: B905  # as many, called often
        for name, write_field in written:
            plain[name] = write_field(plain[name])
        for name, default, write_other in others:
            item = getattr(value, name)
            if item is not default and item != default:
                plain[name] = write_other(item) if write_other else item
        return plain

    return write


def _may_be_left_out(item: "Field[Any]") -> bool:
    return item.default is None or isinstance(item.default, str | tuple)


def _values_of(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    """Return the function that returns these fields of a value."""
    if len(names) > 1:
        return attrgetter(*names)
    # attrgetter of one name returns no tuple, and of none there is none.
    return lambda value: tuple([getattr(value, name) for name in names])
