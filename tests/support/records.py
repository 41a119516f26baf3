"""Values of every class that records can hold, made from the type hints of the core."""

import struct
import sys
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from math import isnan
from typing import Any, get_args

import numpy as np
from hypothesis import strategies as st

from domain.actor import Actor
from domain.commands import Command
from domain.events.event import Event, RecordedEvent
from domain.inputs import Input
from domain.kept import Keeping, Kept
from domain.link.messages import Message
from domain.paths.path import Path
from service.codec.codec import (
    ACTORS,
    COMMANDS,
    EVENTS,
    INPUTS,
    KEEPINGS,
    KEPT,
    MESSAGES,
    STEPS,
    Codec,
)
from service.codec.recorded_step import RecordedStep


def _concrete(kind: type[Event]) -> Iterator[type[Event]]:
    for below in kind.__subclasses__():
        # Not those that other tests make. A class with slots is made twice; nobody uses the first.
        if not below.__module__.startswith("domain."):
            continue
        if getattr(sys.modules[below.__module__], below.__name__) is below:
            if "kind" in vars(below):
                yield below
            yield from _concrete(below)


CODECS: tuple[tuple[Codec[Any], tuple[type, ...]], ...] = (
    (INPUTS, get_args(Input)),
    (COMMANDS, get_args(Command)),
    (EVENTS, (RecordedEvent,)),
    (KEPT, get_args(Kept)),
    (KEEPINGS, (Keeping,)),
    (ACTORS, (Actor,)),
    (MESSAGES, get_args(Message)),
    (STEPS, (RecordedStep,)),
)
EVENT_CLASSES = tuple(_concrete(Event))
RECORDS: tuple[tuple[type, Codec[Any]], ...] = tuple(
    (kind, codec) for codec, kinds in CODECS for kind in kinds
)


def paths() -> st.SearchStrategy[Path]:
    """Return paths; yaw may be any finite number, and the first two waypoints differ."""
    place = st.floats(-1e6, 1e6)
    row = st.tuples(place, place, st.floats(allow_nan=False, allow_infinity=False))
    return st.lists(row, min_size=1, max_size=4).map(
        lambda rows: Path(np.array([*rows, (rows[0][0] + 1.0, rows[0][1], 0.0)]))
    )


st.register_type_strategy(Path, paths())
st.register_type_strategy(Event, st.one_of([st.from_type(kind) for kind in EVENT_CLASSES]))


@cache
def values_of(kind: type) -> st.SearchStrategy[Any]:
    """Return values of a class, from its type hints."""
    return st.from_type(kind)


def is_same(one: object, other: object) -> bool:
    """Tell whether two values are the same to the last bit, with the same types all the way down.

    Of mappings any will do; their order counts.
    """
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return is_same(tuple(one.items()), tuple(other.items()))
    if type(one) is not type(other):
        return False
    if isinstance(one, float) and isinstance(other, float):
        return struct.pack("d", one) == struct.pack("d", other) or (isnan(one) and isnan(other))
    if isinstance(one, Path) and isinstance(other, Path):
        return one.waypoints.tobytes() == other.waypoints.tobytes()
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(is_same, one, other))
    if is_dataclass(one):
        return all(is_same(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    return one == other
