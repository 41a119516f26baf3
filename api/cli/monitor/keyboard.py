"""The keyboard of the terminal: keys come one by one, and are not shown; q ends the monitor."""

import asyncio
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

_LOOK_AGAIN_S = 1.0
_MOST_BYTES = 64
_QUIT = frozenset(b"qQ")
_OF_SEVERAL_BYTES = re.compile(rb"\x1b(?:O.|\[[0-9;]*.)?")
"""Keys such as F2, which sends ESC O Q."""


class Keyboard:
    """Reads keys of the standard input, if that is a terminal."""

    def __init__(self) -> None:
        """Read nothing yet."""
        self._quit = asyncio.Event()

    async def until_quit(self) -> None:
        """Wait until q is pressed; for ever, if there is no keyboard."""
        if sys.platform == "win32" or not sys.stdin.isatty():
            await self._quit.wait()
            return
        self._listen()
        try:
            await self._quit.wait()
        finally:
            asyncio.get_running_loop().remove_reader(sys.stdin)

    def _listen(self) -> None:
        asyncio.get_running_loop().add_reader(sys.stdin, self._read)

    def _read(self) -> None:
        loop, number = asyncio.get_running_loop(), sys.stdin.fileno()
        if os.tcgetpgrp(number) != os.getpgrp():
            # In the background: to read now would stop the process.
            loop.remove_reader(sys.stdin)
            loop.call_later(_LOOK_AGAIN_S, self._listen)
            return
        try:
            typed = os.read(number, _MOST_BYTES)
        except OSError:
            typed = b""
        if not typed:
            # The terminal has gone away.
            loop.remove_reader(sys.stdin)
        if not _QUIT.isdisjoint(_OF_SEVERAL_BYTES.sub(b"", typed)):
            self._quit.set()


@contextmanager
def single_keys() -> Iterator[None]:
    """Let keys come without Enter and without echo; the terminal is always restored at the end."""
    if sys.platform == "win32" or not sys.stdin.isatty():
        yield
        return
    import termios

    before = termios.tcgetattr(sys.stdin)
    take_single_keys()
    try:
        yield
    finally:
        # Discards typed keys, which were not meant for the shell. A terminal that has gone away
        # needs none of this.
        with suppress(termios.error):
            termios.tcsetattr(sys.stdin, termios.TCSAFLUSH, before)


def take_single_keys() -> None:
    """Set the terminal so, as after Ctrl-Z and `fg`, where the shell has reset it."""
    if sys.platform == "win32" or not sys.stdin.isatty():
        return
    import termios

    mode = termios.tcgetattr(sys.stdin)
    mode[3] &= ~(termios.ECHO | termios.ICANON)
    mode[6][termios.VMIN], mode[6][termios.VTIME] = 1, 0
    termios.tcsetattr(sys.stdin, termios.TCSADRAIN, mode)
