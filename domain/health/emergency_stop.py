"""The emergency stop: a latch that only a person releases, never a reading."""

from dataclasses import replace

from domain.actor import SERVICE, Actor
from domain.concern import Concern, Takers
from domain.events.health import (
    EmergencyStopEngaged,
    EmergencyStopReleased,
    EmergencyStopStandstill,
)
from domain.health.health import Health
from domain.inputs import EmergencyStopRequest, Restored
from domain.kept import KeptEmergencyStop
from domain.outbox import Outbox
from domain.snapshot import EmergencyStopView
from domain.timebase import Instant


class EmergencyStop(Concern):
    """The latch: who engaged it, why and since when.

    Engage and release are idempotent: a repetition keeps the first actor. The latch is kept over a
    restart of the service; it starts released if there was no earlier run.

    Source: ISO 13850, which requires a stop to remain until it is reset manually.
    """

    def __init__(self, health: Health, outbox: Outbox) -> None:
        self._health = health
        self._outbox = outbox
        self._view = EmergencyStopView(
            engaged=False, by=None, reason=None, since=None, standstill_at=None
        )

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {EmergencyStopRequest: self.take_request, Restored: self.restore}

    def take_request(self, request: EmergencyStopRequest, now: Instant) -> None:
        """Engage or release the stop; a repetition changes nothing."""
        self._press(request, now, None)

    def engage_for(self, actor: Actor, reason: str, cause: int, now: Instant) -> None:
        """Engage the stop in the name of a reaction; a person releases it."""
        self._press(EmergencyStopRequest(True, reason, actor), now, cause)

    def _press(self, request: EmergencyStopRequest, now: Instant, cause: int | None) -> None:
        if request.engaged is self._view.engaged:
            return
        self._view = EmergencyStopView(
            engaged=request.engaged,
            by=request.actor.label,
            reason=request.reason,
            since=now,
            standstill_at=None,
        )
        kind = EmergencyStopEngaged if request.engaged else EmergencyStopReleased
        self._outbox.begin(now, kind(request.reason), request.actor, cause)
        self._outbox.record_input()
        by = request.actor.label
        self._outbox.keep(KeptEmergencyStop(request.engaged, by, request.reason, now))
        self._health.press_stop(now if request.engaged else None, now)

    def restore(self, restored: Restored, now: Instant) -> None:
        """Be as an earlier run left it, or engaged if nobody can tell how that was."""
        kept = next((item for item in restored.kept if isinstance(item, KeptEmergencyStop)), None)
        if restored.stop_because:
            kept = KeptEmergencyStop(True, SERVICE.label, restored.stop_because, now)
            self._outbox.keep(kept)
            self._outbox.emit(EmergencyStopEngaged(restored.stop_because))
        if kept is None:
            return
        since = min(kept.since, now)
        self._view = EmergencyStopView(
            engaged=kept.engaged, by=kept.by, reason=kept.reason, since=since, standstill_at=None
        )
        if kept.engaged:
            self._health.press_stop(since, now)

    def note_standstill(self, now: Instant) -> None:
        """Record the first standstill since the stop was engaged, or since it moved after that."""
        if self._view.engaged and self._view.standstill_at is None:
            self._view = replace(self._view, standstill_at=now)
            self._outbox.emit(EmergencyStopStandstill())

    def note_motion(self) -> None:
        """Record that the vehicle moves, or may move, though the stop is engaged."""
        if self._view.standstill_at is not None:
            self._view = replace(self._view, standstill_at=None)

    def view(self) -> EmergencyStopView:
        """Return the latch; the same object until it changes."""
        return self._view
