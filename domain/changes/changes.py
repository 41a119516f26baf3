"""All changes of state, mode and parameters, with a verified result.

What a change wants of its nodes is the work of `node_steps.py`.
"""

from collections.abc import Collection, Iterable, Mapping, Set
from itertools import islice

from domain.changes.change_log import ChangeLog
from domain.changes.guarded_changes import GuardedChanges
from domain.changes.guards import Guards
from domain.changes.kept_changes import ended_by_restart, kept_of
from domain.changes.kept_targets import KeptTargets, RequestOrder
from domain.changes.node_steps import NodeSteps
from domain.changes.outcome import joined, missed_target
from domain.changes.plan import ChangeGoal
from domain.changes.record import Change, Pursuit, Step
from domain.changes.rollback import goals_before
from domain.changes.schedule import Schedule, schedule_of
from domain.changes.settings import ChangeSettings
from domain.deadlines import Deadlines
from domain.events.changes import CHANGE_ENDS, ChangeWaiting
from domain.health.health import Health
from domain.health.part_errors import PartErrors
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest, NodeAnswer, NodeReport, ReportBacklog, Restored
from domain.kept import KeptChange
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.mode_settings import OnFailure
from domain.parts.parts import Parts
from domain.plans.durations import Durations
from domain.snapshot import ChangeStatus, Rollback, StepStatus
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant, to_seconds

STARTS_AT_ONCE = 100
"""Nodes that one turn starts. A large change goes on in later ones, and others come in between."""
MAX_IN_FLIGHT = 2_500
"""Steps in flight, above which no further node of a large change is started. Their reports come all
at once, and are taken in long before a step is late: being busy must not look like a late node."""
_ENOUGH_IN_FLIGHT = MAX_IN_FLIGHT - STARTS_AT_ONCE


