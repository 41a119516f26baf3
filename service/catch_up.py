"""After a stall of the event loop, what has arrived is taken in before ages are judged.

The loop stalls if a callback takes long, or if the process does not run on a busy host. What came
meanwhile waits in sockets, queues and threads. Whether it came in time is not known any more, so it
counts as if it had: a stall of our own is no fault of a node, a sensor or the vehicle.
"""

from collections.abc import Callable

from domain.timebase import Duration, Instant, seconds
from service.clock import Clock

LATE: Duration = seconds(0.05)
"""The tick is that late only if the loop was. Reports come every 0.05 s, and the shortest age that
is judged is 0.3 s: a loop that is less late makes nothing too old."""
WINDOW: Duration = seconds(0.05)
"""Time in which sockets, queues and threads hand over what has arrived: some turns of the loop."""
MOST_WINDOWS = 3
"""If the loop stalls again and again, ages are judged nevertheless after so many windows."""


class CatchUp:
    """Whether what arrived during a stall may still have to be taken in."""

    def __init__(self, clock: Clock, tick_due: Callable[[], Instant | None]) -> None:
        """Begin without a stall.

        Args:
            clock: Of the service.
            tick_due: Returns when the next tick has to begin; None: there was none yet.
        """
        self._clock = clock
        self._tick_due = tick_due
        self._windows = 0
        self.until: Instant | None = None
        """Not before this time, deadlines are judged; None: at once."""

    def is_on(self, now: Instant) -> bool:
        """Tell whether to wait with what was due; False: it has to be judged now."""
        if self.until is not None and now < self.until:
            return True
        windows = 0 if self.until is None else self._windows
        if windows < MOST_WINDOWS and self._is_late(now):
            self.until, self._windows = now + WINDOW, windows + 1
            return True
        self.until = None
        return False

    def note_tick(self, now: Instant) -> None:
        """Note that a tick begins, which may be late; nobody may have asked since then."""
        if self.until is None or self._windows < MOST_WINDOWS:
            self.is_on(now)

    async def wait(self) -> None:
        """Return once what has arrived is taken in; at once unless the loop was late."""
        now = self._clock.now()
        until = now + WINDOW if self.until is None and self._is_late(now) else self.until
        if until is not None:
            await self._clock.sleep_until(until)

    def _is_late(self, now: Instant) -> bool:
        due = self._tick_due()
        return due is not None and now - due > LATE
