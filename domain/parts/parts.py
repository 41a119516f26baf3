"""The parts as a concern of the core: reports of nodes, inferred states and targets."""

from collections.abc import Collection, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass
from itertools import islice
from types import MappingProxyType

from domain.actor import Actor
from domain.computers import ComputerName
from domain.concern import Concern, Takers
from domain.events.parts import (
    DeviationBegan,
    DeviationEnded,
    NodeReachable,
    NodeReported,
    NodeUnreachable,
    PartActualChanged,
)
from domain.findings import Blocker
from domain.identifiers import ChangeId
from domain.inputs import NodeReport, Restored
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parameters import check_values
from domain.parts.claims import Claims
from domain.parts.convergence import is_there
from domain.parts.deviations import Deviations
from domain.parts.mode_inference import ModeInference
from domain.parts.node_facts import NodeFacts
from domain.parts.reachability import Reachability
from domain.parts.system_model import SmhModel
from domain.parts.targets import Displacement, Targets
from domain.parts.waiting_parts import WaitingParts
from domain.snapshot import Actual, Because, ParameterView, PartView
from domain.state_and_mode import DEFAULT_MODE, PartName, StateAndMode
from domain.timebase import Instant

LOOKS_AT_ONCE = 100
"""Parts whose states and deviations one turn tells. What a request of a large robot changed is told
in several later ones, in the order of the parts, before anything else of the request goes on."""

_UNKNOWN = Actual(LifecycleState.UNKNOWN)


@dataclass(frozen=True, slots=True)
class _Cause:
    """The input that may have changed parts, or made them deviate."""

    event: int
    actor: Actor
    at: Instant


