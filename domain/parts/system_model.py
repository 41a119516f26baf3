"""The model of a robot: systems and nodes, their modes and their hierarchy.

Called SMH (system modes and hierarchy) in micro-ROS system_modes. Immutable and checked: an
`SmhModel` that exists is free of cycles, unknown parts and unknown modes.

Source: micro-ROS deliverable D4.8, section 4.1; micro-ROS system_modes, `mode_inference.cpp` and
README.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import chain, islice
from types import MappingProxyType

from domain.circles import in_words
from domain.errors import InvalidModelError, UnknownModeError, UnknownPartError, near_match
from domain.findings import Finding
from domain.lifecycle import LifecycleState
from domain.parameters import Parameters
from domain.parts.declared_errors import DeclaredError
from domain.parts.declared_reactions import DeclaredReaction
from domain.parts.errors_check import error_circles
from domain.parts.invariant_circles import invariant_circles
from domain.parts.mode_settings import ModeSettings
from domain.parts.reactions_check import all_reactions, check_reactions
from domain.parts.settings_check import check_settings
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

EVERY_MODE = ModeName("__ALL__")
"""Stands for every mode of a part that has no settings of its own."""

_DEFAULTS = ModeSettings()

MAX_LEVELS = 64
"""Largest depth of nested systems; bounds every traversal, and is far above that of any robot."""

MAX_ANCESTORS = 1_000_000
"""Ancestors of all parts together; a balanced model of 10,000 nodes has less than 50,000."""

_MAX_CYCLES_TOLD = 100
_MOST_COMPARED = 200
"""Names that one may be a slip of, for each name that is not known."""


@dataclass(frozen=True, slots=True)
class NodeModel:
    """A node: it runs, and has a lifecycle and parameters."""

    name: PartName
    modes: Mapping[ModeName, Parameters] = field(default_factory=dict)
    """Parameters of each mode, including those of `__DEFAULT__`; empty: the node has no modes."""


@dataclass(frozen=True, slots=True)
class Rule:
    """The target that replaces `if_target` of a system while a part is in a given state."""

    name: str
    if_target: StateAndMode
    if_part: tuple[PartName, StateAndMode]
    new_target: StateAndMode


@dataclass(frozen=True, slots=True)
class SystemModel:
    """A system: virtual, inferred from its parts."""

    name: PartName
    modes: Mapping[ModeName, Mapping[PartName, StateAndMode]]
    """What each mode requires of its parts, in the order of the file, including `__DEFAULT__`;
    empty for a system without parts.
    """
    rules: tuple[Rule, ...] = ()
    named_parts: tuple[PartName, ...] = field(init=False, compare=False, repr=False)
    """The parts that any mode names, also those that `__DEFAULT__` does not."""

    def __post_init__(self) -> None:
        """Note which parts are named."""
        named = dict.fromkeys(part for wanted in self.modes.values() for part in wanted)
        object.__setattr__(self, "named_parts", tuple(named))

    @property
    def parts(self) -> tuple[PartName, ...]:
        """Return the parts of this system: those of `__DEFAULT__`, in the order of the file."""
        return tuple(self.modes.get(DEFAULT_MODE, ()))


@dataclass(frozen=True)
class SmhModel:
    """Systems and nodes of one robot.

    Raises:
        InvalidModelError: A cycle, an unknown part or mode, or nesting beyond `MAX_LEVELS` or
            `MAX_ANCESTORS`.
    """

    nodes: Mapping[PartName, NodeModel]
    systems: Mapping[PartName, SystemModel]
    mode_settings: Mapping[PartName, Mapping[ModeName, ModeSettings]] = field(default_factory=dict)
    """Settings of modes, by part; read by `settings_of`. `EVERY_MODE` is a key beside them;
    what a mode does not say is filled in from it.
    """
    errors: Mapping[PartName, Mapping[str, DeclaredError]] = field(default_factory=dict)
    """Errors that the file declares, by part and name; also what it says about built-in ones."""
    reactions: Mapping[PartName, Mapping[str, DeclaredReaction]] = field(default_factory=dict)
    """Reactions by part and name, in the order of the file."""
    ancestors: Mapping[PartName, tuple[PartName, ...]] = field(init=False)
    """Every system that a part belongs to, directly or indirectly; children before parents."""
    parents: Mapping[PartName, tuple[PartName, ...]] = field(init=False)
    """The systems that name each part, in the order of the file; what none names is left out."""
    shared_parts: frozenset[PartName] = field(init=False)
    """The parts that several systems name."""

    def __post_init__(self) -> None:
        """Check the model, then freeze it."""
        findings = find_errors(self.nodes, self.systems) or self._errors_of_settings()
        if findings:
            raise InvalidModelError(findings)
        object.__setattr__(self, "nodes", MappingProxyType(dict(self.nodes)))
        object.__setattr__(self, "systems", MappingProxyType(_shared(self.nodes, self.systems)))
        object.__setattr__(self, "mode_settings", MappingProxyType(dict(self.mode_settings)))
        object.__setattr__(self, "errors", MappingProxyType(dict(self.errors)))
        object.__setattr__(self, "reactions", MappingProxyType(dict(self.reactions)))
        object.__setattr__(
            self, "ancestors", MappingProxyType(_ancestors(self.systems, self.nodes))
        )
        parents = _parents(self.systems.values())
        shared = frozenset(part for part, systems in parents.items() if len(systems) > 1)
        object.__setattr__(self, "parents", MappingProxyType(parents))
        object.__setattr__(self, "shared_parts", shared)

    def _errors_of_settings(self) -> list[Finding]:
        findings: list[Finding] = []
        for part, settings in self.mode_settings.items():
            parts = self.systems[part].named_parts if part in self.systems else ()
            findings.extend(check_settings(part, settings, self.modes_of(part), parts))
        findings.extend(invariant_circles(self.mode_settings, self.errors))
        findings.extend(error_circles(self.errors))
        modes_of = {part: self.modes_of(part) for part in self.reactions}
        reactions = all_reactions(self.reactions)
        findings.extend(check_reactions(reactions, modes_of, self.nodes, self.errors))
        return findings

    @property
    def parts(self) -> tuple[PartName, ...]:
        """Return all names: systems first, then nodes, each in the order of the file."""
        return (*self.systems, *self.nodes)

    @property
    def has_conditions(self) -> bool:
        """Tell whether anything in it depends on a condition."""
        if any(self.errors.values()) or any(self.reactions.values()):
            return True
        settings = chain.from_iterable(by_mode.values() for by_mode in self.mode_settings.values())
        return any(own.requires or own.invariants for own in settings)

    def __contains__(self, name: str) -> bool:
        """Tell whether there is a part of that name."""
        return name in self.systems or name in self.nodes

    def modes_of(self, part: PartName) -> tuple[ModeName, ...]:
        """Return the modes of a part in the order of the file; empty: it has none.

        Raises:
            UnknownPartError: There is no such part.
        """
        if part in self.systems:
            return tuple(self.systems[part].modes)
        if part in self.nodes:
            return tuple(self.nodes[part].modes)
        raise UnknownPartError("part", part, self.parts)

    def require_mode(self, part: PartName, mode: str) -> ModeName:
        """Return `mode` as a mode of `part`.

        Raises:
            UnknownPartError: There is no such part.
            UnknownModeError: The part has no such mode.
        """
        modes = self.modes_of(part)
        if mode not in modes:
            hint = None if modes else f"{part} has no modes, only a lifecycle state"
            raise UnknownModeError(f"mode of {part}", mode, modes, hint)
        return ModeName(mode)

    def settings_of(self, part: PartName, mode: ModeName | None) -> ModeSettings:
        """Return the settings of a mode of a part; None: of a state in which it has no mode."""
        settings = self.mode_settings.get(part)
        if settings is None:
            return _DEFAULTS
        own = settings.get(mode) if mode is not None else None
        return own or settings.get(EVERY_MODE) or _DEFAULTS

    def path_down(self, part: PartName, below: PartName) -> tuple[PartName, ...]:
        """Return one path from a part down to one below it, with both ends."""
        path, systems = [part], self.systems
        while path[-1] != below:
            children = systems[path[-1]].named_parts
            inside = (
                each for each in children if each in systems and each in self.ancestors[below]
            )
            path.append(below if below in children else next(inside))
        return tuple(path)

    def nodes_below(self, part: PartName) -> tuple[PartName, ...]:
        """Return the nodes that a part consists of, each once; a node consists of itself."""
        if part in self.nodes:
            return (part,)
        found: dict[PartName, None] = {}
        seen: set[PartName] = set()
        waiting = [part]
        nodes, systems = self.nodes, self.systems
        while waiting:
            name = waiting.pop()
            if name in nodes:
                found[name] = None
            elif name not in seen:
                seen.add(name)
                waiting.extend(reversed(systems[name].parts))
        return tuple(found)


def _shared(
    nodes: Mapping[PartName, NodeModel], systems: Mapping[PartName, SystemModel]
) -> dict[PartName, SystemModel]:
    """Return the same systems with one object for each name and for each state and mode.

    A request of a large robot looks at those of all parts, and most of its time goes into fetching
    them from memory.
    """
    names = {name: name for name in (*systems, *nodes)}
    pairs: dict[StateAndMode, StateAndMode] = {}
    return {
        name: replace(
            system,
            modes={
                mode: {names[part]: pairs.setdefault(want, want) for part, want in wanted.items()}
                for mode, wanted in system.modes.items()
            },
        )
        for name, system in systems.items()
    }


def find_errors(
    nodes: Mapping[PartName, NodeModel], systems: Mapping[PartName, SystemModel]
) -> list[Finding]:
    """Return all errors of a model: unknown parts and modes, cycles, too deep nesting."""
    modes_of: dict[PartName, Collection[ModeName]] = {
        **{name: node.modes for name, node in nodes.items()},
        **{name: system.modes for name, system in systems.items()},
    }
    findings = [
        _missing_default(part)
        for part, modes in modes_of.items()
        if modes and DEFAULT_MODE not in modes
    ]
    for system in systems.values():
        findings.extend(_check_wants(modes_of, system))
        for rule in system.rules:
            findings.extend(_check_rule(modes_of, system.name, rule))
    hierarchy = _Hierarchy.of(systems)
    findings.extend(_cycle(systems, cycle) for cycle in hierarchy.cycles)
    too_deep = None if findings else hierarchy.too_deep()
    if too_deep is not None:
        message = f"{too_deep} has more than {MAX_LEVELS} levels of systems below it"
        findings.append(Finding("error", "TOO_DEEP", message, too_deep, (too_deep,)))
    return findings


def _missing_default(part: PartName) -> Finding:
    message = f"{part} has modes, but no {DEFAULT_MODE}"
    return Finding("error", "MISSING_DEFAULT_MODE", message, part, (part, "modes"))


def _check_wants(
    modes_of: Mapping[PartName, Collection[ModeName]], system: SystemModel
) -> Iterable[Finding]:
    """Check the lines of all modes; lines inherited from `__DEFAULT__` are reported there only."""
    default = system.modes.get(DEFAULT_MODE, {})
    for mode, wanted in system.modes.items():
        for part, want in wanted.items():
            if mode == DEFAULT_MODE or default.get(part) != want:
                where = f"{system.name} in {mode}"
                place = (system.name, "modes", mode, part)
                yield from _check_pair(modes_of, where, part, want, system.name, place)


def _check_rule(
    modes_of: Mapping[PartName, Collection[ModeName]], system: PartName, rule: Rule
) -> Iterable[Finding]:
    for key, part, pair in (
        ("if_target", system, rule.if_target),
        ("if_part", *rule.if_part),
        ("new_target", system, rule.new_target),
    ):
        place = (system, "rules", rule.name, key)
        where = f"rule {rule.name} of {system}, {key}"
        yield from _check_pair(modes_of, where, part, pair, system, place)


def _check_pair(
    modes_of: Mapping[PartName, Collection[ModeName]],
    where: str,
    part: PartName,
    pair: StateAndMode,
    owner: PartName,
    place: tuple[str, ...],
) -> Iterable[Finding]:
    """Check that a part exists and has the mode.

    Args:
        modes_of: Modes by part.
        where: The place in words, for the message.
        part: The part to check.
        pair: State and mode that the place names.
        owner: The part whose block holds the place.
        place: Keys that lead to the place.
    """
    modes = modes_of.get(part)
    if modes is None:
        message = f"{where}: there is no part {part!r}{_hint(part, modes_of)}"
        yield Finding("error", "UNKNOWN_PART", message, owner, place)
    elif pair.state is LifecycleState.ACTIVE and pair.mode is not None and pair.mode not in modes:
        known = f"it has {', '.join(modes)}" if modes else "it has no modes"
        message = f"{where}: {part} has no mode {pair.mode!r}; {known}{_hint(pair.mode, modes)}"
        yield Finding("error", "UNKNOWN_MODE", message, owner, place)


def _hint(name: str, known: Iterable[str]) -> str:
    near = near_match(name, tuple(islice(known, _MOST_COMPARED)))
    return f"; did you mean {near}?" if near else ""


def _cycle(systems: Mapping[PartName, SystemModel], cycle: tuple[PartName, ...]) -> Finding:
    owner, name = cycle[-2:]
    mode = next(mode for mode, wanted in systems[owner].modes.items() if name in wanted)
    message = f"{name} contains itself: {in_words(cycle, ' > ')}"
    return Finding("error", "CYCLE", message, owner, (owner, "modes", mode, name))


@dataclass(frozen=True, slots=True)
class _Hierarchy:
    """The hierarchy of systems, found in one traversal without recursion."""

    children: Mapping[PartName, tuple[PartName, ...]]
    """The systems in each system."""
    order: tuple[PartName, ...]
    """All systems, each after those that it contains."""
    cycles: tuple[tuple[PartName, ...], ...]
    """Cycles, each from a system back to itself; not all of them, but empty only without cycles."""

    @classmethod
    def of(cls, systems: Mapping[PartName, SystemModel]) -> "_Hierarchy":
        """Traverse depth-first; a system that is met again on the way down closes a cycle."""
        children = {
            name: tuple(part for part in system.named_parts if part in systems)
            for name, system in systems.items()
        }
        order: dict[PartName, None] = {}
        cycles: list[tuple[PartName, ...]] = []
        for root in systems:
            if root in order:
                continue
            trail: dict[PartName, None] = {root: None}
            waiting = [iter(children[root])]
            while waiting:
                child = next(waiting[-1], None)
                if child is None:
                    waiting.pop()
                    order[trail.popitem()[0]] = None
                elif child in trail:
                    if len(cycles) < _MAX_CYCLES_TOLD:
                        names = tuple(trail)
                        cycles.append((*names[names.index(child) :], child))
                elif child not in order:
                    trail[child] = None
                    waiting.append(iter(children[child]))
        return cls(children, tuple(order), tuple(cycles))

    def heights(self) -> dict[PartName, int]:
        """Return the height of each system: one more than the highest system that it contains."""
        height: dict[PartName, int] = {}
        for name in self.order:
            height[name] = 1 + max((height[child] for child in self.children[name]), default=0)
        return height

    def too_deep(self) -> PartName | None:
        """Return a system with too many levels below it; None: there is none. Needs no cycles."""
        heights = self.heights()
        return next((name for name in self.order if heights[name] > MAX_LEVELS), None)


def _parents(systems: Iterable[SystemModel]) -> dict[PartName, tuple[PartName, ...]]:
    """Return the systems that name each part; parts that none names are left out."""
    found: dict[PartName, list[PartName]] = {}
    for system in systems:
        for part in system.named_parts:
            found.setdefault(part, []).append(system.name)
    return {part: tuple(parents) for part, parents in found.items()}


def _ancestors(
    systems: Mapping[PartName, SystemModel], nodes: Mapping[PartName, NodeModel]
) -> dict[PartName, tuple[PartName, ...]]:
    """Return the ancestors of each part, bottom-up, so that one pass infers all of them."""
    parents: dict[PartName, list[PartName]] = {name: [] for name in (*systems, *nodes)}
    for system in systems.values():
        for part in system.named_parts:
            parents[part].append(system.name)
    hierarchy = _Hierarchy.of(systems)
    height = hierarchy.heights()
    found: dict[PartName, tuple[PartName, ...]] = {}
    of_parents: dict[tuple[PartName, ...], tuple[PartName, ...]] = {}
    total = 0
    for name in (*reversed(hierarchy.order), *nodes):
        above = tuple(parents[name])
        if above not in of_parents:
            all_above = {*above, *chain.from_iterable(found[parent] for parent in above)}
            of_parents[above] = tuple(sorted(all_above, key=lambda s: (height[s], s)))
        found[name] = of_parents[above]
        total += len(found[name])
        if total > MAX_ANCESTORS:
            message = "too many parts belong to too many systems"
            raise InvalidModelError([Finding("error", "TOO_LARGE", message, name, (name,))])
    return {name: found[name] for name in parents}
