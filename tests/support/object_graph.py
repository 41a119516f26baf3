"""Counts what an object holds, by structure, so that two moments can be compared."""

from collections import Counter, deque
from collections.abc import Iterator, Mapping, Set
from functools import partial
from types import FunctionType, MethodType
from typing import Any

import numpy as np

_PLAIN = (type(None), bool, int, float, complex, str, bytes, type, range)
_FEW = 20
"""So many objects more are no growth."""
_INSIDE = ("[]", "{}", "()")


def sizes_of(root: object) -> Mapping[str, int]:
    """Return how many objects are in each structure below an object, at any depth.

    A structure is named by the attributes that lead to it, up to the first container. Each object
    counts once, where it is found first; an array counts its elements.
    """
    sizes: Counter[str] = Counter()
    seen = {id(root)}
    alive = [root]
    waiting: deque[tuple[str, object]] = deque([("", root)])
    while waiting:
        place, value = waiting.popleft()
        for name, part in _parts(value):
            where = place if place.endswith(_INSIDE) else place + name
            sizes[where] += part.size if isinstance(part, np.ndarray) else 1
            if isinstance(part, (*_PLAIN, np.ndarray, np.generic)) or id(part) in seen:
                continue
            seen.add(id(part))
            alive.append(part)
            waiting.append((where, part))
    return sizes


def growth(before: Mapping[str, int], after: Mapping[str, int]) -> dict[str, float]:
    """Return by which share each structure grew, the worst first."""
    shares = {
        place: (size - before.get(place, 0)) / max(before.get(place, 0), 1)
        for place, size in after.items()
        if size - before.get(place, 0) > _FEW
    }
    return dict(sorted(shares.items(), key=lambda item: -item[1]))


def _parts(value: object) -> Iterator[tuple[str, Any]]:
    """Yield what an object refers to, each with the step of the path to it."""
    match value:
        case Mapping():
            for key, item in value.items():
                yield "{}", key
                yield "[]", item
        case list() | tuple() | Set() | deque():
            for item in value:
                yield "[]", item
        case MethodType():
            yield ".self", value.__self__
        case partial():
            yield from (("()", item) for item in (value.func, *value.args))
        case FunctionType():
            yield from (("()", cell.cell_contents) for cell in value.__closure__ or ())
    names = [name for kind in type(value).__mro__ for name in getattr(kind, "__slots__", ())]
    for name in (*names, *getattr(value, "__dict__", ())):
        if name not in ("__dict__", "__weakref__") and hasattr(value, name):
            yield f".{name}", getattr(value, name)
