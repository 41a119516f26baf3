"""A device, as the supervisor knows it over the link.

It is connected once three things are true of one process: the lease holds, it has another session
than the one that was lost, and it told all facts under that session. So it is connected and known
at one moment.
"""

from dataclasses import replace

from domain.commands import NodeCommand
from domain.computers import DeviceState, Incarnation, Session
from domain.inputs import DeviceStatus, NodeAnswer
from domain.link.device_facts import DeviceFacts
from domain.link.gathering import Gathering
from domain.link.messages import Beat, NodeOrder, Report
from domain.link.ownership import Ownership, with_stamps
from domain.link.peer import Own, Peer, Said
from domain.link.pieces import Pieces
from domain.link.settings import LinkSettings, Owned
from domain.timebase import Instant


class RemoteDevice:
    """The session, the facts and the state of one device."""

    def __init__(
        self, peer: Peer, own: Own, owned: Owned, settings: LinkSettings, start: Instant
    ) -> None:
        """Begin without having heard of it.

        Args:
            peer: Who answers by its name.
            own: What the supervisor says of itself.
            owned: What belongs to the device.
            settings: Times of the link.
            start: The current time.
        """
        self.peer = peer
        self.is_connected = False
        self._own = own
        self._nodes = owned.nodes
        self._ownership = Ownership(owned)
        self._facts = DeviceFacts(settings.lost)
        self._missed_from = start + settings.lost
        """When its nodes count as unreachable, if it was not connected until then."""
        self._are_unreachable = False
        """Whether the core was told that its nodes are unreachable."""
        self._process: Incarnation | None = None
        self._session: Session | None = None
        self._lost_session: Session | None = None
        """The session that commands carried before the loss; the device is to replace it."""
        self._report_seq = 0
        self._pieces = Pieces()
        self._order_seq = 0
        self._told = DeviceStatus(peer.name, DeviceState.NEVER_SEEN)
        self._was_connected = False
        self._autonomous = False

    # --- what can be seen ------------------------------------------------------------------------

    def says(self) -> Said:
        """Return what a beat for the device says of its session."""
        if self.is_connected:
            return Said(session=self._session)
        return Said(renew=self._lost_session)

    # --- what happens ----------------------------------------------------------------------------

    def take_beat(self, beat: Beat, now: Instant, gathering: Gathering) -> None:
        """Take a beat of the process that is dealt with, if it deals with this supervisor."""
        if beat.heard != self._own.incarnation:
            return
        if beat.incarnation != self._process:
            self._process, self._session = beat.incarnation, None
            self._report_seq = 0
        if beat.session != self._session:
            self._session = beat.session
            self._begin_anew()
        self._autonomous = beat.autonomous
        self._connect_if_ready(now, gathering)

    def take_report(self, report: Report, now: Instant, gathering: Gathering) -> bool:
        """Take a report; return whether it counts. One that does not is out of date."""
        is_of_process = report.incarnation == self._process
        if not is_of_process or not self._is_present(report) or report.seq <= self._report_seq:
            return False
        whole = self._pieces.add(report)
        if whole is None:
            return True
        if whole.seq != self._report_seq + 1:
            self._facts.note_gap()
        self._report_seq = whole.seq
        self._take_whole(whole, now, gathering)
        return True

    def _take_whole(self, report: Report, now: Instant, gathering: Gathering) -> None:
        own = (self._ownership.admit(told) for told in report.items)
        items = [with_stamps(told, now) for told in own if told is not None]
        if not self.is_connected:
            self._facts.note(items, now, is_complete=report.complete)
            self._connect_if_ready(now, gathering)
            return
        for told in self._facts.take(items, now, is_complete=report.complete):
            gathering.give(told)

    def lose(self) -> None:
        """Note that the lease ended."""
        if self.is_connected:
            self.is_connected = False
            self._lost_session = self._session
            self._facts.begin_anew()

    def tell_status(self, now: Instant, gathering: Gathering) -> None:
        """Give the core how the connection is, if that changed.

        Its nodes become unreachable after the device is lost, and are known before it is connected:
        so that none of them is ever missing for a reason of its own.
        """
        is_missed = self._was_connected or now >= self._missed_from
        status = self._status(now)
        if status != self._told and (is_missed or status.state is not DeviceState.NEVER_SEEN):
            self._told = status
            gathering.give(status)
        if is_missed and not self.is_connected and not self._are_unreachable:
            self._are_unreachable = True
            for told in self._facts.give_unreachable(self._nodes, now):
                gathering.give(told)

    def order(self, command: NodeCommand, now: Instant, gathering: Gathering) -> None:
        """Send a command, or answer in the name of the device that it is not sent."""
        if not self.is_connected or self._session is None:
            reason = self._reason(now)
            gathering.give(NodeAnswer(command.request, command.node, False, reason))
            return
        self._order_seq += 1
        own, session = self._own, self._session
        seq, echo = self._order_seq, self.peer.heard_seq
        order = NodeOrder(own.name, own.incarnation, seq, session, command, echo)
        gathering.send(self.peer.name, order)

    # --- the connection --------------------------------------------------------------------------

    def _is_present(self, report: Report) -> bool:
        """Tell whether a report was made under the session that is known."""
        return report.session is not None and report.session == self._session

    def _begin_anew(self) -> None:
        """Expect all facts again, under another session.

        A connected device stays connected: it lost us for a moment, and we did not lose it.
        """
        if self.is_connected:
            self._facts.note_gap()
        else:
            self._facts.begin_anew()

    def _connect_if_ready(self, now: Instant, gathering: Gathering) -> None:
        is_ready = self.peer.lease.is_held and self._facts.is_complete
        if not is_ready or self.is_connected or self._session in (None, self._lost_session):
            return
        self.is_connected = self._was_connected = True
        self._are_unreachable = False
        self._lost_session = None
        for told in self._facts.give_all(now):
            gathering.give(told)

    def _state(self) -> DeviceState:
        state = self.peer.state()
        if self.is_connected or state is DeviceState.CONFLICT:
            return state
        return DeviceState.LOST if self._was_connected else DeviceState.NEVER_SEEN

    def _status(self, now: Instant) -> DeviceStatus:
        """Return how the connection is; of a device that is not connected, as it was last."""
        state, told, refused = self._state(), self._told, self.peer.refused
        if not self.is_connected:
            same = state is told.state and (told.reason or now < self._missed_from)
            reason = (
                told.reason if same and state is not DeviceState.CONFLICT else self._reason(now)
            )
            return replace(told, state=state, reason=reason, refused=refused)
        terms = self.peer.terms
        return DeviceStatus(
            told.device,
            state,
            told.reason if state is told.state else self._reason(now),
            self._process,
            self._session,
            (terms.version if terms is not None else "") or None,
            self._autonomous,
            refused,
        )

    def _reason(self, now: Instant) -> str:
        """Return why the device is not connected, or late; empty: neither."""
        lease = self.peer.lease
        if lease.is_held and not self.is_connected:
            return f"{self.peer.words} has not told yet how its nodes are"
        return self.peer.reason(now)
