"""A clock that somebody sets: virtual time."""

import asyncio
from datetime import datetime

from domain.timebase import Duration, Instant
from service.clock import since_epoch, to_datetime


class VirtualClock:
    """A `Clock` for what is never waited for: whoever moves it does what is due meanwhile."""

    def __init__(self, start: Instant, wall: datetime) -> None:
        """Stand at `start`.

        Args:
            start: The present.
            wall: What a calendar says at `start`.
        """
        self._now = start
        self._offset: Duration = since_epoch(wall) - start

    def now(self) -> Instant:
        """Return the time that was set."""
        return self._now

    def set(self, now: Instant) -> None:
        """Let it be `now`, which is not before the present."""
        self._now = max(now, self._now)

    def wall_time(self, instant: Instant) -> datetime:
        """Return `instant` as UTC."""
        return to_datetime(instant + self._offset)

    def from_wall(self, moment: datetime) -> Instant:
        """Return when `moment` is on this clock.

        Raises:
            InvalidValueError: `moment` has no offset from UTC.
        """
        return since_epoch(moment) - self._offset

    async def sleep_until(self, deadline: Instant) -> None:
        """Wait for ever, unless `deadline` has passed: within virtual time nothing waits."""
        if deadline > self._now:
            await asyncio.get_running_loop().create_future()
        await asyncio.sleep(0)
