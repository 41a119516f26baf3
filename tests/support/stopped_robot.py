"""A robot of which nothing but its emergency stop is of interest, on one of its computers."""

from domain.actor import Actor
from domain.commands import Command
from domain.computers import ComputerName, PeerStop, StopId, StopView
from domain.events.event import RecordedEvent
from domain.health.emergency_stop import EmergencyStop
from domain.health.health import Health
from domain.health.signals import default_signals
from domain.inputs import (
    DeviceStatus,
    EmergencyStopRequest,
    PeerStops,
    Restored,
    StopsReleased,
    SupervisorStatus,
)
from domain.kept import Kept
from domain.outbox import Outbox
from domain.restart import Restart
from domain.snapshot import EmergencyStopView
from domain.timebase import Instant

ARM, BASE = ComputerName("arm"), ComputerName("base")
RELEASED = EmergencyStopView(engaged=False, by=None, reason=None, since=None, standstill_at=None)


def engaged(
    by: str, reason: str, since: Instant, *, stop: str, standstill_at: Instant | None = None
) -> EmergencyStopView:
    """Return the latch while nothing but a stop of this computer is engaged."""
    stops = (StopView(StopId(stop), None, by, reason, since),)
    return EmergencyStopView(True, by, reason, since, standstill_at, stops)


class Robot:
    """A robot of which nothing but its emergency stop is of interest."""

    def __init__(self, now: Instant = 0, peers: tuple[ComputerName, ...] = ()) -> None:
        self.now = now
        self.commands: list[Command] = []
        """What was commanded in the last step."""
        self.words: list[str] = []
        """What was told in the last step."""
        self.kept: list[Kept | None] = []
        """What was kept in the last step."""
        self.store: dict[tuple[type[Kept], str], Kept] = {}
        """All that is kept."""
        self.outbox = Outbox()
        self.health = Health(default_signals(), self.outbox, now)
        self.stop = EmergencyStop(self.health, self.outbox, peers)

    def engage(self, by: str, reason: str, now: int) -> list[str]:
        self.stop.take_request(EmergencyStopRequest(True, reason, Actor(by)), now)
        return self._told()

    def release(self, by: str, reason: str, now: int, *stops: str) -> list[str]:
        """Release these stops; none named: all that are known."""
        return self.release_named(by, reason, now, tuple(map(StopId, stops)) or None)

    def release_named(
        self, by: str, reason: str, now: int, named: tuple[StopId, ...] | None
    ) -> list[str]:
        """Release these stops, which may be none at all; None: all that are known."""
        self.stop.take_request(EmergencyStopRequest(False, reason, Actor(by), named), now)
        return self._told()

    def hear(
        self,
        computer: ComputerName,
        now: int,
        *stops: PeerStop,
        ended: tuple[StopId, ...] | None = None,
        is_dealt_with: bool = False,
    ) -> list[str]:
        """Hear which stops another computer has, and which of them ended; None: all others."""
        told = PeerStops(computer, stops, ended, is_dealt_with)
        self.stop.take_stops_of_peer(told, now)
        return self._told()

    def hear_release(self, computer: ComputerName, now: int, *stops: str) -> list[str]:
        """Hear that somebody released stops at another computer."""
        released = StopsReleased(tuple(map(StopId, stops)), computer)
        self.stop.take_released(released, now)
        return self._told()

    def connect(self, status: DeviceStatus | SupervisorStatus, now: int) -> list[str]:
        """Learn how the connection to another computer is, as the core does."""
        self.stop.takes[type(status)](status, now)
        self.stop.settle(now)
        return self._told()

    @property
    def reasons(self) -> list[str]:
        return [reason.message for reason in self.health.stop_reasons]

    def stand(self, now: int) -> list[str]:
        self.stop.note_standstill(now)
        return self._told()

    def restore(
        self, *kept: Kept, stop_because: str = "", run: str = "", next_event: int = 1
    ) -> list[str]:
        """Go on as an earlier run left it."""
        self.store = {(type(item), item.name): item for item in kept}
        restored = Restored(kept, next_event=next_event, stop_because=stop_because, run=run)
        Restart(self.outbox).take_restored(restored, self.now)
        self.stop.restore(restored, self.now)
        return self._told()

    def _told(self) -> list[str]:
        outputs = self.outbox.take()
        self.kept = [item.value for item in outputs.kept]
        for item in outputs.kept:
            if item.value is None:
                self.store.pop((item.kind, item.name), None)
            else:
                self.store[item.kind, item.name] = item.value
        self.commands = list(outputs.commands)
        events: tuple[RecordedEvent, ...] = outputs.events
        self.words = [event.event.words for event in events]
        return [event.kind for event in events]
