"""Whose word counts at a device: the supervisor's, or while it is cut off what `offline` says.

The link has judged before whether an order is of the supervisor's present session.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

from domain.actor import NOBODY, Actor
from domain.changes.admission import part_of
from domain.changes.changing import Changing
from domain.changes.pursuit import request_towards
from domain.commands import ActAlone, AnswerOrder, AskFacts, NodeCommand, TellReaction
from domain.computers import DeviceState
from domain.concern import Concern, Takers
from domain.devices.lead_view import LeadView, Word
from domain.devices.order_judgement import OrderJudgement, action_of, renumbered
from domain.devices.settings import LeadSettings
from domain.errors import (
    BackendUnavailableError,
    OfflineError,
    OwnedBySupervisorError,
    RefusedError,
)
from domain.events.event import Event
from domain.events.lead import (
    DeviceActsAlone,
    DeviceFollowsAgain,
    DeviceTargetLeft,
    OrderRefused,
    OrderTaken,
    SupervisorConnected,
    SupervisorLate,
    SupervisorLost,
)
from domain.findings import Blocker
from domain.health.health import Health
from domain.inputs import (
    ChangeRequest,
    ModeRequest,
    NodeAnswer,
    OrderReceived,
    ParametersRequest,
    SupervisorStatus,
    TaskRequest,
    TransitionRequest,
)
from domain.lifecycle import Transition
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.reaction_terms import ReactionState
from domain.reactions.reactions import Reactions
from domain.snapshot import ModeView
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant, seconds

MAX_UNANSWERED = 10_000
"""Orders that a node has yet to answer; of more, the oldest are forgotten. The supervisor has its
own deadlines."""

ORDER_WAITS = seconds(5)
"""How long an order towards rest waits at most for what was requested at the device: half of the
time that a step of the supervisor has by default."""

_TOLD = frozenset({ReactionState.ACTING, ReactionState.EXHAUSTED})
_FOLLOWED = frozenset({DeviceState.CONNECTED, DeviceState.LATE})


class _Order(NamedTuple):
    """An order that was passed on to a node."""

    request: int
    """The number that the supervisor gave it."""
    node: PartName


class _Waiting(NamedTuple):
    """An order towards rest, of a node that is busy on request of the device."""

    order: OrderReceived
    until: Instant
    cause: int
    """Id of the event that it was taken."""


class Lead(Concern):
    """Passes orders on, rejects what is the supervisor's to ask, and acts alone when cut off."""

    def __init__(
        self,
        settings: LeadSettings,
        parts: Parts,
        changing: Changing,
        reactions: Reactions,
        health: Health,
        outbox: Outbox,
        start: Instant,
    ) -> None:
        """Begin with nobody to follow.

        Args:
            settings: Which device this is, and what it does when it is cut off.
            parts: Targets and facts.
            changing: Begins changes.
            reactions: Act or not.
            health: Tells whether ESTOP is active.
            outbox: Receives events.
            start: The current time.
        """
        self._settings = settings
        self._parts = parts
        self._changing = changing
        self._reactions = reactions
        self._outbox = outbox
        self._judgement = OrderJudgement(parts, changing, health)
        self._supervisor = SupervisorStatus(DeviceState.NEVER_SEEN)
        self._word = Word.NOBODY
        self._since = start
        self._acts_at: Instant | None = None
        """When the device acts alone unless it is connected before; None: it does not."""
        self._unanswered: dict[int, _Order] = {}
        """By our number of the request."""
        self._waiting: dict[PartName, _Waiting] = {}
        """By node, the order that it is given once it is free."""
        self._view: LeadView | None = None
        self._told: dict[str, ReactionState] = {}
        """By reaction, how the supervisor was told that it stands."""
        reactions.let_act(acting=False)
        # What the supervisor requested is not a target here.
        reactions.ask_elsewhere()

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {
            SupervisorStatus: self._take_status,
            OrderReceived: self._take_order,
            NodeAnswer: self._take_answer,
            ModeRequest: self._check_request,
            TransitionRequest: self._check_request,
            ParametersRequest: self._check_request,
            TaskRequest: self._check_task,
        }

    def wake_at(self) -> Instant | None:
        """Return when the device acts alone, or an order has waited for long enough."""
        due = [waiting.until for waiting in self._waiting.values()]
        if self._acts_at is not None:
            due.append(self._acts_at)
        return min(due, default=None)

    def pass_time(self, now: Instant) -> None:
        """Act alone once the device has been cut off for long enough; refuse what waited so."""
        for node, waiting in list(self._waiting.items()):
            if waiting.until <= now:
                self._end_waiting(node, now)
        if self._acts_at is not None and self._acts_at <= now:
            self._acts_at = None
            self._act_alone(now)

    def settle(self, now: Instant) -> bool:
        """Tell which reactions act, if that changed, and give nodes that are free what waited."""
        if self._outbox.reactions:
            self._tell_reactions(all_of_them=False)
        free = [
            node
            for node, waiting in self._waiting.items()
            if self._judgement.busy(waiting.order.command) is None
        ]
        for node in free:
            self._end_waiting(node, now)
        return bool(free)

    # --- whom it follows -------------------------------------------------------------------------

    def _take_status(self, status: SupervisorStatus, now: Instant) -> None:
        """Follow the supervisor, or note that it is cut off; before it was connected, only wait."""
        before, self._supervisor = self._supervisor, status
        self._view = None
        self._tell(before, status, now)
        if before.incarnation != status.incarnation or status.state not in _FOLLOWED:
            # Another run counts its requests anew, and must not take an answer for its own.
            self._unanswered.clear()
            self._waiting.clear()
        if status.state in _FOLLOWED:
            if self._word is not Word.SUPERVISOR:
                self._follow(now)
        elif self._word is Word.SUPERVISOR:
            self._set_word(Word.CUT_OFF, now)
            is_counted = status.state is DeviceState.LOST  # From the last echo, by the link.
            offline = self._settings.offline
            self._acts_at = now + (self._settings.waits if is_counted else offline.after)

    def _tell(self, before: SupervisorStatus, status: SupervisorStatus, now: Instant) -> None:
        device, state = self._settings.device, status.state
        event: Event
        if state is DeviceState.CONNECTED:
            event = SupervisorConnected(device)
        elif state is DeviceState.LATE:
            event = SupervisorLate(device, status.reason)
        else:
            event = SupervisorLost(device, status.reason)
        self._outbox.begin(now, event)
        if state is not before.state and state is not DeviceState.NEVER_SEEN:
            self._outbox.record_input()

    def _follow(self, now: Instant) -> None:
        """End what the device pursued itself; what is stays as it is."""
        was_alone = self._word is Word.DEVICE
        self._acts_at = None
        self._set_word(Word.SUPERVISOR, now)
        # What a reaction moves goes on, since the reaction does.
        self._changing.drop_all("the supervisor is back", now, besides=self._reactions.actors)
        self._reactions.let_act(acting=True)
        self._tell_reactions(all_of_them=True)
        if was_alone:
            self._outbox.emit(DeviceFollowsAgain(self._settings.device))
            self._outbox.command(ActAlone(False))

    def _tell_reactions(self, *, all_of_them: bool) -> None:
        for view in self._reactions.views():
            state = view.state if view.state in _TOLD else ReactionState.IDLE
            if all_of_them or self._told.get(view.reaction, ReactionState.IDLE) is not state:
                self._told[view.reaction] = state
                self._outbox.command(TellReaction(view.part, view.reaction, state))

    def _set_word(self, word: Word, now: Instant) -> None:
        self._word, self._since, self._view = word, now, None

    # --- orders of the supervisor ----------------------------------------------------------------

    def _take_order(self, order: OrderReceived, now: Instant) -> None:
        """Pass an order on to its node, now or once that is free, or refuse it."""
        command = order.command
        node, action = command.node, action_of(command)
        if not isinstance(command, AskFacts):
            # The supervisor has one step of a node in flight: it has given up what it asked before.
            self._waiting.pop(node, None)
        refusal, busy = self._refusal(order), self._judgement.busy(command)
        waits = refusal is None and busy is not None and self._judgement.leads_to_rest(command)
        if refusal is None and not waits:
            refusal = busy
        if refusal is not None:
            self._outbox.begin(now, OrderRefused(node, action, refusal))
            self._outbox.record_input()
            self._outbox.command(AnswerOrder(command.request, node, False, refusal))
            return
        self._outbox.begin(now, OrderTaken(node, action))
        if waits:
            cause = self._outbox.record_input()
            self._waiting[node] = _Waiting(order, now + ORDER_WAITS, cause)
            return
        if not isinstance(command, AskFacts):
            self._outbox.record_input()
        self._pass_on(command)

    def _end_waiting(self, node: PartName, now: Instant) -> None:
        """Pass on what has waited for a node, or refuse it if the node is still busy."""
        order, _, cause = self._waiting.pop(node)
        command = order.command
        self._outbox.resume(now, cause, NOBODY)
        refusal = self._refusal(order) or self._judgement.busy(command)
        if refusal is not None:
            self._outbox.emit(OrderRefused(node, action_of(command), refusal))
        if refusal is not None or self._judgement.is_there(command):
            is_done = refusal is None
            self._outbox.command(AnswerOrder(command.request, node, is_done, refusal or ""))
            return
        self._pass_on(command)

    def _pass_on(self, command: NodeCommand) -> None:
        """Ask a node for what the supervisor wants of it."""
        node = command.node
        if not isinstance(command, AskFacts):
            self._parts.note_request(node)
            # A request of before, made here, is replaced by what the supervisor wants now.
            self._changing.forget_targets((node, *self._parts.model.ancestors[node]))
        request = self._outbox.next_request()
        self._unanswered[request] = _Order(command.request, node)
        if len(self._unanswered) > MAX_UNANSWERED:
            del self._unanswered[next(iter(self._unanswered))]
        self._outbox.command(renumbered(command, request))

    def _refusal(self, order: OrderReceived) -> str | None:
        """Return why an order is refused; None: it is not."""
        device = self._settings.device
        if order.command.node not in self._parts.model.nodes:
            return f"device {device} has no node {order.command.node}"
        if self._word is not Word.SUPERVISOR:
            return f"device {device} does not follow a supervisor"
        return self._judgement.refusal(order.command)

    def _take_answer(self, answer: NodeAnswer, now: Instant) -> None:
        """Tell the supervisor what a node says to an order."""
        order = self._unanswered.pop(answer.request, None)
        if order is not None:
            told = AnswerOrder(order.request, order.node, answer.accepted, answer.reason)
            self._outbox.command(told)

    # --- requests of people at the device --------------------------------------------------------

    def _check_request(self, request: ChangeRequest, now: Instant) -> None:
        """Reject a request that is the supervisor's to make.

        Raises:
            OwnedBySupervisorError: The supervisor is connected.
            OfflineError: It is not.
        """
        self.check(request)

    def check(self, request: ChangeRequest) -> None:
        """Reject a request that is the supervisor's to make; to deactivate is always possible.

        Raises:
            OwnedBySupervisorError: The supervisor is connected.
            OfflineError: It is not.
        """
        if isinstance(request, TransitionRequest) and request.transition is Transition.DEACTIVATE:
            return
        raise self._rejection(part_of(request))

    def restricted(self, part: PartName, view: ModeView) -> ModeView:
        """Return a mode as it can be requested at the device: it cannot be entered from here."""
        error = self._rejection(part)
        blocker = Blocker(error.code, error.message, (part,), since=self._since)
        return replace(view, can_enter=False, blockers=(blocker, *view.blockers))

    @staticmethod
    def available(transitions: Iterable[Transition]) -> tuple[Transition, ...]:
        """Return those transitions that can be requested at the device."""
        return tuple(each for each in transitions if each is Transition.DEACTIVATE)

    def _check_task(self, request: TaskRequest, now: Instant) -> None:
        raise self._rejection("the vehicle")

    def _rejection(self, what: str) -> RefusedError:
        if self._word is Word.SUPERVISOR:
            return OwnedBySupervisorError(what, self._settings.supervisor_at)
        return OfflineError(what, self._settings.device, self._supervisor.reason)

    # --- alone -----------------------------------------------------------------------------------

    def _act_alone(self, now: Instant) -> None:
        """Do what `offline` says, and nothing else."""
        offline, device = self._settings.offline, self._settings.device
        self._set_word(Word.DEVICE, now)
        actor = Actor(f"device {device}, acting alone")
        self._outbox.begin(now, DeviceActsAlone(device, offline.words), actor)
        cause = self._outbox.record_input()
        self._outbox.command(ActAlone(True))
        self._reactions.let_act(acting=offline.reactions)
        for part, target in offline.targets.items():
            self._outbox.resume(now, cause, actor)
            reason = self._pursue(part, target, actor, now)
            if reason is not None:
                self._outbox.resume(now, cause, actor)
                self._outbox.emit(DeviceTargetLeft(device, part, target, reason))

    def _pursue(
        self, part: PartName, target: StateAndMode, actor: Actor, now: Instant
    ) -> str | None:
        """Request a target; return why that is not possible, or None."""
        if self._parts.stays_at_rest(part, target):
            return f"{part} was brought to rest on request"
        request = request_towards(self._parts.model, self._parts.facts, part, target, actor)
        try:
            self._changing.take_request(request, now)
        except (BackendUnavailableError, RefusedError) as refusal:
            return refusal.message
        return None

    # --- what can be seen ------------------------------------------------------------------------

    def view(self) -> LeadView:
        """Return whose word counts; the same object until it changes."""
        if self._view is None:
            supervisor = self._supervisor
            self._view = LeadView(
                self._settings.device,
                self._word,
                supervisor.state,
                self._since,
                supervisor.reason,
                self._settings.offline.words,
            )
        return self._view
