"""Holds: named reasons that keep tasks from running, each set and released by its owner.

Source: smart_polaris, whose only hold is `allow_run_tasks`; see docs/explanation/semantics.md.
"""

from collections.abc import Mapping

from domain.errors import ReservedHoldError, TooManyHoldsError
from domain.snapshot import HoldView
from domain.timebase import Instant

ERROR_HOLD = "error"
"""Set while the robot is in ERROR."""
VEHICLE_HOLD = "vehicle"
"""Set while the pose of the vehicle is unknown or stale."""
DRIVE_HOLD = "drive_process"
"""Set while drive commands do not reach the vehicle."""

RESERVED = frozenset({ERROR_HOLD, VEHICLE_HOLD, DRIVE_HOLD})
MAX_HOLDS = 64


class Holds:
    """The holds by owner, in the order in which they were set."""

    def __init__(self) -> None:
        self._holds: Mapping[str, HoldView] = {}
        """Replaced by each change, and never changed in place."""

    def __bool__(self) -> bool:
        return bool(self._holds)

    @property
    def views(self) -> Mapping[str, HoldView]:
        """Return all holds; the same object as long as nothing changed."""
        return self._holds

    @property
    def reason(self) -> str:
        """Return why no task may run, in words; empty: there are no holds."""
        return "; ".join(hold.reason or hold.owner for hold in self._holds.values())

    def check(self, owner: str) -> None:
        """Reject the name of a hold that only Pilothouse may set and release.

        Raises:
            ReservedHoldError: The name is reserved.
        """
        if owner in RESERVED:
            raise ReservedHoldError(owner)

    def check_room(self, owner: str) -> None:
        """Reject a new hold if there are too many.

        Raises:
            TooManyHoldsError: There are `MAX_HOLDS` others.
        """
        if owner not in self._holds and len(self._holds) >= MAX_HOLDS:
            raise TooManyHoldsError(MAX_HOLDS)

    def set(self, owner: str, reason: str, by: str, now: Instant) -> bool:
        """Set a hold, or update the reason of an existing one; return whether it is new.

        Args:
            owner: Name of the hold.
            reason: Why it is set; may be empty.
            by: Who sets it; empty: Pilothouse itself. An existing hold keeps this and its time.
            now: The current time.
        """
        known = self._holds.get(owner)
        if known is None:
            self._holds = {**self._holds, owner: HoldView(owner, reason, by, now)}
            return True
        if known.reason != reason:
            renewed = HoldView(owner, reason, known.by, known.since)
            self._holds = {**self._holds, owner: renewed}
        return False

    def release(self, owner: str) -> bool:
        """Release a hold; return whether there was one."""
        if owner not in self._holds:
            return False
        self._holds = {name: hold for name, hold in self._holds.items() if name != owner}
        return True
