"""A line of a terminal that is overwritten repeatedly, and erased at the end."""

import shutil
import time
from types import TracebackType
from typing import Self, TextIO

_ERASE = "\r\x1b[2K"


class TerminalLine:
    """A progress line; without a terminal, nothing is written.

    As a context manager it always erases the line at the end.
    """

    def __init__(self, out: TextIO, period_s: float = 0.1) -> None:
        """Write nothing yet.

        Args:
            out: Where to write.
            period_s: Least time between two texts; those in between are left out.
        """
        self.is_shown = out.isatty()
        """False: there is no terminal."""
        self._out = out
        self._period_s = period_s
        self._next_at = 0.0
        self._is_dirty = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.erase()

    def show(self, text: str) -> None:
        """Overwrite the line with `text`, cut to the width of the terminal."""
        now = time.monotonic()
        if not self.is_shown or now < self._next_at:
            return
        self._next_at = now + self._period_s
        # The last column stays empty: some terminals begin a new line after it.
        width = shutil.get_terminal_size().columns - 1
        self._out.write(_ERASE + text[:width])
        self._out.flush()
        self._is_dirty = True

    def erase(self) -> None:
        """Leave an empty line, so that other output can follow."""
        if self._is_dirty:
            self._out.write(_ERASE)
            self._out.flush()
            self._is_dirty = False
            self._next_at = 0.0
