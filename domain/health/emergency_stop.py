"""The emergency stop: a latch that only a person releases, never a reading."""

from collections.abc import Iterable
from dataclasses import replace

from domain.actor import SERVICE, Actor
from domain.commands import AskRelease, TellStops
from domain.computers import SUPERVISOR, ComputerName, DeviceState, PeerStop, StopId, computer_words
from domain.concern import Concern, Takers
from domain.events.health import (
    EmergencyStopEngaged,
    EmergencyStopReleased,
    EmergencyStopStandstill,
    PeerStopEngaged,
    PeerStopReleased,
    StopReleaseAsked,
)
from domain.events.service import NotRestored
from domain.health.engaged_stops import EngagedStops
from domain.health.health import Health
from domain.inputs import (
    DeviceStatus,
    EmergencyStopRequest,
    PeerStops,
    Restored,
    StopsReleased,
    SupervisorStatus,
)
from domain.kept import KeptEmergencyStop, KeptPeerStops
from domain.outbox import Outbox
from domain.snapshot import EmergencyStopView
from domain.timebase import Instant

_RELEASED = EmergencyStopView(engaged=False, by=None, reason=None, since=None, standstill_at=None)
_PREFIX = "stop"
_HEARD = frozenset({DeviceState.CONNECTED, DeviceState.LATE})


