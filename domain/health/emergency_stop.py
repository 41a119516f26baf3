"""The emergency stop: a latch that no reading releases, only a person."""

from dataclasses import replace

from domain.snapshot import EmergencyStopView
from domain.timebase import Instant


class EmergencyStop:
    """The latch with who set it, why and since when.

    Both acts are idempotent: repeating one keeps who did it first. It starts released, since it is
    not stored yet.

    Source: ISO 13850, which wants a stop to stay until it is reset by hand.
    """

    def __init__(self) -> None:
        self._view = EmergencyStopView(
            engaged=False, by=None, reason=None, since=None, standstill_at=None
        )

    def engage(self, by: str, reason: str, now: Instant) -> bool:
        """Engage the stop; return whether it was released before."""
        return self._set(engaged=True, by=by, reason=reason, now=now)

    def release(self, by: str, reason: str, now: Instant) -> bool:
        """Release the stop; return whether it was engaged before."""
        return self._set(engaged=False, by=by, reason=reason, now=now)

    def note_standstill(self, now: Instant) -> bool:
        """Record that the vehicle stands; return whether that was not known since the stop."""
        if not self._view.engaged or self._view.standstill_at is not None:
            return False
        self._view = replace(self._view, standstill_at=now)
        return True

    def view(self) -> EmergencyStopView:
        """Return the latch as it is; the same object as long as nothing changed."""
        return self._view

    def _set(self, *, engaged: bool, by: str, reason: str, now: Instant) -> bool:
        if engaged is self._view.engaged:
            return False
        self._view = EmergencyStopView(
            engaged=engaged, by=by, reason=reason, since=now, standstill_at=None
        )
        return True
