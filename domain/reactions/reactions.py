"""Reactions of the model as a concern: what the robot does while something is so.

Everything is decided anew in each step from all conditions, so that what is told as the cause of
an action is always what calls for it now.
"""

from collections.abc import Iterable, Iterator

from domain.actor import Actor
from domain.changes.changing import Changing
from domain.changes.guards import Guards
from domain.concern import Concern, Takers
from domain.errors import ActsElsewhereError, UnknownReactionError
from domain.events.reactions import (
    ReactionAcknowledged,
    ReactionArmRequested,
    ReactionReported,
)
from domain.health.emergency_stop import EmergencyStop
from domain.health.health import Health
from domain.inputs import (
    AcknowledgeReactionRequest,
    ArmRequest,
    BackendStatus,
    ModeRequest,
    ReactionReport,
    Restored,
    TransitionRequest,
)
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.reaction_terms import Arm, ReactionState
from domain.reactions.budgets import Budgets
from domain.reactions.contest import Contest, Outcome, Standing, claim_of
from domain.reactions.displacing import Displacing
from domain.reactions.effects import Effects
from domain.reactions.escalations import Escalations
from domain.reactions.kept_reactions import KeptReactions
from domain.reactions.moving import Moving
from domain.reactions.obstacles import Obstacles
from domain.reactions.reaction import Reaction
from domain.reactions.reaction_view import ReactionView
from domain.reactions.reaction_views import ReactionViews
from domain.reactions.restarts import Restarts
from domain.reactions.triggers import Triggers
from domain.state_and_mode import PartName
from domain.tasks.driving import Driving
from domain.timebase import Instant

_IDLE = Standing(ReactionState.IDLE)
_PENDING = Standing(ReactionState.PENDING)


