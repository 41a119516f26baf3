"""Circles in directed graphs: what leads back to itself."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import TypeVar

T = TypeVar("T", bound=Hashable)

_MAX_NAMES_TOLD = 12


def circles(successors: Mapping[T, Sequence[T]]) -> Iterator[tuple[T, ...]]:
    """Yield circles, each from a node back to itself; none: there is no circle.

    Not every circle is told, but one for each edge that closes one in a depth-first traversal, so
    that the effort is linear. The last but one node is where that edge begins.

    Args:
        successors: The nodes that each node leads to; those without an entry lead nowhere.
    """
    done: set[T] = set()
    for start in successors:
        if start in done:
            continue
        trail: dict[T, None] = {start: None}
        waiting = [iter(successors[start])]
        while waiting:
            node = next(waiting[-1], None)
            if node is None:
                waiting.pop()
                done.add(trail.popitem()[0])
            elif node in trail:
                names = tuple(trail)
                yield (*names[names.index(node) :], node)
            elif node not in done and node in successors:
                trail[node] = None
                waiting.append(iter(successors[node]))


def in_words(circle: Sequence[str], joint: str) -> str:
    """Return the names of a circle joined by a word; of a long one, the first and last names."""
    names = list(circle)
    if len(names) > _MAX_NAMES_TOLD:
        names[_MAX_NAMES_TOLD - 2 : -2] = ["..."]
    return joint.join(names)
