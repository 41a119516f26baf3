"""In which order the nodes of a change begin.

The settings of a mode say which parts of a system wait for which others. A part is done once all
nodes of the change below it are; a system inside another one orders its own parts. Both together
say which node waits for which parts.

A part is looked at when its turn comes: a request of a large robot must not look at all of them.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from itertools import chain

from domain.parts.mode_settings import TransitionSettings
from domain.parts.system_model import SmhModel
from domain.plans.scope import Links, Scope
from domain.plans.timing import Timing
from domain.plans.walk import Walk
from domain.state_and_mode import PartName
from domain.timebase import Duration


class Order:
    """Which nodes of a change wait, and for what; without a scope, all of them begin at once."""

    def __init__(self, scope: Scope | None = None) -> None:
        """Begin with no node done."""
        self._scope = scope
        self._walk = None if scope is None else Walk(scope)
        self._timing = None if scope is None else Timing(scope)
        self._after: dict[tuple[PartName, PartName], tuple[PartName, ...]] = {}
        """By system and part, the nodes that the part waits for, once somebody asked for them."""

    def waits(self, node: PartName) -> bool:
        """Tell whether a node of the change waits for others."""
        return self._walk is not None and node not in self._walk.begun

    @property
    def blocked(self) -> list[PartName]:
        """Return the nodes that wait for others; this looks at all of them."""
        if self._scope is None or self._walk is None:
            return []
        begun = self._walk.begun
        return [node for node in self._scope.nodes if node not in begun]

    def free_of(self, nodes: Iterable[PartName]) -> list[PartName]:
        """Return those nodes of the change that wait for none: at once, there may be many."""
        if self._walk is None:
            return list(nodes)
        begun = self._walk.begun
        return [node for node in nodes if node in begun]

    @property
    def stages(self) -> int:
        """Return how many stages there are; nodes of one stage may run side by side."""
        if self._scope is None or self._timing is None:
            return 1
        return max(1, self._timing.end(self._scope.part))

    def stage(self, node: PartName) -> int:
        """Return the stage of a node, from 0: the most nodes in a row that come before it."""
        return 0 if self._timing is None else self._timing.begin(node)

    def after(self, node: PartName) -> tuple[PartName, ...]:
        """Return the nodes that a node waits for, without those that these wait for."""
        if self._scope is None:
            return ()
        for system, part in self._scope.places(node):
            place = (system, part)
            if place not in self._after:
                self._after[place] = tuple(dict.fromkeys(_last_before(self._scope, *place)))
            if self._after[place]:
                return self._after[place]
        return ()

    def done(self, node: PartName) -> list[PartName]:
        """Note that a node is done; return those that now wait for nothing any more."""
        return [] if self._walk is None else self._walk.done(node)

    def longest(self, times: Mapping[PartName, Duration] | None) -> Duration | None:
        """Return how long all nodes take in this order; None: of some it is not known.

        Args:
            times: Of each node of the change.
        """
        if times is None:
            return None
        if self._scope is None:
            return max(times.values(), default=0)
        return Timing(self._scope, times).end(self._scope.part)

    def turned(self, nodes: Collection[PartName]) -> "Order":
        """Return the order in which some of the nodes go back: what came last goes first."""
        return Order() if self._scope is None else Order(_possible(self._scope.turned(nodes)))


def order_of(
    model: SmhModel,
    part: PartName,
    nodes: Collection[PartName],
    settings: Callable[[PartName], TransitionSettings],
    *,
    is_reversed: bool = False,
) -> Order:
    """Return the order in which the nodes of a change begin.

    Args:
        model: The model.
        part: The requested part.
        nodes: The nodes of the change.
        settings: Returns those of a system for this change.
        is_reversed: The parts that enter a mode last leave it first.
    """
    links = {
        name: Links(own.after, own.followers)
        for name in model.systems
        if name in model.mode_settings and (name == part or part in model.ancestors[name])
        if (own := settings(name)).after
    }
    if not links:
        return Order()
    scope = Scope(model, part, dict.fromkeys(nodes), links)
    return Order(_possible(scope.turned(nodes) if is_reversed else scope))


def _possible(scope: Scope) -> Scope:
    """Return a scope in which every node begins.

    Systems that share nodes may ask for orders that exclude each other: then neither counts.
    """
    if not scope.has_shared_parts:
        return scope
    scope = scope.without_empty()
    begun = Walk(scope).to_the_end().begun
    left = [node for node in scope.nodes if node not in begun]
    return scope.freed(chain.from_iterable(map(scope.places, left)))


def _last_before(scope: Scope, system: PartName, part: PartName) -> Iterator[PartName]:
    """Yield the last nodes of the parts that a part waits for."""
    before = scope.links[system].before
    waited_for = list(before.get(part, ()))
    for name in waited_for:
        last = list(_last_of(scope, name))
        yield from last
        if not last:
            waited_for += [more for more in before.get(name, ()) if more not in waited_for]


def _last_of(scope: Scope, part: PartName) -> Iterable[PartName]:
    """Return the nodes of a part that no other one of its nodes waits for."""
    last: list[PartName] = []
    left, seen = [part], {part}
    while left:
        name = left.pop()
        inside = scope.inside(name)
        if not inside:
            if name in scope.nodes:
                last.append(name)
            continue
        more = [p for p in inside if p not in seen and not scope.is_waited_for(name, p)]
        left.extend(reversed(more))
        seen.update(more)
    return last
