"""Loads earlier events for clients that are further behind than memory reaches."""

import asyncio
import logging
from collections.abc import Callable

from domain.errors import StorageDegradedError
from domain.timebase import seconds
from service.clock import Clock
from service.history.event_pages import HistoryReader

log = logging.getLogger(__name__)

_TRIES = 3
_PAUSE = seconds(1.0)
"""Between two tries to read the journal."""


class CatchingUp:
    """Gives each client that waits one page in turn; one page is read at a time.

    A client asks for the next page once it has read the one before: so nothing piles up for it, and
    those that come back together after a restart share the disk.
    """

    def __init__(self, clock: Clock, on_loaded: Callable[[], None]) -> None:
        """Prepare.

        Args:
            clock: For the pause between two tries.
            on_loaded: Called when a reader can take events again.
        """
        self._clock = clock
        self._on_loaded = on_loaded
        self._waiting: dict[HistoryReader, None] = {}
        self._task: asyncio.Task[None] | None = None

    def ask(self, reader: HistoryReader) -> None:
        """Load a page for a reader when it is its turn; it may wait already."""
        self._waiting.setdefault(reader)
        if self._task is None or self._task.done():
            self._task = asyncio.create_task(self._run(), name="earlier events")
            self._task.add_done_callback(self._ended)

    def forget(self, reader: HistoryReader) -> None:
        """Load nothing more for a reader whose client has gone."""
        self._waiting.pop(reader, None)

    async def _run(self) -> None:
        failures = 0
        while self._waiting:
            reader = next(iter(self._waiting))
            try:
                await reader.load()
            except StorageDegradedError as error:
                failures += 1
                if failures < _TRIES:
                    await self._clock.sleep_until(self._clock.now() + _PAUSE)
                    continue
                log.warning("clients go on without earlier events: %s", error.message)
                self._let_all_skip()
            failures = 0
            self._waiting.pop(reader, None)
            self._on_loaded()

    def _let_all_skip(self) -> None:
        """Let those who wait go on with what memory has; each is told the gap."""
        for reader in self._waiting:
            reader.skip()
        self._waiting.clear()

    def _ended(self, task: asyncio.Task[None]) -> None:
        if not task.cancelled() and task.exception() is not None:
            log.critical("earlier events cannot be loaded", exc_info=task.exception())
            self._let_all_skip()
            self._on_loaded()
