"""A clock that is wrong by some time, as that of another computer is."""

from datetime import datetime

from domain.timebase import Instant, seconds
from service.clock import Clock


class OffsetClock:
    """A `Clock` that shows another time than the one that it is made from, and runs with it.

    Args:
        clock: Which it follows.
        ahead_s: How much later it is on this one, in seconds.
    """

    def __init__(self, clock: Clock, ahead_s: float) -> None:
        self._clock = clock
        self._ahead = seconds(ahead_s)

    def now(self) -> Instant:
        """Return the time of this clock."""
        return self._clock.now() + self._ahead

    def wall_time(self, instant: Instant) -> datetime:
        """Return an instant of this clock as UTC, as this clock has it."""
        return self._clock.wall_time(instant)

    def from_wall(self, moment: datetime) -> Instant:
        """Return when a moment is on this clock."""
        return self._clock.from_wall(moment)

    async def sleep_until(self, deadline: Instant) -> None:
        """Wait until this clock shows a time."""
        await self._clock.sleep_until(deadline - self._ahead)
