"""Counts the changes that ended, and wakes the callers that wait for one."""

import asyncio
from collections import Counter
from collections.abc import Awaitable, Callable, Iterable
from contextlib import suppress

from domain.events.changes import ChangeEnded
from domain.events.event import RecordedEvent
from domain.identifiers import ChangeId
from domain.snapshot import ChangeView
from domain.supervision import Supervision
from domain.timebase import Instant, seconds
from service.clock import Clock


class ChangeEnds:
    """Notifies the callers that wait for a change when it ends."""

    def __init__(
        self, core: Supervision, clock: Clock, caught_up: Callable[[], Awaitable[None]]
    ) -> None:
        """Begin with no change ended.

        Args:
            core: Has the changes.
            clock: Of the service.
            caught_up: Returns once what arrived during a stall of the service is taken in.
        """
        self.counts: Counter[str] = Counter()
        """Changes that ended so far, by their final status."""
        self._core = core
        self._clock = clock
        self._caught_up = caught_up
        self._stopped = False
        self._waiting: dict[ChangeId, set[asyncio.Future[None]]] = {}

    def note(self, events: Iterable[RecordedEvent]) -> None:
        """Count the changes that these events end, and wake the callers that wait for them."""
        for recorded in events:
            event = recorded.event
            if isinstance(event, ChangeEnded):
                self.counts[event.status] += 1
                self._wake(event.change)

    async def wait(self, change: ChangeId, timeout_s: float) -> ChangeView:
        """Wait until a change ends, for at most `timeout_s` seconds, and return it.

        Raises:
            UnknownChangeError: There is no such change.
        """
        view = self._core.change(change)
        if view.status.is_final or timeout_s <= 0 or self._stopped:
            return view
        ended: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        waiting = self._waiting.setdefault(change, set())
        waiting.add(ended)
        deadline = self._clock.now() + seconds(timeout_s)
        timer = asyncio.ensure_future(self._expire(deadline))
        try:
            await asyncio.wait({ended, timer}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            waiting.discard(ended)
            timer.cancel()
            with suppress(asyncio.CancelledError):
                await timer
        return self._core.change(change)

    async def _expire(self, deadline: Instant) -> None:
        """Return at a deadline; the end of a change that has arrived by then comes first."""
        await self._clock.sleep_until(deadline)
        await self._caught_up()

    def stop(self) -> None:
        """Wake every waiting caller; from now on `wait` returns at once."""
        self._stopped = True
        for change in list(self._waiting):
            self._wake(change)

    def _wake(self, change: ChangeId) -> None:
        for ended in self._waiting.pop(change, ()):
            if not ended.done():
                ended.set_result(None)
