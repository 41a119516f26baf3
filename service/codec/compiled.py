"""Functions that write the objects of one class, compiled from its fields.

Every input is written on the event loop. A loop over the fields at each call takes four times as
long as the function that a person would write down, which is the one that is compiled here.
"""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from service.codec.shape import Shape, Write


def compile_writer(kind: type, shapes: Mapping[str, Shape], head: Mapping[str, str]) -> Write:
    """Return the function that writes an object of a class.

    For a class with two fields and a head it is

        def write(value):
            plain = {'is': 'node_report', 'node': value.node}
            item = value.parameters
            if item is not None:
                plain['parameters'] = write_parameters(item)
            return plain

    A field that holds its default is left out, if that is None, a text or `()`; not if it is a
    number, since 0 equals 0.0, -0.0 and False.

    Args:
        kind: A dataclass.
        shapes: The shape of each field.
        head: What comes before the fields.
    """
    entries = [f"{key!r}: {text!r}" for key, text in head.items()]
    lines = []
    for item in fields(kind):
        writer = f"write_{item.name}(%s)" if shapes[item.name].write else "%s"
        if item.default is None or isinstance(item.default, str | tuple):
            differs = "is not" if item.default is None else "!="
            lines += [
                f"    item = value.{item.name}",
                f"    if item {differs} {item.default!r}:",
                f"        plain[{item.name!r}] = {writer % 'item'}",
            ]
        else:
            entries.append(f"{item.name!r}: {writer % f'value.{item.name}'}")
    head_line = f"    plain = {{{', '.join(entries)}}}"
    source = "\n".join(["def write(value):", head_line, *lines, "    return plain"])
    names: dict[str, Any] = {f"write_{name}": shape.write for name, shape in shapes.items()}
    exec(compile(source, f"<writer of {kind.__name__}>", "exec"), names)
    write: Write = names["write"]
    return write
