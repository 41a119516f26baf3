"""Writes to standard output and standard error without ever blocking the event loop.

A terminal that is paused, a pipe that nobody reads, and a disk that is full must not stop the
supervision of a robot.
"""

import os
import queue
import threading
import time

_MAX_WAITING = 1_000
_RETRY_S = 0.05


class Output:
    """A file that a thread writes to; texts that it cannot take are dropped and counted."""

    def __init__(self, file_number: int, max_waiting: int = _MAX_WAITING) -> None:
        """Start the thread; `close` ends it.

        Args:
            file_number: Of an open file, such as 2 for standard error.
            max_waiting: Texts that may wait while the file takes nothing.
        """
        self._file_number = file_number
        self._waiting: queue.Queue[str | None] = queue.Queue(max_waiting)
        self._lost = 0
        self._thread = threading.Thread(target=self._work, name="output", daemon=True)
        self._thread.start()

    def write(self, text: str) -> None:
        """Write a text soon, and return at once; a file that is broken or full loses it."""
        try:
            if self._lost:
                self._waiting.put_nowait(f"{self._lost} texts were lost: nobody read this output\n")
                self._lost = 0
            self._waiting.put_nowait(text)
        except queue.Full:
            self._lost += 1

    def close(self, within_s: float = 0.5) -> None:
        """Write what waits, as far as that is possible within this time."""
        try:
            self._waiting.put_nowait(None)
        except queue.Full:
            return
        self._thread.join(within_s)

    def _work(self) -> None:
        while (text := self._waiting.get()) is not None:
            self._write(text.encode("utf-8", "backslashreplace"))

    def _write(self, data: bytes) -> None:
        while data:
            try:
                data = data[os.write(self._file_number, data) :]
            except BlockingIOError:
                # Another process made the shared file non-blocking.
                time.sleep(_RETRY_S)
            except OSError:
                # Nothing is left to tell it to; the next text may pass again.
                return
