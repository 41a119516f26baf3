"""Simulated nodes with lifecycle, parameters, durations and faults.

Deterministic and advanced like the core: the same commands and faults at the same times lead to the
same messages, whether time advances in one step or in many. Nodes work in parallel and never delay
each other.
"""

import heapq
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TypeAlias

from domain.commands import AskFacts, AskParameters, AskTransition, NodeCommand
from domain.errors import RefusedError, UnknownPartError
from domain.inputs import NodeAnswer, NodeReport
from domain.lifecycle import ERROR_PROCESSED, LifecycleState, Transition, TransitionRule, rule_for
from domain.parameters import Parameters, ParameterValue
from domain.parts.system_model import SmhModel
from domain.simulation.memory import NodeMemory, plain_nodes
from domain.simulation.node_parameters import declared_parameters, find_refusal, start_parameters
from domain.simulation.node_settings import NOTICED_AFTER, SLOWDOWN, Fault, NodeSettings
from domain.state_and_mode import PartName
from domain.timebase import Duration, Instant

NodeMessage: TypeAlias = NodeReport | NodeAnswer


@dataclass(slots=True)
class _Node:
    """The actual state of one node, and what the backend has reported about it."""

    name: PartName
    settings: NodeSettings
    declared: Parameters
    fault: Fault | None
    state: LifecycleState = LifecycleState.UNKNOWN
    parameters: dict[str, ParameterValue] = field(default_factory=dict)
    process: int = 0
    """Number of processes that ended; work of an ended process is lost."""
    parameters_free_at: Instant = 0
    """Until when it is busy with parameter sets, which it executes one after the other."""
    unreachable_at: Instant | None = None
    """When the backend will notice that the node sends nothing."""
    told_unreachable: bool = False
    known_likeness: str = ""
    """Empty: it is to be found anew."""

    @property
    def likeness(self) -> str:
        """Return the same for all nodes in the same state with the same parameters."""
        if not self.known_likeness:
            self.known_likeness = f"{self.state} {self.parameters!r}"
        return self.known_likeness

    @property
    def runs(self) -> bool:
        return self.fault is not Fault.DIE

    @property
    def speaks(self) -> bool:
        return self.fault is None or not self.fault.is_mute

    def start(self, at: Instant, memory: NodeMemory | None = None) -> None:
        """Start a process: unconfigured, with the initial parameters.

        Args:
            at: When.
            memory: Where the process is that has run on meanwhile; None: there is none.
        """
        plain = self.settings.plain
        self.state = LifecycleState.UNKNOWN if plain else LifecycleState.UNCONFIGURED
        self.parameters = start_parameters(self.declared)
        self.parameters_free_at = at
        if memory is not None:
            if not plain and memory.state is not LifecycleState.UNKNOWN:
                self.state = memory.state
            self.parameters.update(memory.parameters)

    def stop(self) -> None:
        """End the process, and with it all its work."""
        self.process += 1
        self.state = LifecycleState.UNKNOWN
        self.parameters = {}

    def takes(self, duration: Duration) -> Duration:
        """Return a nominal duration as it is with the current fault."""
        return duration * SLOWDOWN if self.fault is Fault.SLOW else duration

    def facts(self) -> NodeReport:
        """Return a complete report."""
        plain = self.settings.plain
        return NodeReport(
            self.name,
            state=None if plain else self.state,
            parameters=MappingProxyType(dict(self.parameters)),
            reachable=True,
            has_lifecycle=not plain,
        )


@dataclass(frozen=True, slots=True)
class _CallbackEnds:
    node: _Node
    process: int
    rule: TransitionRule


@dataclass(frozen=True, slots=True)
class _ErrorIsProcessed:
    node: _Node
    process: int


@dataclass(frozen=True, slots=True)
class _ParametersAreSet:
    node: _Node
    process: int
    request: int
    values: Parameters


@dataclass(frozen=True, slots=True)
class _SilenceIsNoticed:
    node: _Node
    at: Instant


_NO_MEMORY: Mapping[PartName, NodeMemory] = MappingProxyType({})
_Work: TypeAlias = _CallbackEnds | _ErrorIsProcessed | _ParametersAreSet | _SilenceIsNoticed


