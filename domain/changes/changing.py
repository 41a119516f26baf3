"""Changes as a concern of the core: requests in; steps and verified results out."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import islice

from domain.actor import Actor
from domain.changes.admission import ChangeAdmission, refuse
from domain.changes.changes import Changes
from domain.changes.guards import Guards
from domain.changes.kept_targets import RequestOrder
from domain.changes.plan import ChangeGoal, next_steps, presumed_steps
from domain.changes.record import Step, StepTable
from domain.changes.request_check import check_request
from domain.changes.restoring import Restoring
from domain.changes.settings import ChangeSettings
from domain.changes.waiting import Waiting, may_wait
from domain.changes.why import Whys
from domain.concern import Concern, Takers
from domain.errors import BackendUnavailableError, BlockedError
from domain.events.changes import (
    BackendAvailable,
    BackendUnavailable,
    ChangeCancelRequested,
    ChangeRequested,
    NodeAnswered,
)
from domain.findings import Blocker
from domain.health.health import Health
from domain.health.part_errors import PartErrors
from domain.identifiers import ChangeId
from domain.inputs import (
    BackendStatus,
    CancelRequest,
    ChangeRequest,
    ModeRequest,
    NodeAnswer,
    NodeReport,
    ParametersRequest,
    ReportBacklog,
    Restored,
    TransitionRequest,
)
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.plans.durations import Durations
from domain.snapshot import ChangeView, ModeView, PlanView
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName
from domain.timebase import Duration, Instant


class Changing(Concern):
    """Admits requests, drives the steps of changes, and restores nodes that reappear."""

    def __init__(
        self,
        parts: Parts,
        health: Health,
        part_errors: PartErrors,
        settings: ChangeSettings,
        outbox: Outbox,
        guards: Guards,
    ) -> None:
        self._parts = parts
        self._health = health
        self._outbox = outbox
        self._guards = guards
        self._admission = ChangeAdmission(
            parts.model, parts.facts, parts.inference.doubtful, guards, parts.claims
        )
        self._changes = Changes(parts, settings, outbox, health, guards, part_errors)
        self._whys = Whys(parts, self._admission, health)
        self._waiting = Waiting(
            parts, self._changes, self._admission, guards, health, outbox, self._admit
        )
        self._restoring = Restoring(parts, self._changes, settings, outbox, self._admit)
        self._backend = BackendStatus(available=True)
        self._backend_since: Instant | None = None
        """Since when the backend is as it is; None: since the start."""

    # --- what happens ----------------------------------------------------------------------------

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {
            ModeRequest: self.take_request,
            TransitionRequest: self.take_request,
            ParametersRequest: self.take_request,
            CancelRequest: self._take_cancel,
            NodeReport: self._follow_report,
            NodeAnswer: self._take_answer,
            BackendStatus: self._take_backend_status,
            ReportBacklog: self._take_backlog,
            Restored: self._changes.restore,
        }

    def wake_at(self) -> Instant | None:
        """Return the next deadline."""
        due = (self._changes.wake_at(), self._waiting.wake_at())
        return min((at for at in due if at is not None), default=None)

    def pass_time(self, now: Instant) -> None:
        """Handle all deadlines up to `now`."""
        self._changes.pass_time(now)
        self._waiting.pass_time(now)

    @property
    def has_more(self) -> bool:
        """Tell whether nodes of a large change are still to be started."""
        return self._changes.has_more

    def go_on(self, now: Instant) -> None:
        """Start some more nodes of large changes."""
        self._changes.go_on(now)

    def settle(self, now: Instant) -> bool:
        """End changes whose guards broke, and begin the next one that restores a node."""
        has_moved = self._changes.judge_guards(now)
        has_moved |= self._waiting.settle(now)
        return self._restoring.begin_next(now) or has_moved

    def take_request(self, request: ChangeRequest, now: Instant) -> None:
        """Begin a change, or let it wait.

        Raises:
            PilothouseError: The request is rejected.
        """
        part = check_request(self._parts.model, self._parts.facts, request)
        try:
            goal = self._admit(request)
        except BlockedError as refusal:
            if isinstance(request, ParametersRequest) or not may_wait(request, refusal.blockers):
                raise
            self._outbox.begin(now, _described(part, request), request.actor)
            self._outbox.change = self._waiting.add(request, refusal.blockers, now)
            return
        self._outbox.begin(now, _described(part, request), request.actor)
        self._parts.note_request(part)
        self._outbox.change = change = self._changes.begin(part, request, goal, now)
        self._waiting.give_way(change, part, now)
        self._restoring.forget(goal.targets)

    def _admit(self, request: ChangeRequest) -> ChangeGoal:
        if (down := self._backend_error()) is not None:
            raise down
        return self._admission.admit(request, self._health.stop_reasons)

    def _take_cancel(self, request: CancelRequest, now: Instant) -> None:
        self._outbox.begin(now, ChangeCancelRequested(request.change), request.actor)
        self._restoring.cancel(request.change)
        self._changes.cancel(request.change, now)
        self._waiting.drop(request.change)

    def _follow_report(self, report: NodeReport, now: Instant) -> None:
        """Judge the step in flight by the node's new facts."""
        step = self._changes.step_in_flight(report.node)
        self._changes.report(report, now)
        self._waiting.note_report(report.node)
        self._restoring.take_report(report, step)

    def _take_answer(self, answer: NodeAnswer, now: Instant) -> None:
        step = self._changes.step_in_flight(answer.node)
        awaited = step is not None and step.request == answer.request
        answered = NodeAnswered(answer.node, answer.accepted, answer.reason)
        self._outbox.begin(now, answered, cause=step.event if step and awaited else None)
        self._changes.answer(answer, now)

    def _take_backend_status(self, status: BackendStatus, now: Instant) -> None:
        if status.available is not self._backend.available:
            kind = BackendAvailable if status.available else BackendUnavailable
            self._outbox.begin(now, kind(status.reason))
            self._outbox.record_input()
            self._backend_since = now
        self._backend = status
        self._waiting.note_backend()

    def _take_backlog(self, backlog: ReportBacklog, now: Instant) -> None:
        self._changes.note_backlog(backlog)

    # --- for the device that follows a supervisor ------------------------------------------------

    def step_in_flight(self, node: PartName) -> Step | None:
        """Return the step of a change that a node is executing; None: there is none."""
        return self._changes.step_in_flight(node)

    def forget_targets(self, parts: Iterable[PartName]) -> None:
        """Let parts have no requested target any more; what is in progress goes on."""
        asked = [part for part in parts if self._parts.asked(part) is not None]
        if asked:
            self._changes.forget_targets(asked)
            self._restoring.forget(asked)

    def drop_all(self, why: str, now: Instant, besides: Collection[Actor]) -> None:
        """Cancel all changes, and forget all requested targets; steps in flight arrive.

        Args:
            why: The reason, in words.
            now: The current time.
            besides: Those whose changes go on.
        """
        for change in self._changes.all():
            if not change.is_over and change.request.actor not in besides:
                self._waiting.drop(change.id)
                self._changes.cancel(change.id, now, why)
        self.forget_targets(self._parts.model.parts)

    # --- for concerns that set targets in force ---------------------------------------------------

    @property
    def admission(self) -> ChangeAdmission:
        """Return what judges goals."""
        return self._admission

    @property
    def requests(self) -> RequestOrder:
        """Return which request set the target of each part; read only."""
        return self._changes.requests

    @property
    def is_available(self) -> bool:
        """Tell whether the backend works, so that a change could begin at all."""
        return self._backend.available

    def drive(
        self,
        part: PartName,
        request: ChangeRequest,
        goal: ChangeGoal,
        now: Instant,
        unguarded: Collection[PartName] = (),
    ) -> ChangeId:
        """Begin a change towards targets that are in force already; it supersedes others.

        Args:
            part: The part whose target it is.
            request: What it would be as a request, in the name of who set the target.
            goal: Its targets and node goals.
            now: The current time.
            unguarded: Parts of which the guards do not count for this change.
        """
        return self._changes.begin(part, request, goal, now, is_asked=False, unguarded=unguarded)

    # --- what can be seen ------------------------------------------------------------------------

    def mode(self, part: PartName, mode: ModeName) -> ModeView:
        """Return a mode of a part, with its blockers."""
        blockers = (
            *self._backend_blockers(part),
            *self._admission.blockers(ModeRequest(part, mode), self._health.stop_reasons),
        )
        settings = self._parts.model.settings_of(part, mode)
        is_in_force = mode == self._mode_in_force(part)
        return ModeView(
            mode,
            not refuse(blockers),
            blockers,
            self._guards.can_stay(part, mode) if is_in_force else None,
            tuple(condition.text for condition in settings.requires),
            tuple(condition.text for condition in settings.invariants),
        )

    def _mode_in_force(self, part: PartName) -> ModeName | None:
        """Return the mode of the target in force, else the actual one; None: there is none."""
        target = self._parts.target(part)
        if target is None:
            return self._parts.inference.actual(part).mode
        if target.state is not LifecycleState.ACTIVE:
            return None
        return target.mode or DEFAULT_MODE

    def why(self, part: PartName) -> tuple[Blocker, ...]:
        """Return why a part is not where it should be, the reasons nearest to it first."""
        return (*self._backend_blockers(part), *self._whys.of(part))

    def _backend_error(self) -> BackendUnavailableError | None:
        return None if self._backend.available else BackendUnavailableError(self._backend.reason)

    def _backend_blockers(self, part: PartName) -> tuple[Blocker, ...]:
        down = self._backend_error()
        if down is None:
            return ()
        return (Blocker(down.code, down.message, (part,), since=self._backend_since),)

    def available_transitions(self, part: PartName) -> tuple[Transition, ...]:
        """Return the transitions that would be accepted now and change something."""
        if not self._backend.available:
            return ()
        return self._admission.available_transitions(part, self._health.stop_reasons)

    def plan(self, request: ChangeRequest) -> PlanView:
        """Return what a request would do now, without starting it.

        Raises:
            PilothouseError: The request would be rejected.
        """
        check_request(self._parts.model, self._parts.facts, request)
        goal = self._admit(request)
        order, durations = self._changes.schedule(request, goal).order, self._changes.durations
        steps: dict[PartName, list[Step]] = {}
        for node, node_goal in goal.nodes.items():
            facts = self._parts.facts[node]
            unknown = facts.known_state is LifecycleState.UNKNOWN
            actions = presumed_steps(node_goal) if unknown else next_steps(facts, node_goal)
            steps[node] = [Step(ChangeId(""), node, action) for action in actions or ()]
        table = StepTable([step for own in steps.values() for step in own], order, durations)
        return PlanView(table, order.stages, order.longest(_expected_times(steps, durations)))

    def change(self, identity: str) -> ChangeView:
        """Return a change.

        Raises:
            UnknownChangeError: The id is unknown, or the change is no longer kept.
        """
        return self._changes.get(identity).view()

    def changes(
        self, limit: int | None = None, part: PartName | None = None
    ) -> tuple[ChangeView, ...]:
        """Return the changes that are kept, the newest first.

        Args:
            limit: Largest number of changes; None: all.
            part: Only changes that were requested of this part.
        """
        kept = (c for c in self._changes.all() if part is None or c.part == part)
        return tuple(change.view() for change in islice(kept, limit))


def _expected_times(
    steps: Mapping[PartName, Sequence[Step]], durations: Durations
) -> dict[PartName, Duration] | None:
    """Return how long each node is expected to take; None: of some step it is not known."""
    times: dict[PartName, Duration] = {}
    for node, own in steps.items():
        each = [durations.expected(node, step.action_name) for step in own]
        known = [took for took in each if took is not None]
        if len(known) < len(each):
            return None
        times[node] = sum(known)
    return times


def _described(part: PartName, request: ChangeRequest) -> ChangeRequested:
    """Return the event that records a request."""
    if isinstance(request, ModeRequest):
        return ChangeRequested(part, mode=request.mode)
    if isinstance(request, TransitionRequest):
        return ChangeRequested(part, transition=request.transition)
    return ChangeRequested(part, parameters=dict(request.values))
