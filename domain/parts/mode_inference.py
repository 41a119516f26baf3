"""Infers states and modes of systems and nodes from the reports of nodes.

A system is virtual and reports nothing: its state is inferred from its parts and its target. A
report affects only the systems that its node belongs to.

Source: micro-ROS deliverable D4.8, section 4.1.2; micro-ROS system_modes, `mode_inference.cpp`,
whose order of evaluation is kept: parts and modes by byte order of their names, the target mode
first, then `__DEFAULT__`. Intended differences: a state is never inferred from parameters or from a
reported mode, and an undecidable state is a result with a reason (docs/conformance.md).
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from domain.errors import UnknownPartError
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parameters import same_value
from domain.parts.node_facts import NodeFacts
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.snapshot import Actual
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from domain.timebase import Instant

Wanted: TypeAlias = tuple[tuple[PartName, LifecycleState, ModeName | None], ...]
"""State and mode that one mode requires of each part, in order of evaluation."""

_AT_REST = (LifecycleState.INACTIVE, LifecycleState.UNCONFIGURED)
_ON_THE_WAY = {
    LifecycleState.UNCONFIGURED: LifecycleState.CLEANING_UP,
    LifecycleState.FINALIZED: LifecycleState.SHUTTING_DOWN,
}
_ERROR = Actual(LifecycleState.ERROR_PROCESSING, inferred=True)
_DEACTIVATING = Actual(LifecycleState.DEACTIVATING, inferred=True)


def _by_bytes(name: str) -> bytes:
    return name.encode()


@dataclass(frozen=True, slots=True)
class _SystemPlan:
    """A system with parts and modes in order of evaluation."""

    parts: tuple[PartName, ...]
    own: dict[ModeName, Wanted]
    """Requirements of each mode on the parts that it names; used for the target mode."""
    modes: tuple[tuple[ModeName, Wanted], ...]
    """All modes by byte order, each restricted to the parts of `__DEFAULT__`."""

    @classmethod
    def of(cls, system: SystemModel) -> "_SystemPlan":
        """Sort `system`."""
        parts = tuple(sorted(system.parts, key=_by_bytes))
        own = {
            mode: tuple(
                (part, wanted[part].state, wanted[part].mode)
                for part in sorted(wanted, key=_by_bytes)
            )
            for mode, wanted in system.modes.items()
        }
        modes = tuple(
            (mode, tuple(line for line in own[mode] if line[0] in system.modes[DEFAULT_MODE]))
            for mode in sorted(own, key=_by_bytes)
        )
        return cls(parts, own, modes)


def _is_there(actual: StateAndMode, target: StateAndMode) -> bool:
    if actual.state is not target.state:
        return False
    if target.state is not LifecycleState.ACTIVE or target.mode is None:
        return True
    return actual.mode == target.mode


class _UndecidableError(Exception):
    """Too little is known about a part; never leaves this module."""


class ModeInference:
    """Facts and targets of all parts, and the states inferred from them, kept up to date."""

    def __init__(self, model: SmhModel) -> None:
        self.model = model
        self._facts = {name: NodeFacts() for name in model.nodes}
        self._targets: dict[PartName, StateAndMode] = {}
        self._plans = {name: _SystemPlan.of(system) for name, system in model.systems.items()}
        self._by_rank = {
            name: sorted(node.modes, key=lambda mode: (mode != DEFAULT_MODE, _by_bytes(mode)))
            for name, node in model.nodes.items()
        }
        self._has_lists = {
            name: any(isinstance(v, tuple) for mode in node.modes.values() for v in mode.values())
            for name, node in model.nodes.items()
        }
        self._plain: set[PartName] = set()
        """Nodes without a lifecycle."""
        self._actual: dict[PartName, Actual] = {}
        for node in model.nodes:
            self._actual[node] = self._infer_node(node)
        self._depth = {name: len(model.ancestors[name]) for name in model.systems}
        for system in sorted(model.systems, key=self._depth.__getitem__, reverse=True):
            self._actual[system] = self._infer_system(system)

    def report(self, report: NodeReport, now: Instant | None = None) -> set[PartName]:
        """Process a report; return the parts whose actual state or mode changed.

        Args:
            report: From a node.
            now: When it arrived; None: not relevant, as for posted facts.

        Raises:
            UnknownPartError: The node is not in the model.
        """
        facts = self.facts_of(report.node)
        is_different = facts.take(report, now)
        (self._plain.discard if facts.has_lifecycle else self._plain.add)(report.node)
        return self._infer((report.node,)) if is_different else set()

    def set_targets(self, targets: Mapping[PartName, StateAndMode | None]) -> set[PartName]:
        """Set the targets in force; return the parts whose actual state or mode changed.

        Raises:
            UnknownPartError: A part is not in the model; no target was set.
        """
        for part in targets:
            if part not in self.model:
                raise UnknownPartError("part", part, self.model.parts)
        for part, target in targets.items():
            if target is None:
                self._targets.pop(part, None)
            else:
                self._targets[part] = target
        return self._infer(targets)

    def target(self, part: PartName) -> StateAndMode | None:
        """Return the target in force of a part; None: it has none."""
        return self._targets.get(part)

    def actual(self, part: PartName) -> Actual:
        """Return the actual state and mode of a part."""
        return self._actual[part]

    @property
    def facts(self) -> Mapping[PartName, NodeFacts]:
        """Return the facts about each node; read only."""
        return self._facts

    def facts_of(self, node: PartName) -> NodeFacts:
        """Return the facts about a node.

        Raises:
            UnknownPartError: The node is not in the model.
        """
        facts = self._facts.get(node)
        if facts is None:
            raise UnknownPartError("node", node, tuple(self._facts))
        return facts

    def as_seen(self, part: PartName) -> StateAndMode | None:
        """Return state and mode of a part as its parents see it; None: undecidable.

        Only an active part has a mode.
        """
        actual = self._actual[part]
        if actual.state is LifecycleState.UNKNOWN:
            return None
        if actual.state is LifecycleState.ACTIVE:
            return actual.state_and_mode
        return StateAndMode(actual.state)

    def converged(self, part: PartName) -> bool:
        """Tell whether a part is in its target state and mode, or has no target.

        An active part with an unknown mode does not count as in `__DEFAULT__`.
        """
        target = self._targets.get(part)
        return target is None or _is_there(self._actual[part].state_and_mode, target)

    def deviations(self) -> list[tuple[PartName, StateAndMode, StateAndMode]]:
        """Return part, target and actual of each decidable part that deviates from its target."""
        found = []
        for part in sorted(self._targets, key=_by_bytes):
            seen = self.as_seen(part)
            if seen is not None and not _is_there(seen, self._targets[part]):
                found.append((part, self._targets[part], seen))
        return found

    def _infer(self, parts: Iterable[PartName]) -> set[PartName]:
        """Infer parts and, bottom-up, every system above them, each once."""
        nodes = [part for part in parts if part in self._facts]
        systems = {part for part in parts if part not in self._facts}
        for part in parts:
            systems.update(self.model.ancestors[part])
        changed = {name for name in nodes if self._renew(name, self._infer_node(name))}
        for name in sorted(systems, key=self._depth.__getitem__, reverse=True):
            if self._renew(name, self._infer_system(name)):
                changed.add(name)
        return changed

    def _renew(self, part: PartName, actual: Actual) -> bool:
        if actual == self._actual[part]:
            return False
        self._actual[part] = actual
        return True

    # --- nodes -----------------------------------------------------------------------------------

    def _infer_node(self, name: PartName) -> Actual:
        """Return the reported state and, if active, the reported or else a matching mode."""
        facts = self._facts[name]
        state = facts.known_state
        if state is LifecycleState.UNKNOWN:
            return Actual(state, reason=f"{name} {facts.why_unknown}")
        if state is not LifecycleState.ACTIVE:
            return Actual(state)
        if facts.mode is not None:
            return Actual(state, facts.mode)
        mode = self._matching_mode(name)
        if mode is None:
            reason = f"the parameters of {name} match no mode" if self._by_rank[name] else None
            return Actual(state, reason=reason)
        return Actual(state, mode, mode_inferred=True)

    def _matching_mode(self, name: PartName) -> ModeName | None:
        """Return the mode that a node's parameters match: target mode first, then `__DEFAULT__`.

        The target mode is matched on all types of values. As in system_modes, other modes are not
        inferred if the node has list parameters.
        """
        node = self.model.nodes[name]
        target = self._targets.get(name)
        asked = target.mode if target is not None else None
        if asked is not None and asked in node.modes and self._matches(node, asked):
            return asked
        for mode in self._by_rank[name]:
            if self._matches(node, mode) and not self._has_lists[name]:
                return mode
        return None

    def _matches(self, node: NodeModel, mode: ModeName) -> bool:
        known = self._facts[node.name].parameters
        return all(
            name in known and same_value(known[name], value)
            for name, value in node.modes[mode].items()
        )

    # --- systems ---------------------------------------------------------------------------------

    def _infer_system(self, name: PartName) -> Actual:
        try:
            return self._decide(name, self._targets.get(name))
        except _UndecidableError as undecidable:
            return Actual(
                LifecycleState.UNKNOWN, inferred=True, undecidable=True, reason=str(undecidable)
            )

    def _decide(self, name: PartName, target: StateAndMode | None) -> Actual:
        """Select the rule by the target of the system."""
        plan = self._plans[name]
        if target is None:
            return self._common_state(plan.parts)
        if target.state is LifecycleState.INACTIVE:
            return self._towards_inactive(plan.parts)
        if target.state is LifecycleState.ACTIVE:
            return self._towards_active(plan, target.mode)
        if target.state in _ON_THE_WAY:
            return self._towards_rest(plan.parts, target.state)
        raise _UndecidableError(f"{target.state} cannot be the target of a system")

    def _state_of(self, part: PartName) -> LifecycleState:
        """Return the state of a part.

        Raises:
            _UndecidableError: It is unknown; the message is the innermost reason.
        """
        actual = self._actual[part]
        if actual.state is LifecycleState.UNKNOWN:
            raise _UndecidableError(actual.reason or f"{part} is unknown")
        return actual.state

    def _common_state(self, parts: tuple[PartName, ...]) -> Actual:
        """Without a target: the state that all parts have in common, without a mode."""
        common: LifecycleState | None = None
        parts = self._with_lifecycle(parts) or parts
        first = parts[0] if parts else None
        for part in parts:
            state = self._state_of(part)
            if state is LifecycleState.ERROR_PROCESSING:
                return _ERROR
            if common is None:
                common = state
            elif common is not state:
                raise _UndecidableError(
                    f"there is no target, and {first} is {common} while {part} is {state}"
                )
        return Actual(common or LifecycleState.UNKNOWN, inferred=True)

    def _with_lifecycle(self, parts: tuple[PartName, ...]) -> tuple[PartName, ...]:
        """Return the parts that decide whether a system is at rest: no plain nodes that are known.

        A plain node is always active, and would keep its system from ever being at rest.
        """
        if not self._plain:
            return parts
        return tuple(
            part
            for part in parts
            if part not in self._plain or self._actual[part].state is LifecycleState.UNKNOWN
        )

    def _towards_inactive(self, parts: tuple[PartName, ...]) -> Actual:
        for part in self._with_lifecycle(parts):
            state = self._state_of(part)
            if state is LifecycleState.ERROR_PROCESSING:
                return _ERROR
            if state not in _AT_REST:
                return _DEACTIVATING
        return Actual(LifecycleState.INACTIVE, inferred=True)

    def _towards_rest(self, parts: tuple[PartName, ...], goal: LifecycleState) -> Actual:
        """Towards `unconfigured` or `finalized`: reached when all parts have reached it."""
        arrived = True
        for part in self._with_lifecycle(parts):
            state = self._state_of(part)
            if state is LifecycleState.ERROR_PROCESSING:
                return _ERROR
            arrived = arrived and state is goal
        return Actual(goal if arrived else _ON_THE_WAY[goal], inferred=True)

    def _towards_active(self, plan: _SystemPlan, target: ModeName | None) -> Actual:
        """Active once all parts satisfy the target mode; until then activating.

        While activating, the mode is the one that all parts match at the moment, if any.
        """
        wanted = plan.own.get(target) if target is not None else None
        if wanted is not None:
            satisfied = True
            for part, state, mode in wanted:
                actual = self._state_of(part)
                if actual is LifecycleState.ERROR_PROCESSING:
                    return _ERROR
                if not self._satisfies(part, state, mode) and not (
                    state is LifecycleState.INACTIVE and actual is LifecycleState.UNCONFIGURED
                ):
                    satisfied = False
            if satisfied:
                return Actual(LifecycleState.ACTIVE, target, inferred=True, mode_inferred=True)
        for part in plan.parts:
            if self._state_of(part) is LifecycleState.ERROR_PROCESSING:
                return _ERROR
        for name, lines in plan.modes:
            if all(self._satisfies(part, state, mode) for part, state, mode in lines):
                return Actual(LifecycleState.ACTIVATING, name, inferred=True, mode_inferred=True)
        return Actual(LifecycleState.ACTIVATING, inferred=True)

    def _satisfies(self, part: PartName, state: LifecycleState, mode: ModeName | None) -> bool:
        """Tell whether a part is in exactly `state` and, if active, in `mode`."""
        actual = self._actual[part]
        if actual.state is not state:
            return False
        return state is not LifecycleState.ACTIVE or actual.mode == mode