class Parts(Concern):
    """All parts: facts, inference, targets, deviations and their events."""

    def __init__(
        self,
        model: SmhModel,
        outbox: Outbox,
        devices: Mapping[PartName, ComputerName] = MappingProxyType({}),
    ) -> None:
        """Begin with all nodes unknown.

        Args:
            model: Systems and nodes.
            outbox: Receives events.
            devices: By node that another computer owns, that computer.
        """
        self.model = model
        self._devices = devices
        self.awaits_devices = False
        """Whether nodes may yet be heard of as each start begins: nothing is concluded from what is
        not known until then. Read only for others."""
        self.inference = ModeInference(model)
        """Read only for others."""
        self._targets = Targets(self.inference)
        self.claims = Claims(self.inference)
        """What reactions claim; they set it, and requests are judged by it."""
        self._deviations = Deviations(self.inference)
        self._reachability = Reachability(model)
        self._waiting = WaitingParts(model)
        self._outbox = outbox
        self._told: dict[PartName, Actual] = {}
        self._touched: set[PartName] = set()
        """Parts about which something changed since the last `settle`."""
        self._moved: set[PartName] = set()
        """Those of them whose actual or target changed, so that a deviation may begin or end."""
        self._changed: set[PartName] = set()
        """Parts whose view changed since `take_changed` was called last."""
        self._untold: set[PartName] = set()
        """Those of them whose actual may differ from the published one."""
        self._to_look: dict[PartName, _Cause] = {}
        """Parts of which is told in later turns; their views show everything already."""
        self._in_order = True
        """Whether those are in the order of their names."""
        self._views: dict[PartName, PartView] = {}
        """Cached until something about the part changes."""
        self._changes: dict[PartName, ChangeId] = {}
        self._steps: dict[PartName, int] = {}
        self.state_before = LifecycleState.UNKNOWN
        """Known state of the node of the newest report, before that report."""

    # --- what happens ----------------------------------------------------------------------------

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {Restored: self.take_restored, NodeReport: self.take_report}

    def take_restored(self, restored: Restored, now: Instant) -> None:
        """After a restart, let all parts wait for an operator."""
        if restored.is_restart:
            self._waiting.begin()

    def note_request(self, part: PartName) -> None:
        """Note that an operator requests something of a part; it and those below wait no more."""
        self._waiting.end(part)

    def waits_for_operator(self, part: PartName) -> bool:
        """Tell whether nothing may activate or restore a part by itself.

        So it is after a restart until somebody requests something of the part, or of a system that
        contains it.
        """
        return self._waiting.includes(part)

    def take_report(self, report: NodeReport, now: Instant) -> None:
        """Process a report of a node, and publish what it changed.

        Raises:
            InvalidValueError: A value is not a ROS 2 parameter value.
            UnknownPartError: The node is not in the model.
        """
        if report.parameters:
            check_values(report.parameters.values())
        facts = self.inference.facts_of(report.node)
        if self._to_look:
            self._look_late(sorted({report.node, *self.model.ancestors[report.node]}), now)
        self._outbox.begin(now, _described(report), cause=self._steps.get(report.node))
        self.state_before = facts.known_state
        changed = self.inference.report(report, now)
        self._note_reachable(report.node, reachable=bool(facts.reachable))
        self._touched |= changed
        self._moved |= changed
        self._tell_actuals(changed)

    def note_cut_off(self, nodes: Iterable[PartName], why: Blocker | None) -> None:
        """Note why nothing is heard of the nodes of a device; None: it is connected."""
        self.touch(self.inference.note_cut_off(nodes, why))

    def await_devices(self, *, wait: bool) -> None:
        """Let nothing be concluded from what is not known, or again."""
        self.awaits_devices = wait

    def ask(self, wanted: Mapping[PartName, StateAndMode | None]) -> None:
        """Set requested targets, in force at once; None: the part has none any more."""
        self._note_moved(self._targets.ask(wanted) | wanted.keys())

    def displace(self, displaced: Displacement) -> None:
        """Put another target than the requested one in force for a system."""
        self._note_moved(self._targets.displace(displaced))

    def end_displacement(self, displaced: Displacement) -> None:
        """Put what a displacement replaced in force again."""
        self._note_moved(self._targets.end(displaced))

    def let_stay(self, node: PartName, target: StateAndMode) -> bool:
        """Replace the target in force of a node; return whether it was the requested one."""
        moved, was_requested = self._targets.let_stay(node, target)
        self._note_moved(moved)
        return was_requested

    def explain(self, displaced: Displacement, blockers: tuple[Blocker, ...]) -> bool:
        """Say why a displacement is in force; return whether that was said differently before."""
        if blockers == displaced.blockers:
            return False
        displaced.blockers = blockers
        self.touch(displaced.targets)
        return True

    def put_under(self, change: ChangeId, parts: Iterable[PartName]) -> None:
        """Record that a change drives parts; it replaces an earlier one."""
        driven = dict.fromkeys(parts, change)
        self._changes.update(driven)
        self.touch(driven)

    def let_go(self, change: ChangeId, parts: Iterable[PartName]) -> None:
        """Record that a change no longer drives parts; parts of another change are not affected."""
        changes = self._changes
        driven = [part for part in parts if changes.get(part) == change]
        for part in driven:
            del changes[part]
        self.touch(driven)

    def expect_report(self, node: PartName, step: int) -> None:
        """Record the event of a node's step in flight; it becomes the cause of its reports."""
        self._steps[node] = step

    def expect_nothing(self, node: PartName) -> None:
        """Record that a node has no step in flight."""
        self._steps.pop(node, None)

    def touch(self, parts: Iterable[PartName]) -> None:
        """Mark parts as changed."""
        self._touched.update(parts)

    def settle(self, now: Instant) -> bool:
        """Publish states of changed parts, and deviations that began or ended."""
        if not self._touched:
            return False
        touched, self._touched = self._touched, set()
        self._outbox.parts |= touched
        self._changed |= touched
        if self._views:
            for part in touched:
                self._views.pop(part, None)
        moved, self._moved = self._moved, set()
        untold, self._untold = self._untold, set()
        if len(moved) > LOOKS_AT_ONCE:
            cause = _Cause(self._outbox.record_input(), self._outbox.actor, now)
            self._to_look.update(dict.fromkeys(moved, cause))
            self._in_order = False
            return True
        self._tell_actuals(untold)
        for part in sorted(moved):
            self._to_look.pop(part, None)
            self._look(part, now)
        return True

    def take_changed(self) -> set[PartName]:
        """Return the parts whose views changed since the last call, for whoever judges them."""
        changed, self._changed = self._changed, set()
        return changed

    @property
    def has_more(self) -> bool:
        """Tell whether states or deviations are still to be told."""
        return bool(self._to_look)

    def go_on(self, now: Instant) -> None:
        """Tell some more states and deviations."""
        if not self._in_order:
            self._to_look, self._in_order = dict(sorted(self._to_look.items())), True
        self._look_late(list(islice(self._to_look, LOOKS_AT_ONCE)), now)

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def facts(self) -> Mapping[PartName, NodeFacts]:
        """Return the facts about each node; read only."""
        return self.inference.facts

    def target(self, part: PartName) -> StateAndMode | None:
        """Return the target in force of a part; None: it has none."""
        return self.inference.target(part)

    def asked(self, part: PartName) -> StateAndMode | None:
        """Return the requested target of a part; None: there is none."""
        return self._targets.asked(part)

    def asked_of(self, parts: Collection[PartName]) -> dict[PartName, StateAndMode | None]:
        """Return the requested target of each of several parts."""
        return self._targets.asked_of(parts)

    @property
    def displacements(self) -> Sequence[Displacement]:
        """Return which systems are displaced, those that prevail last; read only."""
        return self._targets.displacements

    def prevails(self, displaced: Displacement) -> bool:
        """Tell whether a displacement decides the target in force of its own part."""
        return self._targets.prevails(displaced)

    def beyond(
        self, because: Because, strength: int = 0, besides: PartName | None = None
    ) -> Set[PartName]:
        """Return the parts whose targets in force nothing of this kind and strength can replace.

        Arguments are as for `Targets.beyond`.
        """
        return self._targets.beyond(because, strength, besides)

    def stays_at_rest(self, part: PartName, target: StateAndMode) -> bool:
        """Tell whether a request brought a part to rest, deeper than a target would."""
        return self._targets.stays_at_rest(part, target)

    def targets_without(self, displaced: Displacement) -> Mapping[PartName, StateAndMode]:
        """Return the targets that the end of a displacement would put in force, by part."""
        return self._targets.without(displaced)

    @property
    def driven(self) -> Set[PartName]:
        """Return the parts that a change drives; read only."""
        return self._changes.keys()

    def change_of(self, part: PartName) -> ChangeId | None:
        """Return the change that drives a part; None: there is none."""
        return self._changes.get(part)

    def view(self, part: PartName) -> PartView:
        """Return the view of a part of the model; the same object until it changes."""
        view = self._views.get(part)
        if view is None:
            view = self._views[part] = self._build(part)
        return view

    def views(self) -> Mapping[PartName, PartView]:
        """Return the views of all parts, systems first, in the order of the model file."""
        return {part: self.view(part) for part in self.model.parts}

    def parameters(self, node: PartName) -> tuple[ParameterView, ...]:
        """Return the parameters of a node, with the values that its target requires."""
        known = self.facts[node].parameters
        target = self.target(node)
        modes = self.model.nodes[node].modes
        active = target is not None and target.state is LifecycleState.ACTIVE
        wanted = modes.get((target.mode if target else None) or DEFAULT_MODE, {}) if active else {}
        names = sorted({*known, *wanted, *modes.get(DEFAULT_MODE, {})})
        return tuple(ParameterView(name, known.get(name), wanted.get(name)) for name in names)

    # --- inside ----------------------------------------------------------------------------------

    def _note_moved(self, parts: Set[PartName]) -> None:
        self._touched |= parts
        self._moved |= parts
        self._untold |= parts

    def _note_reachable(self, node: PartName, *, reachable: bool) -> None:
        if self._reachability.note(node, reachable=reachable):
            self.touch((node, *self.model.ancestors[node]))
            with_device = self.facts[node].cut_off is not None
            told = NodeReachable if reachable else NodeUnreachable
            self._outbox.emit(told(node, with_device=with_device))

    def _look_late(self, parts: Iterable[PartName], now: Instant) -> None:
        """Tell states and deviations of those parts whose turn has not come yet."""
        for part in parts:
            cause = self._to_look.pop(part, None)
            if cause is not None:
                self._outbox.resume(now, cause.event, cause.actor)
                self._tell_actuals((part,))
                self._look(part, cause.at)

    def _look(self, part: PartName, since: Instant) -> None:
        began = self._deviations.look(part, since)
        if began is not None:
            self._tell_deviation(part, began=began)

    def _tell_actuals(self, parts: Iterable[PartName]) -> None:
        """Publish the parts whose actual state or mode differs from the last published one."""
        actuals, told = self.inference.actuals, self._told
        for part in sorted([p for p in parts if actuals[p] is not told.get(p)]):
            actual, was = actuals[part], told.get(part, _UNKNOWN)
            if actual.state is was.state and actual.mode == was.mode:
                continue
            self._told[part] = actual
            self._outbox.emit(
                PartActualChanged(
                    part,
                    actual.state_and_mode,
                    was.state_and_mode,
                    actual.reason,
                    of_system=part in self.model.systems,
                )
            )

    def _tell_deviation(self, part: PartName, *, began: bool) -> None:
        actual, target = self.inference.actual(part), self.target(part)
        why = actual.reason
        if began and (target is None or is_there(actual, target)):
            why = self.inference.deviation_reason(part)
        kind = DeviationBegan if began else DeviationEnded
        self._outbox.emit(kind(part, target, actual.state_and_mode, why))

    def _deviation_since(self, part: PartName) -> Instant | None:
        """Return since when a part deviates, also if that is told in a later turn."""
        since = self._deviations.since(part)
        if part not in self._to_look:
            return since
        if self.inference.converged(part):
            return None
        return self._to_look[part].at if since is None else since

    def _build(self, part: PartName) -> PartView:
        system = self.model.systems.get(part)
        since = self._deviation_since(part)
        return PartView(
            name=part,
            kind="system" if system else "node",
            parts=system.parts if system else (),
            target=self._targets.asked(part),
            effective_target=self._targets.effective(part),
            actual=self.inference.actual(part),
            converged=since is None,
            deviation_since=since,
            deviation_reason=None if since is None else self.inference.deviation_reason(part),
            reachable=self._reachability.reaches(part),
            change=self.change_of(part),
            device=self._devices.get(part),
            last_known=None if system else self.inference.last_known(part),
        )


def _described(report: NodeReport) -> NodeReported:
    parameters = None if report.parameters is None else dict(report.parameters)
    return NodeReported(report.node, report.state, report.mode, parameters, report.reachable)