class Changes:
    """All changes, running and ended, and the nodes that they are driving."""

    def __init__(
        self,
        parts: Parts,
        settings: ChangeSettings,
        outbox: Outbox,
        health: Health,
        guards: Guards,
        part_errors: PartErrors,
    ) -> None:
        self._parts = parts
        self._part_errors = part_errors
        self._inference = parts.inference
        self._outbox = outbox
        self._steps = NodeSteps(
            parts,
            settings,
            outbox,
            health,
            self._take_end,
            self._take_loose_end,
            self._forbidden,
        )
        self._log = ChangeLog()
        self._running: dict[ChangeId, Change] = {}
        self._kept_targets = KeptTargets(parts.model, outbox)
        self._deadlines: Deadlines[ChangeId] = Deadlines()
        self._guarded = GuardedChanges(guards, self._inference.model)

    # --- what can be seen ------------------------------------------------------------------------

    def get(self, change: str) -> Change:
        """Return a change.

        Raises:
            UnknownChangeError: The id is unknown, or the change is no longer kept.
        """
        return self._log.get(change)

    def all(self) -> tuple[Change, ...]:
        """Return the changes that are kept, the newest first."""
        return self._log.all()

    def schedule(self, request: ChangeRequest, goal: ChangeGoal) -> Schedule:
        """Return how the change that an admitted request begins would proceed."""
        return schedule_of(
            self._parts.model, request, goal, lambda part: self._inference.actual(part).mode
        )

    @property
    def durations(self) -> Durations:
        """Return how long steps took."""
        return self._steps.durations

    def wake_at(self) -> Instant | None:
        """Return the next deadline; None: there is none, or reports must be taken in before."""
        own = self._deadlines.next()
        if own is not None and own > self._steps.judged_until(own):
            own = None
        due = (self._steps.wake_at(), own, self._guarded.due)
        return min((at for at in due if at is not None), default=None)

    @property
    def has_more(self) -> bool:
        """Tell whether nodes are still to be started, and may be, or something is to be packed."""
        return self._may_start or self._log.has_more

    def step_in_flight(self, node: PartName) -> Step | None:
        """Return the step that a node is executing."""
        return self._steps.in_flight(node)

    # --- inputs ----------------------------------------------------------------------------------

    def restore(self, restored: Restored, now: Instant) -> None:
        """Set the targets that were kept, and end the changes that the restart interrupted."""
        self._log.count_from(restored.next_change)
        for targets in self._kept_targets.restore(restored.kept):
            self._parts.ask(targets)
        for change in ended_by_restart(restored.kept, now):
            self._log.add(change)
            self._outbox.forget(KeptChange, change.id)
            self._tell_end(change, now)

    @property
    def requests(self) -> RequestOrder:
        """Return which request set the target of each part; read only."""
        return self._kept_targets

    def begin(
        self,
        part: PartName,
        request: ChangeRequest,
        goal: ChangeGoal,
        now: Instant,
        *,
        is_asked: bool = True,
        waited: Change | None = None,
        unguarded: Collection[PartName] = (),
    ) -> ChangeId:
        """Begin an admitted change; it may already have ended when this returns.

        Args:
            part: The requested part.
            request: What was requested.
            goal: Its targets and node goals, from the admission.
            now: The current time.
            is_asked: Whether its targets are requested. Otherwise they are in force already, and a
                failure does not lead back.
            waited: The same change, if it waited until now.
            unguarded: Parts of which the guards do not count.
        """
        if waited is None:
            identity, started_at, cause = self._log.next_id(), now, self._outbox.record_input()
        else:
            identity, started_at, cause = waited.id, waited.started_at, waited.cause
        schedule = self.schedule(request, goal)
        if not is_asked:
            schedule = schedule.without_rollback()
        targets, took = dict(goal.targets), self._steps.durations
        change = Change(identity, part, request, targets, started_at, cause, schedule, took)
        self._take_parts(change, goal, now)
        self._log.add(change)
        self._running[identity] = change
        if is_asked:
            self._ask(change)
        self._outbox.keep(kept_of(change))
        if schedule.deadline is not None:
            change.deadline_at = now + schedule.deadline
            self._deadlines.set(identity, change.deadline_at)
        change.set_out(goal.nodes)
        self._guarded.add(change, unguarded)
        self._set_out(change, now)
        self._conclude(change, now)
        self._log.forget_old()
        return identity

    def let_wait(self, part: PartName, request: ChangeRequest, now: Instant, why: str) -> Change:
        """Record a change that waits; `begin` begins it, or `end_waiting` ends it.

        Args:
            part: The requested part.
            request: What was requested.
            now: The current time.
            why: What it waits for.
        """
        cause, identity = self._outbox.record_input(), self._log.next_id()
        status = ChangeStatus.WAITING
        change = Change(identity, part, request, {}, now, cause, status=status, reason=why)
        self._log.add(change)
        self._outbox.keep(kept_of(change))
        self._outbox.emit(ChangeWaiting(identity, part, why))
        self._log.forget_old()
        return change

    def end_waiting(self, change: Change, status: ChangeStatus, why: str, now: Instant) -> None:
        """End a change that waits."""
        self._end(change, status, why, now)

    def _ask(self, change: Change) -> None:
        """Set the targets that a change is to reach, and keep them over a restart."""
        if change.schedule.on_failure is OnFailure.ROLLBACK:
            change.targets_before = self._parts.asked_of(change.targets)
        self._parts.ask(change.targets)
        if change.targets:
            self._kept_targets.note(change.part, change.targets)

    def cancel(self, change: ChangeId, now: Instant, why: str = "canceled on request") -> None:
        """Start no further step of a change; without effect if all its nodes have ended.

        A superseded change has ended, but may still be driving nodes that no other change took.

        Raises:
            UnknownChangeError: The id is unknown.
        """
        found = self.get(change)
        if found.open or found.status is ChangeStatus.WAITING:
            self._outbox.record_input()
        self._drop(found.open.copy(), StepStatus.CANCELED, now)
        found.leave(list(found.open), StepStatus.CANCELED, now)
        if not found.status.is_final:
            self._end_by(found, ChangeStatus.CANCELED, why, now)

    def forget_targets(self, parts: Iterable[PartName]) -> None:
        """Let parts have no requested target any more."""
        none: dict[PartName, StateAndMode | None] = dict.fromkeys(parts)
        self._parts.ask(none)
        self._kept_targets.restore_before(none)

    def report(self, report: NodeReport, now: Instant) -> None:
        """Judge the step in flight by a report that the parts have processed, and continue."""
        self._steps.report(report, now)
        if not self._steps.is_cut_off_by(report):
            return
        node = report.node
        for change in [each for each in self._running.values() if node in each.open]:
            if change.order.waits(node):
                self._steps.give_up_before_its_turn(change.pursue(node), now)

    def answer(self, answer: NodeAnswer, now: Instant) -> None:
        """Fail the step in flight if the node rejected it."""
        self._steps.answer(answer, now)

    def note_backlog(self, backlog: ReportBacklog) -> None:
        """Note until when reports of nodes are taken in."""
        self._steps.note_backlog(backlog.source, backlog.since)

    def pass_time(self, now: Instant) -> None:
        """Handle all deadlines up to `now`."""
        self._steps.pass_time(now)
        until = self._steps.judged_until(now)
        while (identity := self._deadlines.pop_due(until)) is not None:
            self._is_late(self._log[identity], now)

    def go_on(self, now: Instant) -> None:
        """Start some more nodes of the change that began first."""
        if not self._may_start:
            self._log.pack_next()
            return
        change = next(iter(self._steps.waiting.values()))
        self._outbox.resume(now, change.cause, change.request.actor)
        first = list(islice(self._steps.waiting.items(), STARTS_AT_ONCE))
        for node in [node for node, waited_for in first if waited_for is change]:
            self._steps.start(node, now)

    def judge_guards(self, now: Instant) -> bool:
        """End running changes of which an invariant is broken; return whether there are any."""
        broken = self._guarded.broken(now)
        for change, reason in broken:
            self._fail(change, reason, now)
        return bool(broken)

    def _fail(self, change: Change, reason: str, now: Instant) -> None:
        """Stop a running change, which then goes back if it is to on a failure."""
        change.failure = (ChangeStatus.FAILED, reason)
        self._guarded.drop(change)
        self._stop(change, now)
        self._conclude(change, now)

    def _forbidden(self, pursuit: Pursuit) -> str | None:
        """Return which guard keeps a node from its next step; None: none does."""
        change = self._log[pursuit.change]
        if pursuit.rollback or change.unguarded is None:
            return None
        broken = self._guarded.forbids(change, pursuit.node)
        if broken is not None and change.failure is None:
            change.failure = (ChangeStatus.FAILED, broken)
        return broken

    # --- the order of its nodes ------------------------------------------------------------------

    def _set_out(self, change: Change, now: Instant) -> None:
        """Start the nodes that wait for no other; foresee the steps of those that do."""
        free = change.order.free_of(change.goals)
        if len(free) < len(change.goals):
            for node in islice(change.goals, STARTS_AT_ONCE):
                self._steps.foresee(change.pursue(node))
        self._steps.add(change, free)
        for node in islice(free, STARTS_AT_ONCE):
            self._steps.start(node, now)

    def _follow(self, change: Change, pursuit: Pursuit, now: Instant) -> None:
        """Let those nodes begin that waited for one; or none any more, since that one failed."""
        if change.status is not ChangeStatus.RUNNING or change.is_stopping:
            return
        is_strict = change.is_going_back or change.schedule.on_failure is not OnFailure.CONTINUE
        is_strict |= change.failure is not None
        if is_strict and pursuit.outcome is not StepStatus.SUCCEEDED:
            self._stop(change, now)
        elif not change.order.waits(pursuit.node):
            self._steps.add(change, change.freed_by(pursuit.node))

    def _stop(self, change: Change, now: Instant) -> None:
        """Begin no further step of a running change; steps in flight end."""
        change.is_stopping = True
        in_flight = self._steps.stop(change.open, change.id, now)
        change.leave(change.open - in_flight, StepStatus.CANCELED, now)

    def _is_late(self, change: Change, now: Instant) -> None:
        """End a change that is not done by its deadline, unless it ends or goes back already."""
        allowed = change.schedule.deadline
        if change.is_stopping or change.is_going_back or allowed is None:
            return
        reason = f"not done within {to_seconds(allowed):g} s: {joined(sorted(change.open))}"
        if change.schedule.on_failure is OnFailure.ROLLBACK:
            change.failure = (ChangeStatus.TIMED_OUT, reason)
            self._stop(change, now)
            self._conclude(change, now)
            return
        self._drop(change.open.copy(), StepStatus.CANCELED, now)
        change.leave(list(change.open), StepStatus.CANCELED, now)
        self._end(change, ChangeStatus.TIMED_OUT, reason, now)

    def _go_back(self, change: Change, now: Instant) -> None:
        """Take the nodes that were asked for something back to where they were."""
        self._deadlines.clear(change.id)
        self._guarded.drop(change)
        self._parts.ask(change.targets_before)
        self._kept_targets.restore_before(change.targets_before)
        goals = goals_before(change)
        change.turn_back(goals, change.schedule.order.turned(goals))
        self._set_out(change, now)
        self._conclude(change, now)

    # --- inside ----------------------------------------------------------------------------------

    @property
    def _may_start(self) -> bool:
        return bool(self._steps.waiting) and self._steps.count_in_flight <= _ENOUGH_IN_FLIGHT

    def _take_parts(self, change: Change, goal: ChangeGoal, now: Instant) -> None:
        """Let a change drive its parts, and no other one any more."""
        # Before the others let them go: there may be ten thousand.
        for driven in (goal.targets, goal.nodes, (change.part,)):
            self._parts.put_under(change.id, driven)
        if self._running or not self._steps.is_idle:
            self._supersede(goal.targets.keys() | goal.nodes.keys(), change, now)

    def _supersede(self, parts: Set[PartName], newer: Change, now: Instant) -> None:
        """Drop pursuits of `parts`; a change that loses a node ends, but its other nodes go on."""
        self._drop(parts, StepStatus.SUPERSEDED, now)
        reason = f"superseded by change {newer.id} of {newer.part}"
        for change in list(self._running.values()):
            if not change.pursuits.keys().isdisjoint(parts):
                self._leave_later_stages(change, now)
                self._end_by(change, ChangeStatus.SUPERSEDED, reason, now)

    def _leave_later_stages(self, change: Change, now: Instant) -> None:
        """Let no node begin that waits for others; of those that go back, none at all."""
        if change.is_going_back:
            self._stop(change, now)
        else:
            blocked = [node for node in change.order.blocked if node in change.open]
            change.leave(blocked, StepStatus.SUPERSEDED, now)

    def _drop(self, parts: Set[PartName], status: StepStatus, now: Instant) -> None:
        """Start no further step of nodes on their way, which may be of several changes."""
        let_go = self._steps.drop_waiting(parts)
        for node in sorted(self._steps.on_their_way(parts)):
            identity, is_in_flight = self._steps.drop(node, status, now)
            self._log[identity].loose += is_in_flight
            let_go[identity].append(node)
        for identity, nodes in let_go.items():
            change = self._log[identity]
            change.open.difference_update(nodes)
            self._let_go(change, nodes)
            self._log.pack(change)

    def _take_loose_end(self, identity: ChangeId) -> None:
        """Note that a step has ended whose node is no longer on its way."""
        change = self._log[identity]
        change.loose -= 1
        self._log.pack(change)

    def _take_end(self, pursuit: Pursuit, now: Instant) -> None:
        """Note that a node has ended its part of a change, and end the change with the last."""
        change = self._log[pursuit.change]
        change.open.discard(pursuit.node)
        self._let_stay(change, pursuit)
        self._follow(change, pursuit, now)
        self._conclude(change, now)
        self._let_go(change, {pursuit.node})
        self._log.pack(change)

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
        status, reason = self._verdict(change)
        if change.failure is not None and change.is_going_back:
            self._end_gone_back(change, reason, now)
        elif status is ChangeStatus.SUCCEEDED:
            self._end(change, status, None, now)
        elif change.schedule.on_failure is OnFailure.ROLLBACK:
            change.failure = change.failure or (ChangeStatus.FAILED, reason or "")
            self._go_back(change, now)
        else:
            self._end(change, status, reason, now)

    def _verdict(self, change: Change) -> tuple[ChangeStatus, str | None]:
        """Return how the nodes of a change ended, all together, and why."""
        if change.failure is not None and not change.is_going_back:
            return change.failure
        for outcome, status in _UNHAPPY_ENDS.items():
            errors = change.errors_of(outcome)
            if errors:
                return status, joined(errors)
        missed = None if change.is_going_back else missed_target(change, self._inference)
        return (ChangeStatus.FAILED, missed) if missed else (ChangeStatus.SUCCEEDED, None)

    def _end_gone_back(self, change: Change, error: str | None, now: Instant) -> None:
        """End a change whose nodes went back, or did not all."""
        assert change.failure is not None
        status, reason = change.failure
        change.rollback = Rollback.INCOMPLETE if error else Rollback.DONE
        words = f"rollback incomplete: {error}" if error else "rolled back"
        self._end(change, status, f"{reason}; {words}", now)

    def _end_by(self, change: Change, status: ChangeStatus, why: str, now: Instant) -> None:
        """End a change by a request; one that goes back has failed, and remains half-way."""
        if change.is_going_back:
            self._end_gone_back(change, why, now)
        else:
            self._end(change, status, why, now)

    def _end(self, change: Change, status: ChangeStatus, reason: str | None, now: Instant) -> None:
        change.status, change.reason, change.ended_at = status, reason, now
        self._running.pop(change.id, None)
        self._deadlines.clear(change.id)
        self._guarded.drop(change)
        self._outbox.forget(KeptChange, change.id)
        for driven in (change.targets, change.pursuits, (change.part,)):
            self._let_go(change, driven)
        self._tell_end(change, now)
        self._log.pack(change)

    def _tell_end(self, change: Change, now: Instant) -> None:
        ended = CHANGE_ENDS[change.status](change.id, change.part, change.reason)
        event = self._outbox.emit(ended)
        pursuits = change.pursuits
        missed = [
            node
            for node, own in pursuits.items()
            if own is not None and own.outcome in _UNHAPPY_ENDS
        ]
        self._part_errors.note_end(ended, event, (change.targets, pursuits), missed, now)

    def _let_go(self, change: Change, parts: Iterable[PartName]) -> None:
        """Release the parts of an ended change, except nodes that it is still driving."""
        if change.status is not ChangeStatus.RUNNING:
            still = change.open
            self._parts.let_go(change.id, [p for p in parts if p not in still] if still else parts)


_UNHAPPY_ENDS: Mapping[StepStatus, ChangeStatus] = {
    StepStatus.FAILED: ChangeStatus.FAILED,
    StepStatus.TIMED_OUT: ChangeStatus.TIMED_OUT,
}
