"""Changes of state, mode and parameters as operations: steps, deadlines and a verified result.

A step is done when the node reports its goal; an answer only says that it was accepted. Nodes run
in parallel, each with at most one step in flight. A step in flight is never recalled: the next step
of its node waits until it ends or times out.
"""

from collections.abc import Mapping, Sequence

from domain.changes.plan import ChangeGoal, SetParameters, next_steps, presumed_steps
from domain.changes.record import Change, Pursuit, Step
from domain.changes.settings import ChangeSettings
from domain.changes.step_judgement import judge_report
from domain.commands import AskFacts, AskParameters, AskTransition
from domain.deadlines import Deadlines
from domain.errors import UnknownChangeError
from domain.events.changes import CHANGE_ENDS, StepEnded, StepStarted
from domain.health.health import Health
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest, NodeAnswer, NodeReport
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.snapshot import ChangeStatus, StepStatus
from domain.state_and_mode import PartName
from domain.timebase import Duration, Instant, to_seconds

KEPT_CHANGES = 1_000
KEPT_PURSUITS = 50_000
"""Pursuits of all changes together; bounds the memory of large changes."""
_TOLD_ERRORS = 20
"""Largest number of errors in the reason of one change; more would not be read."""
_MAX_STEPS = 16
"""Steps of one node in one change; more are needed only if something else moves the node."""


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
        self._settings = settings
        self._outbox = outbox
        self._health = health
        self._changes: dict[ChangeId, Change] = {}
        self._running: dict[ChangeId, Change] = {}
        self._pursuits: dict[PartName, Pursuit] = {}
        self._in_flight: dict[PartName, Step] = {}
        self._deadlines: Deadlines[PartName] = Deadlines()
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
        return self._deadlines.next()

    def step_in_flight(self, node: PartName) -> Step | None:
        """Return the step that a node is executing."""
        return self._in_flight.get(node)

    # --- inputs ----------------------------------------------------------------------------------

    def begin(
        self, part: PartName, request: ChangeRequest, goal: ChangeGoal, now: Instant
    ) -> ChangeId:
        """Begin an admitted change; it may already have ended when this returns.

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
        nodes = {*goal.nodes, *self._inference.model.nodes_below(part)}
        self._supersede(nodes, change, now)
        self._changes[identity] = self._running[identity] = change
        self._parts.put_under(identity, {part, *goal.targets, *goal.nodes})
        self._parts.ask(goal.targets)
        for node, node_goal in goal.nodes.items():
            self._pursuits[node] = change.pursuits[node] = Pursuit(identity, node, node_goal)
            change.open.add(node)
        for node in goal.nodes:
            self._foresee(self._pursuits[node])
            self._advance(node, now)
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
        for node in sorted(found.open):
            self._drop(found.pursuits[node], StepStatus.CANCELED, now)
        if found.status is ChangeStatus.RUNNING:
            self._end(found, ChangeStatus.CANCELED, "canceled on request", now)

    def report(self, report: NodeReport, now: Instant) -> None:
        """Judge the step in flight by a report that the inference has processed, and continue."""
        step = self._in_flight.get(report.node)
        if step is not None:
            verdict = judge_report(step, report, self._inference.facts[report.node])
            if verdict is not None:
                self._end_step(step, verdict.status, verdict.error, now)
        self._advance(report.node, now)

    def answer(self, answer: NodeAnswer, now: Instant) -> None:
        """Fail the step in flight if the node rejected it."""
        step = self._in_flight.get(answer.node)
        if step is not None and step.request == answer.request and not answer.accepted:
            reason = f"rejected: {answer.reason}" if answer.reason else "rejected"
            self._end_step(step, StepStatus.FAILED, reason, now)
            self._advance(answer.node, now)

    def pass_time(self, now: Instant) -> None:
        """Handle all deadlines up to `now`."""
        while (node := self._deadlines.pop_due(now)) is not None:
            if node in self._in_flight:
                self._step_is_late(self._in_flight[node], now)
            elif node in self._pursuits:
                self._waited_long_enough(self._pursuits[node], now)

    # --- one node --------------------------------------------------------------------------------

    def _advance(self, node: PartName, now: Instant) -> None:
        """Start the next step of a node, unless one is in flight."""
        pursuit = self._pursuits.get(node)
        if pursuit is None or node in self._in_flight:
            return
        facts = self._inference.facts[node]
        state = facts.known_state
        passing = pursuit.goal.state is not None and not state.is_primary
        if state is LifecycleState.UNKNOWN or passing:
            self._wait(pursuit, now)
            return
        actions = next_steps(facts, pursuit.goal)
        if actions is None:
            why = "has no lifecycle" if not facts.has_lifecycle else f"is {state}"
            self._finish(pursuit, StepStatus.FAILED, f"{node} {why}: no path to the goal", now)
            return
        pursuit.plan(actions)
        step = pursuit.next_step()
        if step is None:
            self._finish(pursuit, StepStatus.SUCCEEDED, None, now)
        elif len(pursuit.steps) > _MAX_STEPS:
            self._finish(
                pursuit, StepStatus.FAILED, f"{node} keeps leaving the requested state", now
            )
        elif step.action is Transition.ACTIVATE and self._health.is_stopped:
            why = f"{node} is not activated while ESTOP is active"
            self._finish(pursuit, StepStatus.FAILED, why, now)
        else:
            self._begin_step(pursuit, step, now)

    def _foresee(self, pursuit: Pursuit) -> None:
        """Plan the steps ahead; each step is planned again from the facts before it starts."""
        facts = self._inference.facts[pursuit.node]
        unknown = facts.known_state is LifecycleState.UNKNOWN
        steps = presumed_steps(pursuit.goal) if unknown else next_steps(facts, pursuit.goal)
        pursuit.plan(steps or ())

    def _begin_step(self, pursuit: Pursuit, step: Step, now: Instant) -> None:
        node, action = step.node, step.action
        step.status, step.started_at = StepStatus.RUNNING, now
        step.start_state = self._inference.facts[node].known_state
        step.request = self._outbox.next_request()
        pursuit.waiting = False
        self._in_flight[node] = step
        step.event = self._outbox.emit(StepStarted(step.change, node, step.action_name))
        self._parts.expect_report(node, step.event)
        if isinstance(action, SetParameters):
            self._outbox.command(AskParameters(step.request, node, action.values))
        else:
            self._outbox.command(AskTransition(step.request, node, action))
        self._deadlines.set(node, now + self._allowed(step))

    def _allowed(self, step: Step) -> Duration:
        if isinstance(step.action, SetParameters):
            return self._settings.parameters_deadline
        return self._settings.transition_deadline

    def _end_step(self, step: Step, status: StepStatus, error: str | None, now: Instant) -> None:
        """Record the end of a step; unless it succeeded, its pursuit ends as well."""
        step.end(status, now, error)
        del self._in_flight[step.node]
        self._parts.expect_nothing(step.node)
        self._deadlines.clear(step.node)
        self._outbox.emit(StepEnded(step.change, step.node, step.action_name, status, error))
        pursuit = self._pursuits.get(step.node)
        if pursuit is None or pursuit.change != step.change or status is StepStatus.SUCCEEDED:
            return
        self._finish(pursuit, status, f"{step.node}: {step.action_name}: {error}", now)

    def _step_is_late(self, step: Step, now: Instant) -> None:
        """Query the actual state before a step is declared timed out."""
        facts = self._inference.facts[step.node]
        after = f"within {to_seconds(self._allowed(step)):g} s"
        if facts.reachable is False:
            self._end_step(step, StepStatus.FAILED, f"the node {facts.why_unknown}", now)
        elif step.facts_asked:
            error = f"not done {after}, and the node did not answer a query of its state"
            self._end_step(step, StepStatus.TIMED_OUT, error, now)
        else:
            step.facts_asked = True
            self._ask_facts(step.node, now)
            return
        self._advance(step.node, now)

    def _ask_facts(self, node: PartName, now: Instant) -> None:
        self._outbox.command(AskFacts(self._outbox.next_request(), node))
        self._deadlines.set(node, now + self._settings.facts_deadline)

    def _wait(self, pursuit: Pursuit, now: Instant) -> None:
        """Wait, as long as a transition may take, for a node to report or to reach a rest state."""
        if not pursuit.waiting:
            pursuit.waiting, pursuit.facts_asked = True, False
            self._deadlines.set(pursuit.node, now + self._settings.transition_deadline)

    def _waited_long_enough(self, pursuit: Pursuit, now: Instant) -> None:
        facts, node = self._inference.facts[pursuit.node], pursuit.node
        state = facts.known_state
        if state is LifecycleState.UNKNOWN:
            self._finish(pursuit, StepStatus.FAILED, f"{node} {facts.why_unknown}", now)
        elif pursuit.facts_asked:
            why = f"{node} is still {state}; no step was started"
            self._finish(pursuit, StepStatus.FAILED, why, now)
        else:
            pursuit.facts_asked = True
            self._ask_facts(node, now)

    def _finish(
        self, pursuit: Pursuit, outcome: StepStatus, error: str | None, now: Instant
    ) -> None:
        """End the pursuit of one node, and the change with the last of them."""
        pursuit.outcome, pursuit.error = outcome, error
        if outcome is not StepStatus.SUCCEEDED:
            step = pursuit.next_step()
            if step is not None and not any(s.status is outcome for s in pursuit.steps):
                step.end(outcome, now, error)
            pursuit.drop_pending(StepStatus.CANCELED, now)
        del self._pursuits[pursuit.node]
        self._deadlines.clear(pursuit.node)
        change = self._changes[pursuit.change]
        change.open.discard(pursuit.node)
        self._conclude(change, now)
        self._let_go(change, {pursuit.node})

    # --- whole changes ---------------------------------------------------------------------------

    def _supersede(self, nodes: set[PartName], newer: Change, now: Instant) -> None:
        """Drop pursuits of `nodes`; a change that loses a node ends, but its other nodes go on."""
        for node in sorted(nodes & self._pursuits.keys()):
            self._drop(self._pursuits[node], StepStatus.SUPERSEDED, now)
        reason = f"superseded by change {newer.id} of {newer.part}"
        for change in list(self._running.values()):
            if nodes & change.pursuits.keys():
                self._end(change, ChangeStatus.SUPERSEDED, reason, now)

    def _drop(self, pursuit: Pursuit, status: StepStatus, now: Instant) -> None:
        pursuit.outcome = status
        pursuit.drop_pending(status, now)
        del self._pursuits[pursuit.node]
        if pursuit.node not in self._in_flight:
            self._deadlines.clear(pursuit.node)
        change = self._changes[pursuit.change]
        change.open.discard(pursuit.node)
        self._let_go(change, {pursuit.node})

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
        self._let_go(change, {change.part, *change.targets, *change.pursuits})
        self._outbox.emit(CHANGE_ENDS[status](change.id, change.part, reason))

    def _let_go(self, change: Change, parts: set[PartName]) -> None:
        """Release the parts of an ended change, except nodes that it is still driving."""
        if change.status is ChangeStatus.RUNNING:
            return
        self._parts.let_go(change.id, parts - change.open)

    def _forget_old(self) -> None:
        """Keep the newest changes, and all that are still running or driving a node."""
        excess = len(self._changes) - KEPT_CHANGES
        kept = sum(len(change.pursuits) for change in self._changes.values())
        for identity, change in list(self._changes.items())[:-1]:
            if excess <= 0 and kept <= KEPT_PURSUITS:
                return
            if change.status is not ChangeStatus.RUNNING and not change.open:
                del self._changes[identity]
                excess -= 1
                kept -= len(change.pursuits)


def _joined(reasons: Sequence[str]) -> str:
    more = len(reasons) - _TOLD_ERRORS
    told = [*reasons[:_TOLD_ERRORS], *([f"and {more} more"] if more > 0 else [])]
    return "; ".join(told)


_UNHAPPY_ENDS: Mapping[StepStatus, ChangeStatus] = {
    StepStatus.FAILED: ChangeStatus.FAILED,
    StepStatus.TIMED_OUT: ChangeStatus.TIMED_OUT,
}
