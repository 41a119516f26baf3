"""The nodes that changes are driving, one step at a time each.

A step is done when the node reports its goal; an answer only says that it was accepted. Nodes run
in parallel, each with at most one step in flight. A step in flight is never recalled: the next step
of its node waits until it ends or times out.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Set

from domain.changes.plan import SetParameters, next_steps, presumed_steps
from domain.changes.record import Change, NodeBefore, Pursuit, Step
from domain.changes.settings import ChangeSettings
from domain.changes.step_judgement import judge_report
from domain.commands import AskFacts, AskParameters, AskTransition
from domain.deadlines import Deadlines
from domain.events.changes import StepEnded, StepStarted
from domain.health.health import Health
from domain.identifiers import ChangeId
from domain.inputs import NodeAnswer, NodeReport
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.plans.durations import Durations
from domain.snapshot import StepStatus
from domain.state_and_mode import PartName
from domain.timebase import Duration, Instant, to_seconds

_MAX_STEPS = 16
"""Steps of one node in one change; more are needed only if something else moves the node."""


class NodeSteps:
    """Pursuits of nodes: plans, starts and judges their steps, with deadlines."""

    def __init__(
        self,
        parts: Parts,
        settings: ChangeSettings,
        outbox: Outbox,
        health: Health,
        ended: Callable[[Pursuit, Instant], None],
        loose_ended: Callable[[ChangeId], None],
        forbidden: Callable[[Pursuit], str | None],
    ) -> None:
        """Begin without a pursuit.

        Args:
            parts: Facts of the nodes.
            settings: Deadlines of the steps.
            outbox: Where commands and events go.
            health: Whether ESTOP is on.
            ended: Is handed each pursuit that reached its goal or failed, at once.
            loose_ended: Is handed the change of a step that ended after its pursuit was dropped.
            forbidden: Returns why no further step of a node may begin; None: it may.
        """
        self._parts = parts
        self._facts = parts.facts
        self._settings = settings
        self._outbox = outbox
        self._health = health
        self._ended = ended
        self._loose_ended = loose_ended
        self._forbidden = forbidden
        self._waiting: dict[PartName, Change] = {}
        """By node that waits for its turn, in this order, the change that wants something of it."""
        self._pursuits: dict[PartName, Pursuit] = {}
        self._in_flight: dict[PartName, Step] = {}
        self._deadlines: Deadlines[PartName] = Deadlines()
        self._backlogs: dict[str, Instant] = {}
        """By source of reports that wait to be taken in, until when all are taken in."""
        self.durations = Durations()
        """How long steps took that succeeded."""

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def waiting(self) -> Mapping[PartName, Change]:
        """Return the nodes that wait for `start`, in order, each with its change; read only."""
        return self._waiting

    def on_their_way(self, parts: Set[PartName]) -> Set[PartName]:
        """Return those nodes among parts that are on their way; their turn has come."""
        return self._pursuits.keys() & parts

    @property
    def is_idle(self) -> bool:
        """Tell whether no node is on its way."""
        return not (self._pursuits or self._waiting)

    def in_flight(self, node: PartName) -> Step | None:
        """Return the step that a node is executing."""
        return self._in_flight.get(node)

    @property
    def count_in_flight(self) -> int:
        """Return how many nodes are executing a step."""
        return len(self._in_flight)

    def wake_at(self) -> Instant | None:
        """Return the next deadline; None: there is none, or reports must be taken in before."""
        due = self._deadlines.next()
        return None if due is None or due > self.judged_until(due) else due

    # --- pursuits --------------------------------------------------------------------------------

    def add(self, change: Change, nodes: Iterable[PartName]) -> None:
        """Take over nodes of a change, none of which is on its way; `start` lets each move."""
        self._waiting.update(dict.fromkeys(nodes, change))

    def foresee(self, pursuit: Pursuit) -> None:
        """Plan the steps ahead; each step is planned again from the facts before it starts."""
        facts = self._facts[pursuit.node]
        unknown = facts.known_state is LifecycleState.UNKNOWN
        steps = presumed_steps(pursuit.goal) if unknown else next_steps(facts, pursuit.goal)
        pursuit.plan(steps or ())

    def start(self, node: PartName, now: Instant) -> None:
        """Plan the steps of a node that waits, and start the first unless one is in flight."""
        pursuit = self._take_up(node)
        if pursuit is not None:
            self.foresee(pursuit)
            self._advance(node, now)

    def drop_waiting(self, parts: Set[PartName]) -> defaultdict[ChangeId, list[PartName]]:
        """Let those nodes among parts that wait for their turn not move at all.

        Returns:
            Them by their change, in the order in which they waited.
        """
        waiting = self._waiting
        dropped: defaultdict[ChangeId, list[PartName]] = defaultdict(list)
        for node in [node for node in waiting if node in parts]:
            dropped[waiting.pop(node).id].append(node)
        return dropped

    def drop(self, node: PartName, status: StepStatus, now: Instant) -> tuple[ChangeId, bool]:
        """Start no further step of a node that is on its way.

        Args:
            node: Its turn has come.
            status: Of the steps that are not started: superseded or canceled.
            now: The current time.

        Returns:
            The change that drove it, and whether a step of that is in flight; it ends by itself.
        """
        pursuit = self._pursuits.pop(node)
        pursuit.outcome = status
        pursuit.drop_pending(status, now)
        step = self._in_flight.get(node)
        if step is None:
            self._deadlines.clear(node)
        return pursuit.change, step is not None and step.change == pursuit.change

    def stop(self, nodes: Set[PartName], change: ChangeId, now: Instant) -> set[PartName]:
        """Start no further step of nodes of a change; steps in flight end.

        Returns:
            The nodes that execute one; each ends with it.
        """
        self.drop_waiting(nodes)
        in_flight: set[PartName] = set()
        for node in sorted(self.on_their_way(nodes)):
            step = self._in_flight.get(node)
            if step is not None and step.change == change:
                self._pursuits[node].is_last = True
                in_flight.add(node)
            else:
                self.drop(node, StepStatus.CANCELED, now)
        return in_flight

    # --- what happens ----------------------------------------------------------------------------

    def report(self, report: NodeReport, now: Instant) -> None:
        """Judge the step in flight by a report that the inference has processed, and continue."""
        step = self._in_flight.get(report.node)
        if step is not None:
            verdict = judge_report(step, report, self._facts[report.node])
            if verdict is not None:
                self._end_step(step, verdict.status, verdict.error, now)
        if self.is_cut_off_by(report):
            self._give_up(report.node, now)
        self._advance(report.node, now)

    def is_cut_off_by(self, report: NodeReport) -> bool:
        """Tell whether a report says that the computer of a node is cut off."""
        return report.reachable is False and self._facts[report.node].cut_off is not None

    def give_up_before_its_turn(self, pursuit: Pursuit, now: Instant) -> None:
        """End the pursuit of a node that waits for others, and whose computer is cut off."""
        node = pursuit.node
        self.foresee(pursuit)
        pursuit.end(StepStatus.FAILED, f"{node}: {self._why_cut_off(node)}", now)
        self._ended(pursuit, now)

    def answer(self, answer: NodeAnswer, now: Instant) -> None:
        """Fail the step in flight if the node rejected it."""
        step = self._in_flight.get(answer.node)
        if step is not None and step.request == answer.request and not answer.accepted:
            reason = f"rejected: {answer.reason}" if answer.reason else "rejected"
            self._end_step(step, StepStatus.FAILED, reason, now)
            self._advance(answer.node, now)

    def note_backlog(self, source: str, since: Instant | None) -> None:
        """Note until when reports are taken in: our own delay must not make a node late.

        Args:
            source: Of the reports.
            since: All that arrived up to then are; None: all that arrived at all.
        """
        if since is None:
            self._backlogs.pop(source, None)
        else:
            self._backlogs[source] = since

    def judged_until(self, now: Instant) -> Instant:
        """Return up to when deadlines may be judged: a report may wait that came before `now`."""
        return min((now, *self._backlogs.values())) if self._backlogs else now

    def pass_time(self, now: Instant) -> None:
        """Handle all deadlines up to `now`, unless a report may wait that came before them."""
        until = self.judged_until(now)
        while (node := self._deadlines.pop_due(until)) is not None:
            if node in self._in_flight:
                self._step_is_late(self._in_flight[node], now)
            elif node in self._pursuits:
                self._waited_long_enough(self._pursuits[node], now)

    # --- one node --------------------------------------------------------------------------------

    def _advance(self, node: PartName, now: Instant) -> None:
        """Start the next step of a node, unless one is in flight."""
        if node in self._in_flight or (pursuit := self._take_up(node)) is None:
            return
        facts = self._facts[node]
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
        elif pursuit.is_last:
            self._finish(pursuit, StepStatus.CANCELED, None, now)
        elif len(pursuit.steps) > _MAX_STEPS:
            self._finish(
                pursuit, StepStatus.FAILED, f"{node} keeps leaving the requested state", now
            )
        elif step.action is Transition.ACTIVATE and self._health.is_stopped:
            why = f"{node} is not activated while ESTOP is active"
            self._finish(pursuit, StepStatus.FAILED, why, now)
        elif (forbidden := self._forbidden(pursuit)) is not None:
            self._finish(pursuit, StepStatus.FAILED, f"{node}: {forbidden}", now)
        else:
            self._begin_step(pursuit, step, now)

    def _take_up(self, node: PartName) -> Pursuit | None:
        """Return the pursuit of a node; its turn comes now, if it waited. None: nothing is wanted.

        A report may come before the turn of its node.
        """
        waited_for = self._waiting.pop(node, None)
        if waited_for is not None:
            self._pursuits[node] = waited_for.pursue(node)
            waited_for.stage = max(waited_for.stage, waited_for.order.stage(node))
        return self._pursuits.get(node)

    def _begin_step(self, pursuit: Pursuit, step: Step, now: Instant) -> None:
        node, action = step.node, step.action
        step.status, step.started_at = StepStatus.RUNNING, now
        step.start_state = self._facts[node].known_state
        step.request = self._outbox.next_request()
        pursuit.waiting = False
        if pursuit.before is None:
            pursuit.before = self._as_it_is(pursuit)
        self._in_flight[node] = step
        step.event = self._outbox.emit(StepStarted(step.change, node, step.action_name))
        self._parts.expect_report(node, step.event)
        if isinstance(action, SetParameters):
            self._outbox.command(AskParameters(step.request, node, action.values))
        else:
            self._outbox.command(AskTransition(step.request, node, action))
        self._deadlines.set(node, now + self._allowed(step))

    def _as_it_is(self, pursuit: Pursuit) -> NodeBefore:
        facts = self._facts[pursuit.node]
        known = {n: facts.parameters[n] for n in pursuit.goal.parameters if n in facts.parameters}
        return NodeBefore(facts.known_state, facts.mode, known)

    def _allowed(self, step: Step) -> Duration:
        if isinstance(step.action, SetParameters):
            return self._settings.parameters_deadline
        return self._settings.transition_deadline

    def _end_step(self, step: Step, status: StepStatus, error: str | None, now: Instant) -> None:
        """Record the end of a step; unless it succeeded, its pursuit ends as well."""
        step.end(status, now, error)
        if status is StepStatus.SUCCEEDED and step.started_at is not None:
            self.durations.note(step.node, step.action_name, now - step.started_at)
        del self._in_flight[step.node]
        self._parts.expect_nothing(step.node)
        self._deadlines.clear(step.node)
        self._outbox.emit(StepEnded(step.change, step.node, step.action_name, status, error))
        pursuit = self._pursuits.get(step.node)
        if pursuit is None or pursuit.change != step.change:
            self._loose_ended(step.change)
        elif status is not StepStatus.SUCCEEDED:
            self._finish(pursuit, status, f"{step.node}: {step.action_name}: {error}", now)

    def _step_is_late(self, step: Step, now: Instant) -> None:
        """Query the actual state before a step is declared timed out."""
        facts = self._facts[step.node]
        after = f"within {to_seconds(self._allowed(step)):g} s"
        if facts.reachable is False:
            # Whether it still did what was asked of it is not known.
            self._end_step(step, StepStatus.TIMED_OUT, f"the node {facts.why_unknown}", now)
        elif step.facts_asked:
            error = f"not done {after}, and the node did not answer a query of its state"
            self._end_step(step, StepStatus.TIMED_OUT, error, now)
        else:
            step.facts_asked = True
            self._ask_facts(step.node, now)
            return
        self._advance(step.node, now)

    def _give_up(self, node: PartName, now: Instant) -> None:
        """Let a node do nothing more whose computer is cut off.

        It may come back soon, and at rest on purpose: what was begun before the cut does not go on.
        """
        why = self._why_cut_off(node)
        step = self._in_flight.get(node)
        if step is not None:
            self._end_step(step, StepStatus.TIMED_OUT, why, now)
        pursuit = self._take_up(node)
        if pursuit is not None:
            outcome = StepStatus.TIMED_OUT if pursuit.has_begun else StepStatus.FAILED
            self._finish(pursuit, outcome, f"{node}: {why}", now)

    def _why_cut_off(self, node: PartName) -> str:
        return f"the node {self._facts[node].why_unknown}"

    def _ask_facts(self, node: PartName, now: Instant) -> None:
        self._outbox.command(AskFacts(self._outbox.next_request(), node))
        self._deadlines.set(node, now + self._settings.facts_deadline)

    def _wait(self, pursuit: Pursuit, now: Instant) -> None:
        """Wait, as long as a transition may take, for a node to report or to reach a rest state."""
        if not pursuit.waiting:
            pursuit.waiting, pursuit.facts_asked = True, False
            self._deadlines.set(pursuit.node, now + self._settings.transition_deadline)

    def _waited_long_enough(self, pursuit: Pursuit, now: Instant) -> None:
        facts, node = self._facts[pursuit.node], pursuit.node
        state = facts.known_state
        if state is LifecycleState.UNKNOWN:
            # An absent node was asked for nothing: that fails. What became of one that had begun is
            # not known.
            outcome = StepStatus.TIMED_OUT if pursuit.has_begun else StepStatus.FAILED
            self._finish(pursuit, outcome, f"{node} {facts.why_unknown}", now)
        elif pursuit.facts_asked:
            why = f"{node} is still {state}; no step was started"
            self._finish(pursuit, StepStatus.FAILED, why, now)
        else:
            pursuit.facts_asked = True
            self._ask_facts(node, now)

    def _finish(
        self, pursuit: Pursuit, outcome: StepStatus, error: str | None, now: Instant
    ) -> None:
        """End the pursuit of one node."""
        pursuit.end(outcome, error, now)
        del self._pursuits[pursuit.node]
        self._deadlines.clear(pursuit.node)
        self._ended(pursuit, now)
