"""What a change orders: the requested part, its nodes, and which parts wait for which others."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Set
from dataclasses import dataclass, replace

from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName


@dataclass(frozen=True, slots=True)
class Links:
    """Which parts of one system wait for which others."""

    before: Mapping[PartName, tuple[PartName, ...]]
    """The parts that must be done before a part begins."""
    followers: Mapping[PartName, tuple[PartName, ...]]
    """The parts that wait for a part: the same the other way round."""

    def turned(self) -> "Links":
        """Return the links of the way back."""
        return Links(self.followers, self.before)

    def without(self, parts: Set[PartName]) -> "Links":
        """Return the links without some parts: who waits for one waits for those before it."""
        return Links(_without(parts, self.before), _without(parts, self.followers))


@dataclass(frozen=True, slots=True)
class Scope:
    """The part of a change with all that is below it.

    Also what no mode of this change names is in it, without nodes: a part without nodes is done as
    soon as its turn comes.
    """

    model: SmhModel
    part: PartName
    """The requested one."""
    nodes: Mapping[PartName, None]
    """The nodes of the change, in their order; a mapping to nothing is left out by Python's garbage
    collection, which would look through the ten thousand of each change that is kept.
    """
    links: Mapping[PartName, Links]
    """Of each system that orders its parts."""
    left_out: Set[PartName] = frozenset()
    """Parts that are not in it."""

    def inside(self, part: PartName) -> tuple[PartName, ...]:
        """Return the parts of a system; a node has none."""
        system = self.model.systems.get(part)
        if system is None:
            return ()
        if not self.left_out:
            return system.named_parts
        return tuple(part for part in system.named_parts if part not in self.left_out)

    def systems_of(self, part: PartName) -> tuple[PartName, ...]:
        """Return the systems in this scope that a part belongs to directly."""
        if part == self.part:
            return ()
        systems = self.model.parents.get(part, ())
        if len(systems) == 1:
            return systems
        return tuple(system for system in systems if self._includes(system))

    @property
    def has_shared_parts(self) -> bool:
        """Tell whether a part belongs to several systems of this scope."""
        return any(len(self.systems_of(part)) > 1 for part in self.model.shared_parts)

    def has_nodes(self, part: PartName) -> bool:
        """Tell whether a part, or one below it, is a node of the change."""
        left = [part]
        while left:
            name = left.pop()
            if name in self.nodes:
                return True
            left.extend(self.inside(name))
        return False

    def is_waited_for(self, system: PartName, part: PartName) -> bool:
        """Tell whether nodes of a system wait for a part, or for one without nodes after it."""
        if system not in self.links:
            return False
        followers = self.links[system].followers
        after = list(followers.get(part, ()))
        for name in after:
            if self.has_nodes(name):
                return True
            after += [more for more in followers.get(name, ()) if more not in after]
        return False

    def places(self, node: PartName) -> Iterator[tuple[PartName, PartName]]:
        """Yield where a node waits: inner systems first, with their part that has the node."""
        above = self.model.ancestors[node]
        for system in above:
            links = self.links.get(system)
            if links is not None:
                for part in (node, *above):
                    if part in links.before:
                        yield system, part

    def turned(self, nodes: Collection[PartName]) -> "Scope":
        """Return the scope in which some of the nodes go back."""
        links = {system: links.turned() for system, links in self.links.items()}
        return replace(self, nodes=dict.fromkeys(nodes), links=links)

    def without_empty(self) -> "Scope":
        """Return the scope without those parts of several systems that have no nodes in it.

        What has none waits in no system for another one.
        """
        shared = (part for part in self.model.shared_parts if len(self.systems_of(part)) > 1)
        empty = frozenset(part for part in shared if not self.has_nodes(part))
        links = {system: own.without(empty) for system, own in self.links.items()}
        return replace(self, links=links, left_out=empty)

    def freed(self, places: Iterable[tuple[PartName, PartName]]) -> "Scope":
        """Return the scope in which parts of systems wait for nothing any more."""
        free = set(places)
        return replace(
            self,
            links={
                system: Links(
                    {p: names for p, names in own.before.items() if (system, p) not in free},
                    {
                        p: tuple(name for name in names if (system, name) not in free)
                        for p, names in own.followers.items()
                    },
                )
                for system, own in self.links.items()
            },
        )

    def _includes(self, system: PartName) -> bool:
        return system == self.part or self.part in self.model.ancestors[system]


def _without(
    parts: Set[PartName], links: Mapping[PartName, tuple[PartName, ...]]
) -> dict[PartName, tuple[PartName, ...]]:
    """Return what parts are linked to, past those that are to be left out."""
    found: dict[PartName, tuple[PartName, ...]] = {}
    for part in links:
        if part in parts:
            continue
        past = list(links[part])
        for name in past:
            if name in parts:
                past += [more for more in links.get(name, ()) if more not in past]
        found[part] = tuple(name for name in past if name not in parts)
    return found
