"""The model of a robot: systems and nodes, their modes, and how they hang together.

Called SMH (system modes and hierarchy) in micro-ROS system_modes. Immutable, and it checks itself:
an `SmhModel` that exists is free of cycles, unknown parts and unknown modes.

Source: deliverable D4.8, 4.1; micro-ROS system_modes, `mode_inference.cpp` and README.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NewType, TypeAlias

from domain.errors import InvalidModelError, UnknownModeError, UnknownPartError
from domain.findings import Finding
from domain.lifecycle import LifecycleState

PartName = NewType("PartName", str)
"""Name of a system or a node, without a leading slash; may hold slashes (`left/arm`)."""

ModeName = NewType("ModeName", str)

DEFAULT_MODE = ModeName("__DEFAULT__")

ParameterValue: TypeAlias = (
    bool
    | int
    | float
    | str
    | tuple[bool, ...]
    | tuple[int, ...]
    | tuple[float, ...]
    | tuple[str, ...]
)
"""A value of a ROS 2 parameter; 1 and 1.0 are different, as their types are."""

Parameters: TypeAlias = Mapping[str, ParameterValue]


def same_value(one: ParameterValue, other: ParameterValue) -> bool:
    """Tell whether two parameter values are equal in type and value."""
    return type(one) is type(other) and one == other


@dataclass(frozen=True, slots=True)
class StateAndMode:
    """A lifecycle state and, where there is one, the mode in it."""

    state: LifecycleState
    mode: ModeName | None = None

    @property
    def label(self) -> str:
        """Return `active.FAST`, or the bare state where there is no mode."""
        return f"{self.state}.{self.mode}" if self.mode else str(self.state)

    @classmethod
    def parse(cls, label: str) -> "StateAndMode":
        """Read `active.FAST` or `inactive`; a mode is kept only with `active` and `activating`.

        Raises:
            ValueError: The part before the first dot is no label of a lifecycle state.
        """
        text, _, mode = label.partition(".")
        state = LifecycleState(text)
        has_mode = state in (LifecycleState.ACTIVE, LifecycleState.ACTIVATING)
        return cls(state, ModeName(mode) if mode and has_mode else None)

    def agrees_with(self, other: "StateAndMode") -> bool:
        """Tell whether both mean the same: no mode and `__DEFAULT__` are one, and only when active."""
        if self.state is not other.state:
            return False
        return self.state is not LifecycleState.ACTIVE or (self.mode or DEFAULT_MODE) == (
            other.mode or DEFAULT_MODE
        )


@dataclass(frozen=True, slots=True)
class NodeModel:
    """A node: something that runs, and has a lifecycle and parameters of its own."""

    name: PartName
    modes: Mapping[ModeName, Parameters] = field(default_factory=dict)
    """Parameters of each mode, those of `__DEFAULT__` merged in; empty: only a lifecycle state."""


@dataclass(frozen=True, slots=True)
class Rule:
    """What to do when a part of a system is in a given state while the system has a given target."""

    name: str
    if_target: StateAndMode
    if_part: tuple[PartName, StateAndMode]
    new_target: StateAndMode


@dataclass(frozen=True, slots=True)
class SystemModel:
    """A system: virtual, inferred from its parts."""

    name: PartName
    modes: Mapping[ModeName, Mapping[PartName, StateAndMode]]
    """What each mode wants of its parts, in the order of the file, `__DEFAULT__` merged in."""
    rules: tuple[Rule, ...] = ()

    @property
    def parts(self) -> tuple[PartName, ...]:
        """Return the parts of this system: those of `__DEFAULT__`, in the order of the file."""
        return tuple(self.modes[DEFAULT_MODE])


@dataclass(frozen=True)
class SmhModel:
    """Systems and nodes of one robot.

    Raises:
        InvalidModelError: A cycle, or a part or mode that is named but not there.
    """

    nodes: Mapping[PartName, NodeModel]
    systems: Mapping[PartName, SystemModel]
    ancestors: Mapping[PartName, tuple[PartName, ...]] = field(init=False)
    """Every system that a part belongs to, directly or not; children before their parents."""

    def __post_init__(self) -> None:
        """Check the model, then freeze it."""
        findings = find_errors(self.nodes, self.systems)
        if findings:
            raise InvalidModelError(findings)
        object.__setattr__(self, "nodes", MappingProxyType(dict(self.nodes)))
        object.__setattr__(self, "systems", MappingProxyType(dict(self.systems)))
        object.__setattr__(
            self, "ancestors", MappingProxyType(_ancestors(self.systems, self.nodes))
        )

    @property
    def parts(self) -> tuple[PartName, ...]:
        """Return all names: systems first, each in the order of the file."""
        return (*self.systems, *self.nodes)

    def __contains__(self, name: str) -> bool:
        """Tell whether there is a part of that name."""
        return name in self.systems or name in self.nodes

    def modes_of(self, part: PartName) -> tuple[ModeName, ...]:
        """Return the modes of a part in the order of the file; empty where it has none.

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

    def nodes_below(self, part: PartName) -> tuple[PartName, ...]:
        """Return the nodes that a part consists of, each once; a node consists of itself."""
        if part in self.nodes:
            return (part,)
        found: dict[PartName, None] = {}
        for child in self.systems[part].parts:
            found.update(dict.fromkeys(self.nodes_below(child)))
        return tuple(found)