class Reactions(Concern):
    """Decides which reactions act, and lets them."""

    _was_stopped = False
    _stop_ended_at: Instant | None = None

    def __init__(
        self,
        reactions: list[Reaction],
        parts: Parts,
        changing: Changing,
        health: Health,
        emergency_stop: EmergencyStop,
        driving: Driving,
        guards: Guards,
        displacing: Displacing,
        outbox: Outbox,
        start: Instant,
    ) -> None:
        """Begin without a reaction that acts.

        Args:
            reactions: All of them, in the order of the file.
            parts: Targets in force of all parts.
            changing: Begins changes.
            health: Tells whether ESTOP is active.
            emergency_stop: Engaged by reactions.
            driving: Holds the task.
            guards: Of all modes.
            displacing: Puts targets in force.
            outbox: Receives events.
            start: The current time.
        """
        self._reactions = reactions
        self._by_name = {reaction.name: reaction for reaction in reactions}
        self._parts = parts
        self._health = health
        self._outbox = outbox
        self._triggers = Triggers(reactions, parts, outbox, start)
        self._obstacles = Obstacles(parts, changing, health, guards, displacing, self._triggers)
        self._budgets = Budgets()
        self._contest = Contest(self._obstacles, self._budgets)
        restarts = Restarts(parts, changing, health, outbox)
        self._escalations = Escalations(self._by_name, parts, driving, restarts)
        self._effects = Effects(driving, emergency_stop, outbox)
        self._moving = Moving(
            reactions, parts, changing, health, guards, displacing, restarts, outbox
        )
        self._kept = KeptReactions(
            self._by_name, self._triggers, self._budgets, self._escalations, outbox
        )
        self._views = ReactionViews(reactions, self._budgets, self._triggers, outbox)
        self._revision: int | None = None
        """That of the conditions when they were judged last; None: all have to be."""
        self._was_waiting = parts.awaits_devices

    # --- what happens ----------------------------------------------------------------------------

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {
            ArmRequest: self._take_arm,
            AcknowledgeReactionRequest: self._take_acknowledgement,
            ModeRequest: self._follow_request,
            TransitionRequest: self._follow_request,
            BackendStatus: self._follow_backend,
            ReactionReport: self._take_report,
            Restored: self.restore,
        }

    def restore(self, restored: Restored, now: Instant) -> None:
        """Let reactions stand as an earlier run left them; none of them begins anything."""
        if not restored.is_restart:
            return
        self._triggers.begin_anew(now)
        for reaction in self._kept.restore(restored, now):
            # Until the device says how it stands.
            reaction.reported = reaction.state
            self._effects.restore(reaction)
            self._views.note(reaction)
        acting = [each for each in self._reactions if each.state is ReactionState.ACTING]
        self._moving.restore(restored, acting, now)
        self._revision = None

    def _take_arm(self, request: ArmRequest, now: Instant) -> None:
        reaction = self._of_here(request.part, request.reaction)
        told = ReactionArmRequested(reaction.part, reaction.name, request.arm, request.reason)
        self._outbox.begin(now, told, request.actor)
        if reaction.arm is request.arm:
            return
        self._outbox.record_input()
        reaction.arm = request.arm
        self._begin_afresh(reaction, now)
        if request.arm is Arm.DISARMED:
            self._triggers.forget(reaction)

    def _take_acknowledgement(self, request: AcknowledgeReactionRequest, now: Instant) -> None:
        reaction = self._of_here(request.part, request.reaction)
        self._outbox.begin(now, ReactionAcknowledged(reaction.part, reaction.name), request.actor)
        self._outbox.record_input()
        if reaction.state is ReactionState.EXHAUSTED:
            self._begin_afresh(reaction, now)
        self._triggers.acknowledge(reaction)
        self._kept.renew(reaction, now)
        self._views.note(reaction)
        self._revision = None

    def _take_report(self, report: ReactionReport, now: Instant) -> None:
        """Let a reaction stand as it does on its device; of one that is decided here, nothing."""
        reaction = self._by_name.get(report.reaction)
        if reaction is None or reaction.part != report.part or reaction.elsewhere is None:
            return
        self._outbox.begin(now, ReactionReported(report.part, report.reaction, report.state))
        if reaction.reported is not report.state:
            self._outbox.record_input()
            reaction.reported = report.state
            self._revision = None

    def _of_here(self, part: PartName, name: str) -> Reaction:
        """Return a reaction that this computer decides about.

        Raises:
            UnknownReactionError: The part has no reaction of this name.
            ActsElsewhereError: A device decides about it.
        """
        reaction = self._of(part, name)
        if reaction.elsewhere is not None:
            raise ActsElsewhereError.of_reaction(reaction.name, reaction.elsewhere)
        return reaction

    def _begin_afresh(self, reaction: Reaction, now: Instant) -> None:
        """Forget how often a reaction acted."""
        self._budgets.refill(reaction)
        if reaction.state is ReactionState.EXHAUSTED:
            reaction.is_exhausted = False
        self._kept.renew(reaction, now)
        self._views.note(reaction)
        self._revision = None

    def _follow_request(self, request: ModeRequest | TransitionRequest, now: Instant) -> None:
        """Judge anew: what is requested may come to rest, and what was not may be activated."""
        if self._reactions:
            model = self._parts.model
            ancestors = model.ancestors
            asked = {r.part for r in self._reactions if request.part in ancestors[r.part]}
            self._triggers.note_request({request.part, *asked})
            self._revision = None

    def _follow_backend(self, status: BackendStatus, now: Instant) -> None:
        self._revision = None

    def wake_at(self) -> Instant | None:
        """Return when time alone changes how a reaction stands."""
        if not self._reactions:
            return None
        times = (
            self._triggers.wake_at(),
            self._budgets.wake_at(),
            self._escalations.wake_at(),
            self._obstacles.deadlines.next(),
            self._moving.wake_at(),
        )
        return min((at for at in times if at is not None), default=None)

    def pass_time(self, now: Instant) -> None:
        """Note what is due by now."""
        if not self._reactions:
            return
        is_due = self._triggers.pass_time(now)
        for reaction in self._budgets.pass_time(now):
            self._kept.renew(reaction, now)
            self._views.note(reaction)
        late = self._escalations.wake_at()
        is_due |= late is not None and late <= now
        while self._obstacles.deadlines.pop_due(now) is not None:
            is_due = True
        self._moving.pass_time(now)
        if is_due:
            self._revision = None

    def settle(self, now: Instant) -> bool:
        """Decide anew if something changed; return whether that changed anything."""
        if not self._reactions:
            return False
        self._follow_stop(now)
        has_moved = self._moving.follow_requests()
        if not self._is_due():
            return self._moving.go_on(now) or has_moved
        self._revision = self._conditions_revision()
        has_moved |= self._judge(now)
        return self._moving.go_on(now) or has_moved

    def _is_due(self) -> bool:
        was_waiting, self._was_waiting = self._was_waiting, self._parts.awaits_devices
        if self._revision != self._conditions_revision() or was_waiting is not self._was_waiting:
            return True
        if self._escalations.awaited and (self._outbox.vehicle_changed or self._outbox.parts):
            return True
        return not self._outbox.parts.isdisjoint(self._moving.parts)

    def _conditions_revision(self) -> int:
        return self._reactions[0].conditions.leaf_revision

    def _follow_stop(self, now: Instant) -> None:
        """Let what ESTOP prevents, or what its end makes true, activate nothing."""
        is_stopped = self._health.is_stopped
        if is_stopped is not self._was_stopped:
            self._revision = None
            if not is_stopped:
                self._stop_ended_at = now
        self._was_stopped = is_stopped
        if is_stopped or self._stop_ended_at == now:
            self._triggers.follow_stop(now, is_stopped=is_stopped)
            self._moving.follow_stop(now, is_stopped=is_stopped)

    # --- what follows ----------------------------------------------------------------------------

    def _judge(self, now: Instant) -> bool:
        """Decide, and carry out what was decided; return whether anything changed."""
        self._triggers.review(now)
        called = self._called(now)
        outcome = self._contest.decide(called, lambda each: each.is_exhausted, now)
        changed = self._carry_out(outcome, now)
        self._parts.claims.set([claim_of(reaction) for reaction in outcome.claiming])
        for reaction in self._reactions:
            self._views.explain(reaction)
        for reaction in self._escalations.judge(now):
            self._kept.renew(reaction, now)
            self._revision, changed = None, True
        return changed

    def _called(self, now: Instant) -> list[Reaction]:
        """Return the reactions that something calls for; escalations end with their reaction."""
        while True:
            called: list[Reaction] = []
            others: list[Reaction] = []
            for each in self._reactions:
                is_called = self._is_called(each)
                (called if is_called else others).append(each)
            withdrawn = [each for each in others if self._escalations.withdraw(each)]
            for each in withdrawn:
                self._kept.renew(each, now)
            if not withdrawn:
                return called

    def _is_called(self, reaction: Reaction) -> bool:
        if reaction.elsewhere is not None:
            return reaction.reported is not ReactionState.IDLE
        return self._triggers.calls_for(reaction) or reaction.is_exhausted

    def _carry_out(self, outcome: Outcome, now: Instant) -> bool:
        """Let reactions begin and end; what makes a robot safer comes first."""
        changed = []
        for reaction in self._reactions:
            standing = outcome.standings.get(reaction)
            if standing is None:
                is_pending = self._triggers.pending_since(reaction) is not None
                is_armed = reaction.arm is not Arm.DISARMED and reaction.elsewhere is None
                standing = _PENDING if is_pending and is_armed else _IDLE
            reaction.kept_from = standing.kept_from
            if standing.state is not reaction.state:
                changed.append((reaction, standing))
        origin = self._outbox.record_input() if changed else 0
        changed.sort(key=lambda each: each[1].state is not ReactionState.ACTING)
        for reaction, standing in changed:
            self._change(reaction, standing, origin, now)
        self._effects.begin(self._reactions, now)
        has_moved = self._moving.move(outcome.moving, now)
        self._effects.end(self._reactions, now)
        return bool(changed) or has_moved

    def _change(self, reaction: Reaction, standing: Standing, origin: int, now: Instant) -> None:
        """Let a reaction stand differently, and tell.

        Args:
            reaction: The reaction.
            standing: How it is to stand.
            origin: Id of the event of the current input.
            now: The current time.
        """
        was, state = reaction.state, standing.state
        begun = self._triggers.begun(reaction)
        # What time alone began was caused by the reading with which its condition began to hold.
        is_new = begun is not None and was in (ReactionState.IDLE, ReactionState.PENDING)
        cause = begun.cause if begun is not None and is_new else origin
        self._effects.tell(reaction, standing, cause, now)
        reaction.state = state
        reaction.since = begun.since if state is ReactionState.PENDING and begun else now
        reaction.is_exhausted = state is ReactionState.EXHAUSTED
        if reaction.elsewhere is None:
            if reaction.is_in_effect:
                self._budgets.note(reaction, now)
                self._triggers.note_in_effect(reaction)
            if state is ReactionState.ACTING:
                self._escalations.begin(reaction, now)
            elif was is ReactionState.ACTING:
                self._escalations.end(reaction)
        if state in (ReactionState.IDLE, ReactionState.PENDING):
            self._triggers.forget(reaction)
        self._kept.renew(reaction, now)
        self._views.note(reaction)

    @property
    def actors(self) -> list[Actor]:
        """Return in whose names reactions move parts."""
        return [reaction.actor for reaction in self._reactions]

    def ask_elsewhere(self) -> None:
        """Note that another computer knows what was requested of the parts."""
        self._obstacles.asks_elsewhere = True

    def let_act(self, *, acting: bool) -> None:
        """Let all reactions act, or only tell when they would: another computer's word counts."""
        for reaction in self._reactions:
            if reaction.is_left is acting:
                reaction.is_left = not acting
                self._views.note(reaction)
                self._revision = None

    # --- what can be seen ------------------------------------------------------------------------

    def view(self, part: PartName, name: str) -> ReactionView:
        """Return one reaction; the same object until it changes.

        Raises:
            UnknownReactionError: The part has no reaction of this name.
        """
        return self._views.of(self._of(part, name))

    def view_of(self, key: str) -> ReactionView:
        """Return one reaction, as `Outputs.reactions` names it."""
        return self._views.of_key(key)

    def views(self) -> Iterator[ReactionView]:
        """Yield all reactions, in the order of the file."""
        return (self._views.of(reaction) for reaction in self._reactions)

    # --- inside ----------------------------------------------------------------------------------

    def _of(self, part: PartName, name: str) -> Reaction:
        reaction = self._by_name.get(name)
        if reaction is None or reaction.part != part:
            own: Iterable[str] = (each.name for each in self._reactions if each.part == part)
            raise UnknownReactionError(f"reaction of {part}", name, tuple(own))
        return reaction
