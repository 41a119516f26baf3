"""In which order the nodes of a change begin.

The settings of a mode say which parts of a system wait for which others. A part is done once all
nodes of the change below it are; a system inside another one orders its own parts. Both together
say which node waits for which parts.
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field

from domain.parts.mode_settings import TransitionSettings
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName
from domain.timebase import Duration


@dataclass(slots=True, eq=False)
class Unit:
    """A part that others wait for, or that waits for others, with its nodes in the change."""

    nodes: tuple[PartName, ...]
    before: list[int] = field(default_factory=list)
    """The parts that it waits for, as numbers: a long row of objects could not be pickled."""
    followers: list[int] = field(default_factory=list)
    open: int = 0
    """Nodes that are not done."""
    waits: int = 0
    """Parts that it waits for and that are not done."""


class Order:
    """Which nodes of a change wait, and for what; nodes that it does not name begin at once."""

    def __init__(self, units: Sequence[Unit] = ()) -> None:
        """Begin with no node done.

        Args:
            units: The outer ones first.
        """
        self._units = units
        self._of_node: dict[PartName, list[int]] = {}
        for number, unit in enumerate(units):
            for node in unit.nodes:
                self._of_node.setdefault(node, []).append(number)
        self._blocked: dict[PartName, int] = {}
        """Of each node that waits, how many of its units do."""
        self._begin()
        self._stages = self._number()
        if self._blocked:
            # Systems that share nodes ask for orders that exclude each other: neither counts.
            self._free(self._blocked.keys())
            self._begin()
            self._stages = self._number()
        self._begin()

    @property
    def blocked(self) -> Collection[PartName]:
        """Return the nodes that wait for others."""
        return self._blocked.keys()

    @property
    def stages(self) -> int:
        """Return how many stages there are; nodes of one stage may run side by side."""
        return 1 + max(self._stages.values(), default=0)

    def stage(self, node: PartName) -> int:
        """Return the stage of a node, from 0: the most nodes in a row that come before it."""
        return self._stages.get(node, 0)

    def after(self, node: PartName) -> tuple[PartName, ...]:
        """Return the nodes that a node waits for, without those that these wait for."""
        for number in reversed(self._of_node.get(node, ())):
            if last := self._last_before(number):
                return last
        return ()

    def done(self, node: PartName) -> list[PartName]:
        """Note that a node is done; return those that now wait for nothing any more."""
        ended = []
        for number in self._of_node.get(node, ()):
            unit = self._units[number]
            unit.open -= 1
            if not unit.open:
                ended.append(number)
        return self._release(ended)

    def longest(self, times: Mapping[PartName, Duration] | None) -> Duration | None:
        """Return how long all nodes take in this order; None: of some it is not known.

        Args:
            times: Of each node of the change.
        """
        if times is None:
            return None
        ends: dict[PartName, Duration] = {}
        for node in sorted(times, key=self.stage):
            begin = max((ends[name] for name in self.after(node)), default=0)
            ends[node] = begin + times[node]
        return max(ends.values(), default=0)

    def turned(self, nodes: Collection[PartName]) -> "Order":
        """Return the order in which some of the nodes go back: what came last goes first."""
        return Order(
            [
                Unit(
                    tuple(node for node in unit.nodes if node in nodes),
                    list(unit.followers),
                    list(unit.before),
                )
                for unit in self._units
            ]
        )

    def _release(self, ended: list[int]) -> list[PartName]:
        """Return the nodes that wait for nothing any more, since these parts are done."""
        released: list[PartName] = []
        while ended:
            for number in self._units[ended.pop()].followers:
                unit = self._units[number]
                unit.waits -= 1
                if unit.waits:
                    continue
                if not unit.nodes:
                    ended.append(number)
                for node in unit.nodes:
                    self._blocked[node] -= 1
                    if not self._blocked[node]:
                        del self._blocked[node]
                        released.append(node)
        return released

    def _begin(self) -> None:
        """Begin with no node done."""
        self._blocked.clear()
        for unit in self._units:
            unit.open, unit.waits = len(unit.nodes), len(unit.before)
            if unit.before:
                for node in unit.nodes:
                    self._blocked[node] = self._blocked.get(node, 0) + 1
        # A part without nodes in the change is done as soon as those before it are.
        self._release([n for n, unit in enumerate(self._units) if not (unit.nodes or unit.before)])

    def _number(self) -> dict[PartName, int]:
        """Do all nodes, stage by stage; return the stage of each."""
        stages: dict[PartName, int] = {}
        stage, ready = 0, [node for node in self._of_node if node not in self._blocked]
        while ready:
            stages.update(dict.fromkeys(ready, stage))
            stage, ready = stage + 1, [name for node in ready for name in self.done(node)]
        return stages

    def _last_before(self, number: int) -> tuple[PartName, ...]:
        """Return the last nodes of the parts that a part waits for."""
        last: dict[PartName, None] = {}
        before = list(self._units[number].before)
        for part in before:
            unit = self._units[part]
            if unit.nodes:
                last.update(dict.fromkeys(self._last(part)))
            else:
                before += [name for name in unit.before if name not in before]
        return tuple(last)

    def _last(self, part: int) -> Iterable[PartName]:
        """Return the nodes of a part that no other one of its nodes waits for."""
        for node in self._units[part].nodes:
            units = self._of_node[node]
            inner = units[units.index(part) + 1 :]
            if not any(self._units[number].followers for number in inner):
                yield node

    def _free(self, nodes: Set[PartName]) -> None:
        """Let the parts that hold any of these nodes wait for nothing."""
        for number, unit in enumerate(self._units):
            if not nodes.isdisjoint(unit.nodes):
                for before in unit.before:
                    self._units[before].followers.remove(number)
                unit.before.clear()


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
    systems = [
        name
        for name in model.mode_settings
        if name in model.systems and (name == part or part in model.ancestors[name])
    ]
    units: list[Unit] = []
    for system in sorted(systems, key=lambda name: (len(model.ancestors[name]), name)):
        after = settings(system).after
        if after:
            below = {name: _below(model, name, nodes) for name in _named(after)}
            _add_units(units, _turned(after) if is_reversed else after, below)
    return Order(units)


def _named(after: Mapping[PartName, Sequence[PartName]]) -> list[PartName]:
    """Return the parts that wait or are waited for, each once."""
    names = (name for part, before in after.items() for name in (part, *before))
    return list(dict.fromkeys(names))


def _below(model: SmhModel, part: PartName, nodes: Collection[PartName]) -> tuple[PartName, ...]:
    return tuple(node for node in model.nodes_below(part) if node in nodes)


def _turned(
    after: Mapping[PartName, Sequence[PartName]],
) -> dict[PartName, list[PartName]]:
    turned: dict[PartName, list[PartName]] = {}
    for part, before in after.items():
        for name in before:
            turned.setdefault(name, []).append(part)
    return turned


def _add_units(
    units: list[Unit],
    after: Mapping[PartName, Sequence[PartName]],
    below: Mapping[PartName, tuple[PartName, ...]],
) -> None:
    """Add the parts of one system that wait or are waited for."""
    numbers = {part: len(units) + place for place, part in enumerate(below)}
    units += [
        Unit(nodes, [numbers[name] for name in dict.fromkeys(after.get(part, ()))])
        for part, nodes in below.items()
    ]
    for number in numbers.values():
        for before in units[number].before:
            units[before].followers.append(number)
