"""A clock that is set, for a robot that is simulated or was recorded."""

import asyncio
from datetime import datetime

from domain.timebase import Duration, Instant
from service.clock import since_epoch, to_datetime


class VirtualClock:
    """A `Clock` that is set; the caller that sets it also processes what is due until then."""

    def __init__(self, start: Instant, wall: datetime) -> None:
        """Start at `start`.

        Args:
            start: First time of the clock.
            wall: The wall time at `start`.
        """
        self._now = start
        self._offset: Duration = since_epoch(wall) - start

    def now(self) -> Instant:
        """Return the time that was set."""
        return self._now

    def set(self, now: Instant) -> None:
        """Set the time; it never goes back."""
        self._now = max(now, self._now)

    def wall_time(self, instant: Instant) -> datetime:
        """Return `instant` as UTC."""
        return to_datetime(instant + self._offset)

    def from_wall(self, moment: datetime) -> Instant:
        """Convert `moment` to this clock.

        Raises:
            InvalidValueError: `moment` has no offset from UTC.
        """
        return since_epoch(moment) - self._offset

    async def sleep_until(self, deadline: Instant) -> None:
        """Wait forever, unless `deadline` has passed: nothing waits in virtual time."""
        if deadline > self._now:
            await asyncio.get_running_loop().create_future()
        await asyncio.sleep(0)
