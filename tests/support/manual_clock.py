"""A clock that stands still until a test moves it: minutes pass in milliseconds, and exactly."""

import asyncio
import heapq
from datetime import UTC, datetime
from itertools import count

from domain.timebase import Duration, Instant, seconds
from service.clock import since_epoch, to_datetime

START = datetime(2026, 1, 1, tzinfo=UTC)
_MANY_TURNS = 100_000


class ManualClock:
    """A `Clock` that moves only by `advance`.

    Args:
        start: What `now` returns at first.
        wall: What wall time `start` is.
    """

    def __init__(self, start: Instant = 0, wall: datetime = START) -> None:
        self._now = start
        self._offset: Duration = since_epoch(wall) - start
        self._sleepers: list[tuple[Instant, int, asyncio.Future[None]]] = []
        self._order = count()

    def now(self) -> Instant:
        """Return the time that the test has let it be."""
        return self._now

    def wall_time(self, instant: Instant) -> datetime:
        """Return `instant` as UTC."""
        return to_datetime(instant + self._offset)

    def from_wall(self, moment: datetime) -> Instant:
        """Return when `moment` is on this clock."""
        return since_epoch(moment) - self._offset

    def step_wall_time(self, by_s: float) -> None:
        """Set the calendar, as an operator or a time server does; `now` does not change."""
        self._offset += seconds(by_s)

    def stall(self, by_s: float) -> None:
        """Let time pass in which no task runs, as when something blocks the event loop."""
        self._now += seconds(by_s)

    async def sleep_until(self, deadline: Instant) -> None:
        """Wait until `advance` reaches `deadline`."""
        if deadline <= self._now:
            await asyncio.sleep(0)
            return
        woken = asyncio.get_running_loop().create_future()
        heapq.heappush(self._sleepers, (deadline, next(self._order), woken))
        await woken

    async def advance(self, by_s: float) -> None:
        """Let time pass: sleepers wake in the order of their deadlines, each at its own.

        All tasks that are ready run before time goes on. When this returns, every task waits for
        something that is still to come.
        """
        await self.advance_to(self._now + seconds(by_s))

    async def advance_to(self, end: Instant) -> None:
        """Let time pass until `end`; see `advance`."""
        await settle()
        while self._sleepers and self._sleepers[0][0] <= end:
            deadline, _, woken = heapq.heappop(self._sleepers)
            if not woken.done():
                self._now = max(self._now, deadline)
                woken.set_result(None)
                await settle()
        self._now = max(self._now, end)


async def settle() -> None:
    """Return once no other task is ready to run.

    Does not wait for threads, processes or sockets: asyncio cannot tell that something will come of
    them.

    Raises:
        AssertionError: The tasks do not come to rest; one of them spins.
    """
    loop = asyncio.get_running_loop()
    for _ in range(_MANY_TURNS):
        await asyncio.sleep(0)
        if not loop._ready:  # type: ignore[attr-defined]  # noqa: SLF001
            return
    raise AssertionError("the tasks do not come to rest: one of them spins")
