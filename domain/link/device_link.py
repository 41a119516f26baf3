"""A device's end of the link: whom it follows, its session, and what it tells of its parts."""

from collections.abc import Callable, Iterable
from dataclasses import replace

from domain.commands import (
    ActAlone,
    AnswerOrder,
    AskRelease,
    LinkCommand,
    NodeCommand,
    TellReaction,
    TellStops,
)
from domain.computers import SUPERVISOR, ComputerName, DeviceState, Incarnation, Session
from domain.inputs import NodeAnswer, OrderReceived, ReactionReport, SupervisorStatus
from domain.link.drops import Drop, Drops
from domain.link.gathering import Gathering
from domain.link.messages import Beat, Message, NodeOrder, Terms, Told
from domain.link.orders import Orders
from domain.link.outputs import LinkOutputs
from domain.link.ownership import Ownership
from domain.link.peer import Heard, Own, Peer, Said
from domain.link.peers import Peers
from domain.link.reporting import Reporting
from domain.link.settings import LinkSettings, Owned
from domain.timebase import Instant


class DeviceLink:
    """Deterministic: messages, commands of the core, facts and time in; messages and inputs out.

    `now` never decreases from call to call. Whatever is due happens before what is called for.
    """

    def __init__(
        self,
        name: ComputerName,
        terms: Terms,
        others: Iterable[ComputerName],
        owned: Owned,
        incarnation: Incarnation,
        new_id: Callable[[], str],
        start: Instant,
        settings: LinkSettings | None = None,
    ) -> None:
        """Begin without having heard of a supervisor; the first beats are due at once.

        Args:
            name: Of this device.
            terms: What its supervisor must agree on.
            others: The other devices of the robot.
            owned: What belongs to this device.
            incarnation: Of this process; random.
            new_id: Returns a new random id: 32 hexadecimal digits.
            start: The current time.
            settings: Times of the link.
        """
        settings = settings or LinkSettings()
        own = Own(name, incarnation, terms)
        distant = [other for other in others if other not in (name, SUPERVISOR)]
        self.drops = Drops()
        self.peers = Peers(own, settings, (SUPERVISOR,), distant, self._says, start)
        self._supervisor = self.peers[SUPERVISOR]
        self._own = own
        self._new_id = new_id
        self._ownership = Ownership(owned)
        self._session = Session(new_id())
        self._orders = Orders(self._ownership.nodes)
        self._reporting = Reporting(own, settings)
        self._autonomous = False
        self._told = SupervisorStatus(DeviceState.NEVER_SEEN)

    @property
    def session(self) -> Session:
        """Return the session; commands of another one are not carried out."""
        return self._session

    def wake_at(self) -> Instant:
        """Return when something is due next."""
        reports = self._reporting.wake_at()
        beats = self.peers.wake_at()
        return beats if reports is None else min(beats, reports)

    def pass_time(self, now: Instant) -> LinkOutputs:
        """Do all that is due up to `now`."""
        gathering = Gathering()
        self._catch_up(now, gathering)
        self._report(now, gathering)
        return gathering.take()

    def note(self, told: Told, now: Instant) -> None:
        """Note a fact about a node or a signal of this device; `pass_time` tells the supervisor.

        Answers of nodes are not told: the core answers commands, by `AnswerOrder`.
        """
        own = self._ownership.admit(told)
        if own is not None and not isinstance(own, NodeAnswer):
            self._reporting.note(own, now, is_heard=self._supervisor.lease.is_held)

    def hear(self, sender: ComputerName, message: Message, now: Instant) -> LinkOutputs:
        """Take a message of another computer.

        Args:
            sender: As the transport knows it; what says that it is from somebody else is dropped.
            message: What it says.
            now: When it arrived.
        """
        gathering = Gathering()
        self._catch_up(now, gathering)
        if message.sender != sender or sender == self._own.name:
            self.drops.count(Drop.SENDER)
        elif isinstance(message, Beat):
            self._hear_beat(message, now, gathering)
        elif isinstance(message, NodeOrder) and sender == SUPERVISOR:
            self._hear_order(message, now, gathering)
        else:
            self.drops.count(Drop.UNEXPECTED)
        self._tell_status(now, gathering)
        return gathering.take()

    def tell(self, command: NodeCommand | LinkCommand, now: Instant) -> LinkOutputs:
        """Take a command of the core; commands for nodes are none of the link."""
        gathering = Gathering()
        self._catch_up(now, gathering)
        match command:
            case TellStops() | AskRelease():
                self.peers.tell(command, now, gathering)
            case AnswerOrder():
                self._answer(command, now)
            case TellReaction(part=part, reaction=reaction, state=state):
                self._say(ReactionReport(part, reaction, state), now)
            case ActAlone(autonomous=autonomous) if autonomous is not self._autonomous:
                self._autonomous = autonomous
                self.peers.beat((self._supervisor,), now, gathering)
            case _:
                pass
        return gathering.take()

    # --- what is heard ---------------------------------------------------------------------------

    def _catch_up(self, now: Instant, gathering: Gathering) -> None:
        if self._supervisor in self.peers.pass_time(now):
            # Nothing that was sent before is carried out from here on.
            self._renew_session()
            self._reporting.stop()
        self._tell_status(now, gathering)
        self.peers.beat_if_due(now, gathering)

    def _hear_beat(self, beat: Beat, now: Instant, gathering: Gathering) -> None:
        found = self.peers.hear(beat, now, gathering)
        if found is None:
            self.drops.count(Drop.SENDER)
            return
        peer, heard = found
        if heard is Heard.NOTHING:
            self.drops.count(Drop.OLD)
        elif peer is self._supervisor:
            self.peers.take_passed_on(beat, now, gathering)
            self._orders.follow(beat.incarnation)
            self._follow(beat, heard, now, gathering)

    def _follow(self, beat: Beat, heard: Heard, now: Instant, gathering: Gathering) -> None:
        """Do what a beat of the supervisor that is followed asks for."""
        if heard is Heard.LEASE:
            self._reporting.begin(now)
        if beat.renew == self._session:
            self._renew_session()
            self.peers.beat((self._supervisor,), now, gathering)
            self._reporting.ask_all(now, at_once=True)
        elif beat.heard == self._own.incarnation and beat.session != self._session:
            # It has not heard everything under this session yet.
            self._reporting.ask_all(now, at_once=False)

    def _hear_order(self, order: NodeOrder, now: Instant, gathering: Gathering) -> None:
        if not self._orders.is_next(order):
            self.drops.count(Drop.OLD)
            return
        refusal = self._orders.find_refusal(order, self._session)
        lease = self._supervisor.lease
        if not lease.is_held:
            refusal = f"device {self._own.name} was cut off from the supervisor"
        elif not lease.was_sent_lately(order.heard_seq, now):
            refusal = refusal or "it was on its way for too long"
        if refusal is None:
            self._orders.take(order)
            gathering.give(OrderReceived(order.command))
            return
        self.drops.count(Drop.REFUSED)
        request, node = order.command.request, order.command.node
        self._say(NodeAnswer(request, node, False, refusal), now)

    # --- what is said ----------------------------------------------------------------------------

    def _answer(self, answer: AnswerOrder, now: Instant) -> None:
        if self._orders.is_taken(answer.request):
            self._say(NodeAnswer(answer.request, answer.node, answer.accepted, answer.reason), now)

    def _say(self, told: Told, now: Instant) -> None:
        self._reporting.note(told, now, is_heard=self._supervisor.lease.is_held)

    def _report(self, now: Instant, gathering: Gathering) -> None:
        for report in self._reporting.reports(self._session, now):
            gathering.send(SUPERVISOR, report)

    def _renew_session(self) -> None:
        self._session = Session(self._new_id())

    def _says(self, peer: Peer, now: Instant) -> Said:
        if peer is not self._supervisor:
            return Said()
        return Said(session=self._session, autonomous=self._autonomous)

    def _tell_status(self, now: Instant, gathering: Gathering) -> None:
        """Give the core how the connection to the supervisor is, if that changed."""
        peer, told = self._supervisor, self._told
        state = peer.state()
        is_same = state is told.state and state is not DeviceState.CONFLICT
        reason = told.reason if is_same else peer.reason(now)
        process = peer.incarnation if peer.lease.is_held else told.incarnation
        status = replace(told, state=state, reason=reason, incarnation=process)
        if status != told:
            self._told = status
            gathering.give(status)
