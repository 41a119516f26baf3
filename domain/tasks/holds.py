"""Holds: named reasons that keep tasks from running, each set and released by its owner.

Source: smart_polaris, whose only hold is `allow_run_tasks`; see docs/explanation/semantics.md.
"""

from collections.abc import Mapping

from domain.errors import ReservedHoldError, TooManyHoldsError
from domain.reaction_terms import HOLD_PREFIX
from domain.snapshot import HoldView
from domain.timebase import Instant

ERROR_HOLD = "error"
"""Set while the robot is in ERROR."""
VEHICLE_HOLD = "vehicle"
"""Set while the pose of the vehicle is unknown or stale."""
DRIVE_HOLD = "drive_process"
"""Set while drive commands do not reach the vehicle."""
NAVIGATION_HOLD = "navigation"
"""Set while an external controller cannot be given a goal, or does not give one up."""
RESTART_HOLD = "restart"
"""Set when a restart of the service found a task that had not ended; people release it."""

RESERVED = frozenset({ERROR_HOLD, VEHICLE_HOLD, DRIVE_HOLD, NAVIGATION_HOLD})
MAX_HOLDS = 64


def why_not_restored(owner: str, others: int) -> str:
    """Return in words why a hold cannot be set again after a restart; empty: it can.

    Args:
        owner: Name of the hold.
        others: Number of holds that are set again already.
    """
    if _is_reserved(owner) or owner == RESTART_HOLD:
        return "only Pilothouse sets a hold of this name"
    return f"there are {MAX_HOLDS} holds already" if others >= MAX_HOLDS else ""


def _is_reserved(owner: str) -> bool:
    return owner in RESERVED or owner.startswith(HOLD_PREFIX)


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

    def check_release(self, owner: str) -> None:
        """Reject the name of a hold that only Pilothouse may release.

        Raises:
            ReservedHoldError: The name is reserved.
        """
        if _is_reserved(owner):
            raise ReservedHoldError(owner)

    def check_set(self, owner: str) -> None:
        """Reject a hold that only Pilothouse may set, and a new one if there are too many.

        Raises:
            ReservedHoldError: The name is reserved.
            TooManyHoldsError: There are `MAX_HOLDS` others.
        """
        self.check_release(owner)
        if owner == RESTART_HOLD:
            raise ReservedHoldError(owner, is_released_by_people=True)
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