class SimulatedNodes:
    """All nodes of a model, and which of them the backend can reach.

    Without a memory, each starts unconfigured, with every parameter that its modes set, at `0`,
    `0.0`, `False` or `"none"`. `now` must never decrease from call to call.

    A legal transition is accepted at once, reported as the transitional state, and after its
    duration as the resulting state; any other is rejected. Parameter sets are atomic, and are
    answered and reported when they are done.

    Raises:
        UnknownPartError: There are settings of a node that the model does not have.
    """

    def __init__(
        self,
        model: SmhModel,
        settings: Mapping[PartName, NodeSettings],
        start: Instant,
        memory: Mapping[PartName, NodeMemory] = _NO_MEMORY,
    ) -> None:
        """Begin at `start`, each node where it is remembered, or else unconfigured."""
        self._nodes: dict[PartName, _Node] = {}
        self._systems = frozenset(model.systems)
        self._due: list[tuple[Instant, int, _Work]] = []
        self._issues = 0
        self._messages: list[NodeMessage] = []
        self._messages_at = start
        self.revision = 0
        """Differs when `memory` does."""
        for name in settings:
            if name not in model.nodes:
                raise UnknownPartError("node", name, tuple(model.nodes))
        for name, node_model in model.nodes.items():
            own = settings.get(name, _USUAL)
            node = _Node(name, own, declared_parameters(node_model), own.fault)
            self._nodes[name] = node
            if node.runs:
                node.start(start, memory.get(name))
            self._appear(node, start)

    def handle(self, command: NodeCommand, now: Instant) -> None:
        """Accept a command for a node; `advance` returns what follows."""
        self._catch_up(now)
        node = self._nodes.get(command.node)
        if node is None:
            self._refuse(command, "there is no such node", now)
        elif not node.runs:
            # Until its death is noticed, a dead node is one that has not answered yet.
            if node.told_unreachable:
                self._refuse(command, "not reachable", now)
        else:
            self._hear(node, command, now)

    def advance(self, now: Instant) -> tuple[NodeMessage, ...]:
        """Return all messages due up to `now`, in order of time, then in order of issue."""
        self._catch_up(now)
        messages, self._messages = tuple(self._messages), []
        return messages

    def wake_at(self) -> Instant | None:
        """Return when something is due next, even if a silent node sends no message then.

        None: nothing is due until the next command.
        """
        if self._messages:
            return self._messages_at
        while self._due and _is_void(self._due[0][2]):
            heapq.heappop(self._due)
        return self._due[0][0] if self._due else None

    def set_fault(self, node: PartName, fault: Fault | None, now: Instant) -> None:
        """Set the fault of a node; None removes it.

        Work in progress keeps its duration. A node that can send again sends a complete report.

        Raises:
            UnknownPartError: There is no such node.
        """
        self._catch_up(now)
        it = self._require(node)
        self._touch(it)
        before, it.fault = it.fault, fault
        if fault is Fault.DIE:
            it.stop()
        elif before is Fault.DIE:
            it.start(now)
        if not it.speaks or (before is not None and before.is_mute):
            self._appear(it, now)

    def set_parameters(self, node: PartName, values: Parameters, now: Instant) -> None:
        """Set parameters of a node from outside, atomically and at once.

        Raises:
            UnknownPartError: There is no such node.
            UnknownParameterError: It has no such parameter.
            InvalidValueError: A value has the wrong type.
            RefusedError: The node is not running.
        """
        self._catch_up(now)
        it = self._require(node)
        if not it.runs:
            raise RefusedError(f"{node} is not running")
        refusal = find_refusal(it.declared, values)
        if refusal is not None:
            raise refusal
        self._take_over(it, values, now)

    def faults(self) -> dict[PartName, Fault | None]:
        """Return all nodes with their faults; None: it has none."""
        return {name: node.fault for name, node in self._nodes.items()}

    @property
    def count(self) -> int:
        """Return how many nodes there are."""
        return len(self._nodes)

    def state_of(self, node: PartName) -> LifecycleState:
        """Return the actual state of a node; `unknown` without a process or a lifecycle.

        Raises:
            UnknownPartError: There is no such node.
        """
        return self._require(node).state

    def parameters_of(self, node: PartName) -> Parameters:
        """Return the actual parameters of a node; empty while it is not running.

        Raises:
            UnknownPartError: There is no such node.
        """
        return dict(self._require(node).parameters)

    def memory(self) -> list[dict[str, object]]:
        """Return where the running nodes are, as plain values: those that are in the same together.

        A parameter set in progress is not part of it: nobody was told that it was done.
        """
        groups: dict[str, list[PartName]] = {}
        for name, node in self._nodes.items():
            if node.runs:
                groups.setdefault(node.likeness, []).append(name)
        alike = ((self._nodes[names[0]], names) for names in groups.values())
        return [plain_nodes(node.state, node.parameters, names) for node, names in alike]

    def _require(self, name: PartName) -> _Node:
        if name in self._systems:
            raise UnknownPartError.of_other_kind(name, "node")
        if name not in self._nodes:
            raise UnknownPartError("node", name, tuple(self._nodes))
        return self._nodes[name]

    # --- what comes out --------------------------------------------------------------------------

    def _emit(self, message: NodeMessage, at: Instant) -> None:
        self._messages.append(message)
        self._messages_at = at

    def _say(self, node: _Node, message: NodeMessage, at: Instant) -> None:
        """Send a message of a node, unless a fault keeps it from sending."""
        if node.speaks:
            self._emit(message, at)

    def _refuse(self, command: NodeCommand, reason: str, at: Instant) -> None:
        self._emit(NodeAnswer(command.request, command.node, False, reason), at)

    def _appear(self, node: _Node, at: Instant) -> None:
        """Send a complete report of a node that can send, or schedule the notice of its silence."""
        if node.speaks:
            node.unreachable_at = None
            node.told_unreachable = False
            self._emit(node.facts(), at)
        elif node.fault is not None and not node.told_unreachable:
            noticed = at + NOTICED_AFTER[node.fault]
            # A node that was silent before it died is noticed at the earlier of both times.
            if node.unreachable_at is None or noticed < node.unreachable_at:
                node.unreachable_at = noticed
                self._schedule(_SilenceIsNoticed(node, noticed), noticed)

    # --- what nodes do ---------------------------------------------------------------------------

    def _hear(self, node: _Node, command: NodeCommand, now: Instant) -> None:
        """Let a running node execute a command."""
        match command:
            case AskFacts():
                self._say(node, node.facts(), now)
            case AskTransition():
                self._begin_transition(node, command, now)
            case AskParameters():
                self._begin_parameters(node, command, now)

    def _begin_transition(self, node: _Node, ask: AskTransition, now: Instant) -> None:
        rule = rule_for(node.state, ask.transition)
        reason = _why_no_transition(node, ask.transition, rule)
        self._say(node, NodeAnswer(ask.request, node.name, not reason, reason), now)
        if rule is None or reason:
            return
        self._enter(node, rule.via, now)
        ends = now + node.takes(node.settings.time_of(ask.transition))
        self._schedule(_CallbackEnds(node, node.process, rule), ends)

    def _begin_parameters(self, node: _Node, ask: AskParameters, now: Instant) -> None:
        if node.fault is Fault.REFUSE:
            self._say(node, NodeAnswer(ask.request, node.name, False, _REFUSES), now)
            return
        refusal = find_refusal(node.declared, ask.values)
        if refusal is not None:
            self._say(node, NodeAnswer(ask.request, node.name, False, refusal.message), now)
            return
        began = max(now, node.parameters_free_at)
        node.parameters_free_at = began + node.takes(node.settings.set_parameters)
        work = _ParametersAreSet(node, node.process, ask.request, dict(ask.values))
        self._schedule(work, node.parameters_free_at)

    def _end_callback(self, node: _Node, rule: TransitionRule, at: Instant) -> None:
        if node.fault is Fault.ERROR:
            self._enter(node, LifecycleState.ERROR_PROCESSING, at)
            processed = at + node.settings.process_error
            self._schedule(_ErrorIsProcessed(node, node.process), processed)
        else:
            self._enter(node, rule.failure if node.fault is Fault.FAIL else rule.success, at)

    def _touch(self, node: _Node) -> None:
        """Note that there is something new to remember of a node."""
        self.revision += 1
        node.known_likeness = ""

    def _enter(self, node: _Node, state: LifecycleState, at: Instant) -> None:
        node.state = state
        self._touch(node)
        self._say(node, NodeReport(node.name, state=state), at)

    def _take_over(self, node: _Node, values: Parameters, at: Instant) -> None:
        node.parameters.update(values)
        self._touch(node)
        # All values of the request, changed or not, as in ROS 2 parameter events.
        self._say(node, NodeReport(node.name, parameters=MappingProxyType(dict(values))), at)

    # --- time ------------------------------------------------------------------------------------

    def _schedule(self, work: _Work, at: Instant) -> None:
        self._issues += 1
        heapq.heappush(self._due, (at, self._issues, work))

    def _catch_up(self, now: Instant) -> None:
        """Do all work due up to `now`, each at its own time."""
        while self._due and self._due[0][0] <= now:
            at, _, work = heapq.heappop(self._due)
            if not _is_void(work):
                self._do(work, at)

    def _do(self, work: _Work, at: Instant) -> None:
        match work:
            case _CallbackEnds(node, _, rule):
                self._end_callback(node, rule, at)
            case _ErrorIsProcessed(node):
                self._enter(node, ERROR_PROCESSED, at)
            case _ParametersAreSet(node, _, request, values):
                self._say(node, NodeAnswer(request, node.name, True), at)
                self._take_over(node, values, at)
            case _SilenceIsNoticed(node):
                node.unreachable_at = None
                node.told_unreachable = True
                self._emit(NodeReport(node.name, reachable=False), at)


_USUAL = NodeSettings()
_REFUSES = "the node rejects it"


def _why_no_transition(node: _Node, transition: Transition, rule: TransitionRule | None) -> str:
    """Return why a node rejects a transition; empty: it accepts it."""
    if node.settings.plain:
        return "the node has no lifecycle"
    if rule is None:
        return f"the node is {node.state}: it cannot {transition}"
    return _REFUSES if node.fault is Fault.REFUSE else ""


def _is_void(work: _Work) -> bool:
    """Tell whether work is void: its process ended, or its node sends again."""
    if isinstance(work, _SilenceIsNoticed):
        return work.node.unreachable_at != work.at
    return work.node.process != work.process