class EmergencyStop(Concern):
    """The latch: which stops are engaged, who engaged them, why and since when.

    A computer has at most one stop of its own, and engaging is idempotent: a repetition keeps the
    first actor. The stops of its peers stand beside it, and the robot is stopped while there is
    any. Each is ended by its own computer alone, which peers ask to do so by naming it: what nobody
    saw is not released. All are kept over a restart of the service; a robot starts released if
    there was no earlier run.

    Source: ISO 13850, which requires a stop to remain until it is reset manually.
    """

    def __init__(self, health: Health, outbox: Outbox, peers: Iterable[ComputerName] = ()) -> None:
        """Begin without a stop.

        Args:
            health: Raises ESTOP.
            outbox: Receives events and commands.
            peers: The other computers of the robot; empty: it has one.
        """
        self._health = health
        self._outbox = outbox
        self._stops = EngagedStops(peers)
        self._run = ""
        """Name of this run, so that no id is used twice, whatever became of the store."""
        self._ended = _RELEASED
        """How it looks while nothing is engaged: who released it last."""
        self._view = _RELEASED
        self._has_news = False
        """A peer can be heard, or cannot any more, and nothing followed from that yet."""

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {
            EmergencyStopRequest: self.take_request,
            PeerStops: self.take_stops_of_peer,
            StopsReleased: self.take_released,
            DeviceStatus: self._take_device_status,
            SupervisorStatus: self._take_supervisor_status,
            Restored: self.restore,
        }

    def settle(self, now: Instant) -> bool:
        """Show which peers can be heard; nobody else reacts to that."""
        if self._has_news:
            self._has_news = False
            self._renew(now)
        return False

    # --- requests --------------------------------------------------------------------------------

    def take_request(self, request: EmergencyStopRequest, now: Instant) -> None:
        """Engage or release the stop; a repetition changes nothing."""
        if request.engaged:
            self._engage(request.actor, request.reason, None, now)
        else:
            self._release(request, now)

    def engage_for(self, actor: Actor, reason: str, cause: int, now: Instant) -> None:
        """Engage the stop in the name of a reaction; a person releases it."""
        self._engage(actor, reason, cause, now)

    def _engage(self, actor: Actor, reason: str, cause: int | None, now: Instant) -> None:
        if self._stops.own is not None:
            return
        self._outbox.begin(now, EmergencyStopEngaged(reason), actor, cause)
        identity = self._id_of(self._outbox.record_input())
        self._set_own(PeerStop(identity, actor.label, reason, now), now)

    def _release(self, request: EmergencyStopRequest, now: Instant) -> None:
        """End the own stop, and ask peers to end theirs; one that cannot be heard is not asked."""
        own, named = self._stops.own, request.stops
        asked = self._stops.to_ask(named)
        if own is not None and (named is None or own.id in named):
            self._end_own(request.actor, request.reason, now)
        for computer, stops in asked.items():
            self._outbox.begin(now, StopReleaseAsked(computer, stops), request.actor)
            self._outbox.record_input()
            self._outbox.command(AskRelease(computer, stops))
            self._stops.note_asked(computer, stops)
        self._renew(now)

    def _end_own(self, actor: Actor, reason: str, now: Instant) -> None:
        released = EmergencyStopReleased(reason, self._stops.stopping_peers or None)
        self._outbox.begin(now, released, actor)
        self._outbox.record_input()
        self._ended = replace(_RELEASED, by=actor.label, reason=reason, since=now)
        self._set_own(None, now)

    def _set_own(self, stop: PeerStop | None, now: Instant) -> None:
        self._stops.own = stop
        self._keep_own()
        self._tell_peers()
        self._renew(now)

    # --- other computers -------------------------------------------------------------------------

    def take_stops_of_peer(self, told: PeerStops, now: Instant) -> None:
        """Take which stops another computer has; what is new stops before what is gone releases.

        Whoever is not dealt with can stop the robot, but ends no stop except its own.
        """
        computer, before = told.computer, tuple(self._stops.of(told.computer))
        if told.ended is None or told.is_dealt_with:
            self._stops.note_told(computer)
        after = {stop.id: stop for stop in told.stops}
        for stop in after.values():
            if stop.id not in before:
                event = PeerStopEngaged(computer, stop.id, stop.by, stop.reason)
                self._outbox.begin(now, event)
                self._outbox.record_input()
                self._stops.add(computer, replace(stop, since=min(stop.since, now)))
                self._renew(now)
        for identity in before:
            if identity not in after and (told.ended is None or identity in told.ended):
                self._take_end(computer, identity, now)
        if before != tuple(self._stops.of(computer)):
            self._keep_of_peer(computer)
        self._renew(now)

    def _take_end(self, computer: ComputerName, stop: StopId, now: Instant) -> None:
        """Take that a peer released a stop of its own."""
        self._outbox.begin(now, PeerStopReleased(computer, stop))
        self._outbox.record_input()
        self._stops.remove(computer, stop)
        self._ended = replace(_RELEASED, by=computer_words(computer), reason="", since=now)
        self._renew(now)

    def take_released(self, released: StopsReleased, now: Instant) -> None:
        """End the own stop if somebody at another computer released it."""
        own = self._stops.own
        if own is not None and own.id in released.stops:
            where = computer_words(released.computer)
            self._end_own(Actor(where), f"released at {where}", now)

    def _take_device_status(self, status: DeviceStatus, now: Instant) -> None:
        self._note_connection(status.device, status.state)

    def _take_supervisor_status(self, status: SupervisorStatus, now: Instant) -> None:
        self._note_connection(SUPERVISOR, status.state)

    def _note_connection(self, computer: ComputerName, state: DeviceState) -> None:
        """Note how a connection is; another concern owns the input, and what follows waits."""
        if computer in self._stops.peers:
            self._stops.note_connection(computer, is_heard=state in _HEARD)
            self._has_news = True

    def _tell_peers(self) -> None:
        if self._stops.peers:
            self._outbox.command(self.told())

    def told(self) -> TellStops:
        """Return what the other computers are to be told."""
        return TellStops(() if self._stops.own is None else (self._stops.own,))

    # --- over a restart --------------------------------------------------------------------------

    def restore(self, restored: Restored, now: Instant) -> None:
        """Be as an earlier run left it, or engaged if nobody can tell how that was."""
        self._run = restored.run
        own = next((item for item in restored.kept if isinstance(item, KeptEmergencyStop)), None)
        if restored.stop_because:
            self._outbox.emit(EmergencyStopEngaged(restored.stop_because))
            own = KeptEmergencyStop(True, SERVICE.label, restored.stop_because, now)
        if own is not None:
            self._restore_own(own, now)
        for kept in restored.kept:
            if isinstance(kept, KeptPeerStops):
                self._restore_of_peer(kept, now)
        self._tell_peers()
        self._renew(now)

    def _restore_own(self, kept: KeptEmergencyStop, now: Instant) -> None:
        since = min(kept.since, now)
        if not kept.engaged:
            self._ended = replace(_RELEASED, by=kept.by, reason=kept.reason, since=since)
            return
        # Without an id it is of a release that had none, or new.
        identity = StopId(kept.id) or self._id_of(self._outbox.record_input())
        self._stops.own = PeerStop(identity, kept.by, kept.reason, since)
        if not kept.id:
            self._keep_own()

    def _restore_of_peer(self, kept: KeptPeerStops, now: Instant) -> None:
        if kept.computer not in self._stops.peers:
            # Nobody could ever release it.
            self._outbox.forget(KeptPeerStops, kept.name)
            what = f"the emergency stop at {computer_words(kept.computer)}"
            self._outbox.emit(NotRestored(what, "the robot has no such computer any more"))
            return
        for stop in kept.stops:
            self._stops.add(kept.computer, replace(stop, since=min(stop.since, now)))

    def _keep_own(self) -> None:
        stop, ended = self._stops.own, self._ended
        if stop is not None:
            kept = KeptEmergencyStop(True, stop.by, stop.reason, stop.since, stop.id)
        else:
            kept = KeptEmergencyStop(False, ended.by or "", ended.reason or "", ended.since or 0)
        self._outbox.keep(kept)

    def _keep_of_peer(self, computer: ComputerName) -> None:
        if stops := tuple(self._stops.of(computer).values()):
            self._outbox.keep(KeptPeerStops(computer, stops))
        else:
            self._outbox.forget(KeptPeerStops, computer)

    def _id_of(self, event: int) -> StopId:
        """Return the id of the stop that an event engaged; a robot of one computer needs no run."""
        prefix = self._run if self._run and self._stops.peers else _PREFIX
        return StopId(f"{prefix}-{event}")

    # --- the vehicle -----------------------------------------------------------------------------

    def note_standstill(self, now: Instant) -> None:
        """Record the first standstill since the stop was engaged, or since it moved after that."""
        if self._view.engaged and self._view.standstill_at is None:
            self._view = replace(self._view, standstill_at=now)
            self._outbox.emit(EmergencyStopStandstill())

    def note_motion(self) -> None:
        """Record that the vehicle moves, or may move, though the stop is engaged."""
        if self._view.standstill_at is not None:
            self._view = replace(self._view, standstill_at=None)

    # --- what can be seen ------------------------------------------------------------------------

    def view(self) -> EmergencyStopView:
        """Return the latch; the same object until it changes."""
        return self._view

    def _renew(self, now: Instant) -> None:
        """Let the view and ESTOP follow from the stops."""
        view = self._engaged_view() if self._stops.is_any else self._ended
        if view != self._view:
            self._view = view
        self._health.press_stop(self._stops.causes(), now)

    def _engaged_view(self) -> EmergencyStopView:
        stops = self._stops.views()
        return EmergencyStopView(
            engaged=True,
            by=stops[0].by,
            reason=stops[0].reason,
            since=stops[0].since,
            standstill_at=self._view.standstill_at,
            stops=stops,
            waits_for=self._stops.waited_for,
            not_heard=self._stops.not_heard,
        )
