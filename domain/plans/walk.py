"""The parts of a change as their turns come."""

from collections.abc import Sequence

from domain.plans.scope import Scope
from domain.state_and_mode import PartName


class Walk:
    """Which parts have begun, and which are done."""

    def __init__(self, scope: Scope) -> None:
        """Begin with no node done."""
        self._scope = scope
        self.begun: set[PartName] = set()
        """The parts whose turn has come."""
        self._open: dict[PartName, int] = {}
        """Of each system that has begun, how many of its parts are not done."""
        self._waits: dict[tuple[PartName, PartName], int] = {}
        """By system and part, how many the part still waits for, if some of several are done."""
        self._let_begin: dict[PartName, int] = {}
        """Of a part of several systems, how many of them let it begin."""
        self._free: list[PartName] = []
        """The nodes whose turn has come since the last call."""
        self._begin_and_end([scope.part], [])

    def done(self, node: PartName) -> list[PartName]:
        """Note that a node is done; return those whose turn comes by that."""
        self._free = []
        self._begin_and_end([], [node])
        return self._free

    def to_the_end(self) -> "Walk":
        """Do all nodes; return this walk, in which each part has begun that ever will."""
        left = self._free
        while left:
            left.extend(self.done(left.pop()))
        return self

    def _begin_and_end(self, begun: list[PartName], ended: list[PartName]) -> None:
        """Let parts begin and end, and what follows from that, until there are none."""
        while begun or ended:
            if begun:
                self._begin(begun.pop(), begun, ended)
            else:
                self._end(ended.pop(), begun, ended)

    def _begin(self, part: PartName, begun: list[PartName], ended: list[PartName]) -> None:
        """Let a part begin, unless another one of its systems has not come to it yet."""
        scope = self._scope
        systems = scope.systems_of(part)
        if len(systems) > 1:
            self._let_begin[part] = let = self._let_begin.get(part, 0) + 1
            if let < len(systems):
                return
        self.begun.add(part)
        inside = scope.inside(part)
        if inside:
            self._open[part] = len(inside)
            self._begin_inside(part, inside, begun)
        elif part in scope.nodes:
            self._free.append(part)
        else:
            ended.append(part)

    def _begin_inside(
        self, system: PartName, inside: Sequence[PartName], begun: list[PartName]
    ) -> None:
        """Let those parts of a system begin that wait for no other one."""
        scope, first = self._scope, inside
        if (links := scope.links.get(system)) is not None:
            before = links.before
            first = [part for part in inside if part not in before or not before[part]]
        if scope.nodes.keys() >= set(first) and scope.model.shared_parts.isdisjoint(first):
            # Nodes of no other system begin in bulk: there may be ten thousand.
            self.begun.update(first)
            self._free += first
        else:
            begun.extend(reversed(first))

    def _end(self, part: PartName, begun: list[PartName], ended: list[PartName]) -> None:
        """Note in the systems of a part that it is done, and let those begin that waited for it."""
        scope = self._scope
        for system in scope.systems_of(part):
            self._open[system] -= 1
            if not self._open[system]:
                ended.append(system)
            if (links := scope.links.get(system)) is not None:
                for name in reversed(links.followers.get(part, ())):
                    if self._waits_no_more(system, name, links.before[name]):
                        begun.append(name)

    def _waits_no_more(
        self, system: PartName, part: PartName, before: tuple[PartName, ...]
    ) -> bool:
        """Note that one of those that a part waits for is done; tell whether it was the last."""
        if len(before) == 1:
            return True
        place = (system, part)
        self._waits[place] = left = self._waits.get(place, len(before)) - 1
        return not left
