"""Announcements on the event loop: all that are made while the disk is busy share one sync."""

import asyncio
from collections import deque
from collections.abc import Sequence

from pydantic_core import to_json

from service.call_thread import CallThread
from service.storage.journal import Plain
from service.storage.sqlite.announced_file import ROOM_BYTES, AnnouncedFile


class Announcer:
    """Writes announcements down in a thread of its own, which waits for no commit.

    Args:
        file: Where they go; opened by whoever owns the folder.
    """

    def __init__(self, file: AnnouncedFile) -> None:
        self._file = file
        self._thread = CallThread("journal-announcer")
        self._waiting: list[tuple[Plain, asyncio.Future[None]]] = []
        self._is_busy = False

    async def announce(self, what: Plain) -> None:
        """Return when an announcement is on disk.

        Raises:
            OSError: It cannot be written.
        """
        waiter: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.append((what, waiter))
        if not self._is_busy:
            self._write()
        await waiter

    def end(self) -> None:
        """Let the thread end."""
        self._thread.end()

    def _write(self) -> None:
        group, self._waiting = self._waiting, []
        self._is_busy = True
        text = record_of([what for what, _ in group])
        waiters = [waiter for _, waiter in group]
        writing = self._thread.run(lambda: self._file.write(text))
        writing.add_done_callback(lambda done: self._settle(waiters, done))

    def _settle(
        self, waiters: "Sequence[asyncio.Future[None]]", written: "asyncio.Future[None]"
    ) -> None:
        error = written.exception()
        for waiter in waiters:
            if waiter.done():
                continue
            if error is None:
                waiter.set_result(None)
            else:
                waiter.set_exception(error)
        self._is_busy = False
        if self._waiting:
            self._write()


def record_of(announced: Sequence[Plain]) -> bytes:
    """Return announcements as the text of one record, without the oldest if there are too many."""
    kept = deque(announced)
    while len(text := to_json(list(kept))) > ROOM_BYTES:
        kept.popleft()
    return text
