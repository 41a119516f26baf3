"""All changes of state, mode and parameters, with a verified result.

What a change wants of its nodes is the work of `node_steps.py`.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence, Set
from itertools import islice

from domain.changes.kept_changes import ended_by_restart, kept_of
from domain.changes.kept_targets import KeptTargets, RequestOrder
from domain.changes.node_steps import NodeSteps
from domain.changes.plan import ChangeGoal
from domain.changes.record import Change, Pursuit, Step
from domain.changes.settings import ChangeSettings
from domain.errors import UnknownChangeError
from domain.events.changes import CHANGE_ENDS
from domain.health.health import Health
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest, NodeAnswer, NodeReport, ReportBacklog, Restored
from domain.kept import KeptChange
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.convergence import is_there
from domain.parts.parts import Parts
from domain.snapshot import ChangeStatus, StepStatus
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant

KEPT_CHANGES = 1_000
KEPT_PURSUITS = 50_000
"""Pursuits of all changes together; bounds the memory of large changes."""
STARTS_AT_ONCE = 100
"""Nodes that one turn starts. A large change goes on in later ones, and others come in between."""
MAX_IN_FLIGHT = 2_500
"""Steps in flight, above which no further node of a large change is started. Their reports come all
at once, and are taken in long before a step is late: being busy must not look like a late node."""
_ENOUGH_IN_FLIGHT = MAX_IN_FLIGHT - STARTS_AT_ONCE
_TOLD_ERRORS = 20
"""Largest number of errors in the reason of one change; more would not be read."""


class Changes:
    """All changes, running and ended, and the nodes that they are driving."""

    def __init__(
        self,
        parts: Parts,
        settings: ChangeSettings,
        outbox: Outbox,
        health: Health,
    ) -> None:
        self._parts = parts
        self._inference = parts.inference
        self._outbox = outbox
        self._steps = NodeSteps(
            parts, settings, outbox, health, self._take_end, self._take_loose_end
        )
        self._changes: dict[ChangeId, Change] = {}
        self._running: dict[ChangeId, Change] = {}
        self._kept_targets = KeptTargets(parts.model, outbox)
        self._to_pack: dict[ChangeId, Change] = {}
        self._count = 0

    # --- what can be seen ------------------------------------------------------------------------

    def get(self, change: str) -> Change:
        """Return a change.

        Raises:
            UnknownChangeError: The id is unknown, or the change is no longer kept.
        """
        found = self._changes.get(ChangeId(change))
        if found is None:
            hint = f"the last {KEPT_CHANGES} changes are kept; see GET /changes"
            raise UnknownChangeError("change", change, (), hint)
        return found

    def all(self) -> tuple[Change, ...]:
        """Return the changes that are kept, the newest first."""
        return tuple(reversed(self._changes.values()))

    def wake_at(self) -> Instant | None:
        """Return the next deadline; None: there is none."""
        return self._steps.wake_at()

    @property
    def has_more(self) -> bool:
        """Tell whether nodes are still to be started, and may be, or something is to be packed."""
        return self._may_start or bool(self._to_pack)

    def step_in_flight(self, node: PartName) -> Step | None:
        """Return the step that a node is executing."""
        return self._steps.in_flight(node)

    # --- inputs ----------------------------------------------------------------------------------

    def restore(self, restored: Restored, now: Instant) -> None:
        """Set the targets that were kept, and end the changes that the restart interrupted."""
        self._count = restored.next_change - 1
        self._parts.ask(self._kept_targets.restore(restored.kept))
        for change in ended_by_restart(restored.kept, now):
            self._changes[change.id] = change
            self._outbox.forget(KeptChange, change.id)
            self._outbox.emit(CHANGE_ENDS[change.status](change.id, change.part, change.reason))

    def ask(self, part: PartName, targets: Mapping[PartName, StateAndMode]) -> None:
        """Set the targets that a request of a part asks for, and keep them over a restart."""
        if targets:
            self._parts.ask(targets)
            self._kept_targets.note(part, targets)

    @property
    def requests(self) -> RequestOrder:
        """Return which request set the target of each part; read only."""
        return self._kept_targets

    def begin(
        self, part: PartName, request: ChangeRequest, goal: ChangeGoal, now: Instant
    ) -> ChangeId:
        """Begin a change towards targets that are set; it may have ended when this returns.

        Args:
            part: The requested part.
            request: What was requested.
            goal: Its targets and node goals, from the admission.
            now: The current time.
        """
        self._count += 1
        identity = ChangeId(f"c{self._count}")
        cause = self._outbox.record_input()
        change = Change(identity, part, request, dict(goal.targets), now, cause)
        if self._running or not self._steps.is_idle:
            self._supersede(goal.targets.keys() | goal.nodes.keys(), change, now)
        self._changes[identity] = self._running[identity] = change
        self._parts.put_under(identity, (part, *goal.targets, *goal.nodes))
        self._outbox.keep(kept_of(change))
        change.set_out(goal.nodes)
        self._steps.add(change)
        for node in islice(goal.nodes, STARTS_AT_ONCE):
            self._steps.start(node, now)
        self._conclude(change, now)
        self._forget_old()
        return identity

    def cancel(self, change: ChangeId, now: Instant) -> None:
        """Start no further step of a change; without effect if all its nodes have ended.

        A superseded change has ended, but may still be driving nodes that no other change took.

        Raises:
            UnknownChangeError: The id is unknown.
        """
        found = self.get(change)
        if found.open:
            self._outbox.record_input()
        self._drop(found.open.copy(), StepStatus.CANCELED, now)
        if found.status is ChangeStatus.RUNNING:
            self._end(found, ChangeStatus.CANCELED, "canceled on request", now)

    def report(self, report: NodeReport, now: Instant) -> None:
        """Judge the step in flight by a report that the parts have processed, and continue."""
        self._steps.report(report, now)

    def answer(self, answer: NodeAnswer, now: Instant) -> None:
        """Fail the step in flight if the node rejected it."""
        self._steps.answer(answer, now)

    def note_backlog(self, backlog: ReportBacklog) -> None:
        """Note until when reports of nodes are taken in."""
        self._steps.note_backlog(backlog.source, backlog.since)

    def pass_time(self, now: Instant) -> None:
        """Handle all deadlines up to `now`."""
        self._steps.pass_time(now)

    def go_on(self, now: Instant) -> None:
        """Start some more nodes of the change that began first."""
        if not self._may_start:
            if self._to_pack:
                self._to_pack.pop(next(iter(self._to_pack))).pack()
            return
        change = next(iter(self._steps.waiting.values()))
        self._outbox.resume(now, change.cause, change.request.actor)
        first = list(islice(self._steps.waiting.items(), STARTS_AT_ONCE))
        for node in [node for node, waited_for in first if waited_for is change]:
            self._steps.start(node, now)

    # --- inside ----------------------------------------------------------------------------------

    @property
    def _may_start(self) -> bool:
        return bool(self._steps.waiting) and self._steps.count_in_flight <= _ENOUGH_IN_FLIGHT

    def _supersede(self, parts: Set[PartName], newer: Change, now: Instant) -> None:
        """Drop pursuits of `parts`; a change that loses a node ends, but its other nodes go on."""
        self._drop(parts, StepStatus.SUPERSEDED, now)
        reason = f"superseded by change {newer.id} of {newer.part}"
        for change in list(self._running.values()):
            if not change.pursuits.keys().isdisjoint(parts):
                self._end(change, ChangeStatus.SUPERSEDED, reason, now)

    def _drop(self, parts: Set[PartName], status: StepStatus, now: Instant) -> None:
        """Start no further step of nodes on their way, which may be of several changes."""
        let_go: dict[ChangeId, list[PartName]] = defaultdict(list)
        for node, identity in self._steps.drop_waiting(parts).items():
            let_go[identity].append(node)
        for node in sorted(self._steps.on_their_way(parts)):
            identity, is_in_flight = self._steps.drop(node, status, now)
            self._changes[identity].loose += is_in_flight
            let_go[identity].append(node)
        for identity, nodes in let_go.items():
            change = self._changes[identity]
            change.open.difference_update(nodes)
            self._let_go(change, nodes)
            self._pack(change)

    def _take_loose_end(self, identity: ChangeId) -> None:
        """Note that a step has ended whose node is no longer on its way."""
        change = self._changes[identity]
        change.loose -= 1
        self._pack(change)

    def _pack(self, change: Change) -> None:
        """Pack a change that is over; a large one in a turn of its own."""
        if not change.is_over or change.packed is not None:
            return
        if change.node_count <= STARTS_AT_ONCE:
            change.pack()
        else:
            self._to_pack[change.id] = change

    def _take_end(self, pursuit: Pursuit, now: Instant) -> None:
        """Note that a node has ended its part of a change, and end the change with the last."""
        change = self._changes[pursuit.change]
        change.open.discard(pursuit.node)
        self._let_stay(change, pursuit)
        self._conclude(change, now)
        self._let_go(change, {pursuit.node})
        self._pack(change)

    def _let_stay(self, change: Change, pursuit: Pursuit) -> None:
        """Leave a node that turned out to be unconfigured so; deactivating its system asks no more.

        A node that is known to be unconfigured is not asked to be inactive in the first place.
        """
        node, goal = pursuit.node, pursuit.goal
        if goal.configures or node == change.part or pursuit.outcome is not StepStatus.SUCCEEDED:
            return
        resting = StateAndMode(self._parts.facts[node].known_state)
        if resting.state is LifecycleState.UNCONFIGURED:
            change.targets[node] = resting
            if self._parts.let_stay(node, resting):
                self._kept_targets.note(node, {node: resting})

    def _conclude(self, change: Change, now: Instant) -> None:
        """End a running change after its last node has ended; success is verified."""
        if change.open or change.status is not ChangeStatus.RUNNING:
            return
        for outcome, status in _UNHAPPY_ENDS.items():
            errors = change.errors_of(outcome)
            if errors:
                self._end(change, status, _joined(errors), now)
                return
        missed = self._missed_target(change)
        status = ChangeStatus.FAILED if missed else ChangeStatus.SUCCEEDED
        self._end(change, status, missed, now)

    def _missed_target(self, change: Change) -> str | None:
        """Return how the requested part deviates from its target although all steps succeeded."""
        target = change.targets.get(change.part)
        if target is None or self._inference.converged(change.part):
            return None
        actual = self._inference.actual(change.part)
        if is_there(actual, target):
            return self._inference.deviation_reason(change.part)
        words = f"{change.part} is {actual.state_and_mode.label}, not {target.label}"
        others = [
            f"{node} is {self._inference.actual(node).state_and_mode.label}"
            for node in self._inference.model.nodes_below(change.part)
            if node != change.part and self._inference.actual(node).state is not target.state
        ]
        return _joined([actual.reason or words, *others])

    def _end(self, change: Change, status: ChangeStatus, reason: str | None, now: Instant) -> None:
        change.status, change.reason, change.ended_at = status, reason, now
        del self._running[change.id]
        self._outbox.forget(KeptChange, change.id)
        self._let_go(change, {change.part, *change.targets, *change.pursuits})
        self._outbox.emit(CHANGE_ENDS[status](change.id, change.part, reason))
        self._pack(change)

    def _let_go(self, change: Change, parts: Iterable[PartName]) -> None:
        """Release the parts of an ended change, except nodes that it is still driving."""
        if change.status is not ChangeStatus.RUNNING:
            self._parts.let_go(change.id, set(parts) - change.open)

    def _forget_old(self) -> None:
        """Keep the newest changes, and all that are still running or driving a node."""
        excess = len(self._changes) - KEPT_CHANGES
        kept = sum(change.node_count for change in self._changes.values())
        for identity, change in list(self._changes.items())[:-1]:
            if excess <= 0 and kept <= KEPT_PURSUITS:
                return
            if change.is_over:
                del self._changes[identity]
                excess -= 1
                kept -= change.node_count


def _joined(reasons: Sequence[str]) -> str:
    more = len(reasons) - _TOLD_ERRORS
    told = [*reasons[:_TOLD_ERRORS], *([f"and {more} more"] if more > 0 else [])]
    return "; ".join(told)


_UNHAPPY_ENDS: Mapping[StepStatus, ChangeStatus] = {
    StepStatus.FAILED: ChangeStatus.FAILED,
    StepStatus.TIMED_OUT: ChangeStatus.TIMED_OUT,
}
