"""The emergency stop: a latch that no reading releases, only a person."""

from dataclasses import replace

from domain.concern import Concern, Takers
from domain.events.health import (
    EmergencyStopEngaged,
    EmergencyStopReleased,
    EmergencyStopStandstill,
)
from domain.health.health import Health
from domain.inputs import EmergencyStopRequest
from domain.outbox import Outbox
from domain.snapshot import EmergencyStopView
from domain.timebase import Instant


class EmergencyStop(Concern):
    """The latch with who set it, why and since when.

    Both acts are idempotent: repeating one keeps who did it first. It starts released, since it is
    not stored yet.

    Source: ISO 13850, which wants a stop to stay until it is reset by hand.
    """

    def __init__(self, health: Health, outbox: Outbox) -> None:
        self._health = health
        self._outbox = outbox
        self._view = EmergencyStopView(
            engaged=False, by=None, reason=None, since=None, standstill_at=None
        )

    @property
    def takes(self) -> Takers:
        """Return what takes each class of input."""
        return {EmergencyStopRequest: self.take_request}

    def take_request(self, request: EmergencyStopRequest, now: Instant) -> None:
        """Engage or release the stop; to repeat it changes nothing."""
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
        self._outbox.begin(now, kind(request.reason), request.actor)
        self._outbox.record_input()
        self._health.press_stop(now, engaged=request.engaged)

    def note_standstill(self, now: Instant) -> None:
        """Learn that the vehicle stands, and tell when that is first known since the stop."""
        if self._view.engaged and self._view.standstill_at is None:
            self._view = replace(self._view, standstill_at=now)
            self._outbox.emit(EmergencyStopStandstill())

    def view(self) -> EmergencyStopView:
        """Return the latch as it is; the same object as long as nothing changed."""
        return self._view
