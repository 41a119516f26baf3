"""Holds: whoever has a reason keeps the vehicle from driving, each under a name of its own.

Source: smart_polaris, whose one hold is `allow_run_tasks`; here each owner has its own.
"""

from collections.abc import Mapping

from domain.errors import ReservedHoldError, TooManyHoldsError
from domain.snapshot import HoldView
from domain.timebase import Instant

ERROR_HOLD = "error"
"""Set while the robot is in ERROR."""
VEHICLE_HOLD = "vehicle"
"""Set while it is not known where the vehicle is."""

RESERVED = frozenset({ERROR_HOLD, VEHICLE_HOLD})
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
        """Return why nothing may be driven, in words; empty: it may."""
        return "; ".join(hold.reason or hold.owner for hold in self._holds.values())

    def check(self, owner: str) -> None:
        """Refuse a hold that somebody else than Pilothouse may not set or clear.

        Raises:
            ReservedHoldError: Pilothouse sets and clears this one.
        """
        if owner in RESERVED:
            raise ReservedHoldError(owner)

    def check_room(self, owner: str) -> None:
        """Refuse one hold too many.

        Raises:
            TooManyHoldsError: There are `MAX_HOLDS` of others.
        """
        if owner not in self._holds and len(self._holds) >= MAX_HOLDS:
            raise TooManyHoldsError(MAX_HOLDS)

    def set(self, owner: str, reason: str, by: str, now: Instant) -> bool:
        """Set a hold; return whether it is new. One that is there keeps who set it and when."""
        known = self._holds.get(owner)
        if known is None:
            self._holds = {**self._holds, owner: HoldView(owner, reason, by, now)}
            return True
        if known.reason != reason:
            renewed = HoldView(owner, reason, known.by, known.since)
            self._holds = {**self._holds, owner: renewed}
        return False

    def release(self, owner: str) -> bool:
        """Clear a hold; return whether there was one."""
        if owner not in self._holds:
            return False
        self._holds = {name: hold for name, hold in self._holds.items() if name != owner}
        return True
