"""Infers states and modes of systems and nodes from the reports of nodes.

A system is virtual and reports nothing: its state is inferred from its parts and its target. A
report affects only the systems that its node belongs to.

Source: micro-ROS deliverable D4.8, section 4.1.2; micro-ROS system_modes, `mode_inference.cpp`,
whose order of evaluation is kept: parts and modes by byte order of their names, the target mode
first, then `__DEFAULT__`. Intended differences: a state is never inferred from parameters or from a
reported mode, and an undecidable state is a result with a reason (docs/conformance.md).
"""

from collections.abc import Iterable, Mapping
from heapq import heapify, heappop, heappush

from domain.errors import UnknownPartError
from domain.findings import Blocker
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parameters import same_value
from domain.parts.convergence import Convergence, bottom_up, is_there
from domain.parts.node_doubts import IN_DOUBT
from domain.parts.node_facts import NodeFacts
from domain.parts.system_inference import SystemInference, by_bytes
from domain.parts.system_model import NodeModel, SmhModel
from domain.snapshot import Actual
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from domain.timebase import Instant


class ModeInference:
    """Facts and targets of all parts, and the states inferred from them, kept up to date."""

    def __init__(self, model: SmhModel) -> None:
        self.model = model
        self._facts = {name: NodeFacts() for name in model.nodes}
        self._targets: dict[PartName, StateAndMode] = {}
        self._systems = {name: SystemInference(system) for name, system in model.systems.items()}
        self._parents = model.parents
        self._by_rank = {
            name: sorted(node.modes, key=lambda mode: (mode != DEFAULT_MODE, by_bytes(mode)))
            for name, node in model.nodes.items()
        }
        self._has_lists = {
            name: any(isinstance(v, tuple) for mode in node.modes.values() for v in mode.values())
            for name, node in model.nodes.items()
        }
        self._fitting: dict[PartName, tuple[ModeName, ...]] = {}
        """Modes that the parameters of an active node match; kept until it reports others."""
        self.doubtful: set[PartName] = set()
        """Nodes in a state that is unknown, or that they do not leave; read only for others."""
        self._moved: set[PartName] = set()
        """Parts of which the actual changed since somebody asked for them."""
        self._wavering: set[PartName] = set()
        """Nodes whose mode depends on their target, since their parameters match several."""
        self._shared: dict[tuple[LifecycleState, ModeName | None, bool], Actual] = {}
        """One object for all nodes in the same state and mode: fewer for Python to look through."""
        self._plain: set[PartName] = set()
        """Nodes without a lifecycle."""
        self._bottom_up = bottom_up(model)
        """Systems, each after all below it: that is the order in which they are inferred."""
        self._rank = {name: rank for rank, name in enumerate(self._bottom_up)}
        self._actual = dict.fromkeys(model.parts, Actual(LifecycleState.UNKNOWN))
        self._convergence = Convergence(
            model, self._parents, self._targets, self._actual, self._plain
        )
        self.doubtful.update(model.nodes)
        self._infer((*model.nodes, *model.systems))

    def report(self, report: NodeReport, now: Instant | None = None) -> set[PartName]:
        """Process a report; return the parts whose actual, `converged` or deviation reason changed.

        Args:
            report: From a node.
            now: When it arrived; None: not relevant, as for posted facts.

        Raises:
            UnknownPartError: The node is not in the model.
        """
        facts = self.facts_of(report.node)
        is_different = facts.take(report, now)
        if not is_different:
            return set()
        node = report.node
        if report.parameters:
            self._fitting.pop(node, None)
            self._wavering.discard(node)
        if facts.has_lifecycle is not (node in self._plain):
            changed = self._infer((node,))
        else:
            # Its parents judge a node with a lifecycle and one without differently.
            (self._plain.discard if facts.has_lifecycle else self._plain.add)(node)
            self._tell_parents(node)
            changed = self._infer((node, *self._parents.get(node, ())))
        return changed | self._convergence.renew({*changed, node})

    def note_cut_off(self, nodes: Iterable[PartName], why: Blocker | None) -> set[PartName]:
        """Note why nothing is heard of nodes; return the parts of which that changed what is told.

        Args:
            nodes: Of one device.
            why: Why it is not connected; None: it is.
        """
        facts = self._facts
        changed = [node for node in nodes if facts[node].cut_off != why]
        for node in changed:
            facts[node].cut_off = why
        unknown = [n for n in changed if facts[n].known_state is LifecycleState.UNKNOWN]
        renewed = self._infer(unknown)
        return renewed | self._convergence.renew(renewed)

    def set_targets(self, targets: Mapping[PartName, StateAndMode | None]) -> set[PartName]:
        """Set the targets in force; return the parts of which that changed anything.

        Raises:
            UnknownPartError: A part is not in the model; no target was set.
        """
        # In bulk where it can be: there may be ten thousand.
        if not targets.keys() <= self._actual.keys():
            unknown = min(targets.keys() - self._actual.keys())
            raise UnknownPartError("part", unknown, self.model.parts)
        self._targets.update(targets)  # type: ignore[arg-type]  # those without are taken out next
        for part in [part for part, target in targets.items() if target is None]:
            del self._targets[part]
        nodes = targets.keys() & self._wavering if self._wavering else ()
        changed = self._infer((*nodes, *(targets.keys() & self._systems.keys())))
        # In the order of the targets: in that of a set, what belongs together is far apart.
        renewed = self._convergence.renew((*targets, *(changed - targets.keys())))
        return changed | renewed

    def target(self, part: PartName) -> StateAndMode | None:
        """Return the target in force of a part; None: it has none."""
        return self._targets.get(part)

    def actual(self, part: PartName) -> Actual:
        """Return the actual state and mode of a part."""
        return self._actual[part]

    @property
    def actuals(self) -> Mapping[PartName, Actual]:
        """Return the actual state and mode of each part; read only."""
        return self._actual

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

    def last_known(self, node: PartName) -> StateAndMode | None:
        """Return what was known last of a node that is unreachable; None: it is not, or nothing."""
        facts = self._facts[node]
        if facts.reachable is not False or facts.state is None:
            return None
        if facts.state is not LifecycleState.ACTIVE:
            return StateAndMode(facts.state)
        return StateAndMode(facts.state, facts.mode or self._matching_mode(node))

    def converged(self, part: PartName) -> bool:
        """Tell whether a part is in its target state and mode, or has no target, and so its parts.

        An active part with an unknown mode does not count as in `__DEFAULT__`.
        """
        return self._convergence.converged(part)

    def deviation_cause(self, part: PartName) -> PartName | None:
        """Return the part that is not where its target says: this one or one below; None: none."""
        return self._convergence.cause(part)

    def deviation_reason(self, part: PartName) -> str | None:
        """Return which part is not where its target says; None: the part has converged."""
        return self._convergence.reason(part)

    def deviations(self) -> list[tuple[PartName, StateAndMode, StateAndMode]]:
        """Return part, target and actual of each decidable part that deviates from its own target.

        As in system_modes: what the parts of a system deviate from is told of these parts only.
        """
        found = []
        for part in sorted(self._targets, key=by_bytes):
            seen = self.as_seen(part)
            if seen is not None and not is_there(seen, self._targets[part]):
                found.append((part, self._targets[part], seen))
        return found

    def take_moved(self) -> set[PartName]:
        """Return the parts of which the actual changed since the last call."""
        moved, self._moved = self._moved, set()
        return moved

    def _infer(self, parts: Iterable[PartName]) -> set[PartName]:
        """Infer parts, and bottom-up the systems above those that changed, each once."""
        changed: set[PartName] = set()
        waiting: set[PartName] = set()
        for part in parts:
            if part not in self._facts:
                waiting.add(part)
            elif self._renew(part, self._infer_node(part)):
                changed.add(part)
                is_in_doubt = self._actual[part].state in IN_DOUBT
                (self.doubtful.add if is_in_doubt else self.doubtful.discard)(part)
                waiting.update(self._parents.get(part, ()))
        if not waiting:
            return changed
        order = [self._rank[name] for name in waiting]
        heapify(order)
        while order:
            name = self._bottom_up[heappop(order)]
            if not self._renew(name, self._systems[name].infer(self._targets.get(name))):
                continue
            changed.add(name)
            for parent in self._parents.get(name, ()):
                if parent not in waiting:
                    waiting.add(parent)
                    heappush(order, self._rank[parent])
        return changed

    def _renew(self, part: PartName, actual: Actual) -> bool:
        """Take over the actual of a part; return whether it changed."""
        known = self._actual[part]
        if actual is known or actual == known:
            return False
        self._actual[part] = actual
        self._moved.add(part)
        self._tell_parents(part)
        return True

    def _tell_parents(self, part: PartName) -> None:
        for parent in self._parents.get(part, ()):
            self._systems[parent].note(part, self._actual[part], plain=part in self._plain)

    # --- nodes -----------------------------------------------------------------------------------

    def _infer_node(self, name: PartName) -> Actual:
        """Return the reported state and, if active, the reported or else a matching mode."""
        facts = self._facts[name]
        state = facts.known_state
        if state is LifecycleState.UNKNOWN:
            return Actual(state, reason=f"{name} {facts.why_unknown}")
        if state is not LifecycleState.ACTIVE:
            return self._share(state)
        if facts.mode is not None:
            known = facts.mode in self.model.nodes[name].modes
            return self._share(state, facts.mode) if known else Actual(state, facts.mode)
        mode = self._matching_mode(name)
        if mode is not None:
            return self._share(state, mode, mode_inferred=True)
        if self._by_rank[name]:
            return Actual(state, reason=f"the parameters of {name} match no mode")
        return self._share(state)

    def _share(
        self, state: LifecycleState, mode: ModeName | None = None, *, mode_inferred: bool = False
    ) -> Actual:
        key = (state, mode, mode_inferred)
        shared = self._shared.get(key)
        if shared is None:
            shared = self._shared[key] = Actual(state, mode, mode_inferred=mode_inferred)
        return shared

    def _matching_mode(self, name: PartName) -> ModeName | None:
        """Return the mode that a node's parameters match: target mode first, then `__DEFAULT__`.

        The target mode is matched on all types of values. As in system_modes, other modes are not
        inferred if the node has list parameters.
        """
        fitting = self._fitting.get(name)
        if fitting is None:
            fitting = self._fitting[name] = self._find_fitting(name)
        if not fitting:
            return None
        target = self._targets.get(name)
        asked = target.mode if target is not None else None
        if asked is not None and asked in fitting:
            return asked
        return None if self._has_lists[name] else fitting[0]

    def _find_fitting(self, name: PartName) -> tuple[ModeName, ...]:
        """Return the modes that a node's parameters match, `__DEFAULT__` first."""
        node = self.model.nodes[name]
        fitting = tuple(mode for mode in self._by_rank[name] if self._matches(node, mode))
        if len(fitting) > 1 or (fitting and self._has_lists[name]):
            self._wavering.add(name)
        return fitting

    def _matches(self, node: NodeModel, mode: ModeName) -> bool:
        known = self._facts[node.name].parameters
        # A plain loop: a generator costs as much as the comparison, and there may be 10,000 nodes.
        for name, value in node.modes[mode].items():
            if name not in known or not same_value(known[name], value):
                return False
        return True