def find_errors(
    nodes: Mapping[PartName, NodeModel], systems: Mapping[PartName, SystemModel]
) -> list[Finding]:
    """Return everything that makes a model unusable: unknown parts and modes, and cycles."""
    findings: list[Finding] = []
    for system in systems.values():
        if DEFAULT_MODE not in system.modes:
            findings.append(_missing_default(system.name))
        for mode, wanted in system.modes.items():
            for part, want in wanted.items():
                findings.extend(_check_want(nodes, systems, system.name, mode, part, want))
    findings.extend(
        _missing_default(node.name)
        for node in nodes.values()
        if node.modes and DEFAULT_MODE not in node.modes
    )
    findings.extend(_find_cycles(systems))
    return findings


def _missing_default(part: PartName) -> Finding:
    message = f"{part} has modes, but no {DEFAULT_MODE}"
    return Finding("error", "MISSING_DEFAULT_MODE", message, part, (part, "modes"))


def _check_want(
    nodes: Mapping[PartName, NodeModel],
    systems: Mapping[PartName, SystemModel],
    system: PartName,
    mode: ModeName,
    part: PartName,
    want: StateAndMode,
) -> Iterable[Finding]:
    """Check one line of a mode: the part is there, and has the mode that is wanted of it."""
    place = (system, "modes", mode, part)
    if part not in nodes and part not in systems:
        message = f"{system} in {mode}: there is no part {part!r}"
        yield Finding("error", "UNKNOWN_PART", message, system, place)
        return
    modes = nodes[part].modes if part in nodes else systems[part].modes
    if want.state is LifecycleState.ACTIVE and want.mode is not None and want.mode not in modes:
        known = f"it has {', '.join(modes)}" if modes else "it has no modes"
        message = f"{system} in {mode}: {part} has no mode {want.mode!r}; {known}"
        yield Finding("error", "UNKNOWN_MODE", message, system, place)


def _find_cycles(systems: Mapping[PartName, SystemModel]) -> Iterable[Finding]:
    """Find systems that contain themselves; each cycle is told once, without recursion."""
    done: set[PartName] = set()
    for root in systems:
        trail: list[PartName] = []
        waiting: list[tuple[PartName, int]] = [(root, 0)]
        while waiting:
            name, depth = waiting.pop()
            del trail[depth:]
            if name in trail:
                cycle = [*trail[trail.index(name) :], name]
                message = f"{name} contains itself: {' > '.join(cycle)}"
                owner = cycle[-2]
                place = (owner, "modes", DEFAULT_MODE, name)
                yield Finding("error", "CYCLE", message, owner, place)
                continue
            if name in done or name not in systems:
                continue
            trail.append(name)
            children = {part for wanted in systems[name].modes.values() for part in wanted}
            waiting.extend((child, len(trail)) for child in sorted(children))
        done.update(trail)
    return


def _ancestors(
    systems: Mapping[PartName, SystemModel], nodes: Mapping[PartName, NodeModel]
) -> dict[PartName, tuple[PartName, ...]]:
    """Return the ancestors of each part, bottom up, so that one pass over them infers them all."""
    parents: dict[PartName, list[PartName]] = {name: [] for name in (*systems, *nodes)}
    for system in systems.values():
        for part in dict.fromkeys(part for wanted in system.modes.values() for part in wanted):
            parents[part].append(system.name)
    height = _heights(systems)
    result: dict[PartName, tuple[PartName, ...]] = {}
    for name in parents:
        found: set[PartName] = set()
        waiting = list(parents[name])
        while waiting:
            parent = waiting.pop()
            if parent not in found:
                found.add(parent)
                waiting.extend(parents[parent])
        result[name] = tuple(sorted(found, key=lambda system: (height[system], system)))
    return result


def _heights(systems: Mapping[PartName, SystemModel]) -> dict[PartName, int]:
    """Return how far each system is above the nodes; a system is higher than all its parts."""
    height: dict[PartName, int] = {}
    waiting = list(systems)
    while waiting:
        name = waiting[-1]
        parts = {part for wanted in systems[name].modes.values() for part in wanted}
        missing = [part for part in parts if part in systems and part not in height]
        if missing:
            waiting.extend(missing)
            continue
        waiting.pop()
        height[name] = 1 + max((height.get(part, 0) for part in parts), default=0)
    return height
