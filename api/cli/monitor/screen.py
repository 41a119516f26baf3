"""Draws on the alternate screen of a terminal; only changed lines are written.

Rich would write the whole screen for each picture; over a serial line of 9600 baud that takes two
seconds.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from rich.console import Console
from rich.text import Text

from api.cli.monitor.keyboard import single_keys

_ERASE_LINE = "\x1b[K"
_ERASE_SCREEN = "\x1b[2J"


class Screen:
    """What a terminal shows, line by line."""

    def __init__(self, console: Console) -> None:
        """Show nothing yet.

        Args:
            console: Where to write.
        """
        self._console = console
        self._shown: list[str] = []
        self._size = console.size

    def forget(self) -> None:
        """Redraw everything next time, since another program has written to the terminal."""
        self._shown = []

    def draw(self, lines: Sequence[Text]) -> None:
        """Show lines, from the top; where nothing changed, nothing is written."""
        size = self._console.size
        if size != self._size:
            self._size = size
            self.forget()
        drawn = [self._codes(line, size.width) for line in lines[: size.height]]
        drawn += [_ERASE_LINE] * (size.height - len(drawn))
        text = ""
        if not self._shown:
            text = _ERASE_SCREEN
            self._shown = [_ERASE_LINE] * size.height
        for number, (new, old) in enumerate(zip(drawn, self._shown, strict=True), start=1):
            if new != old:
                text += f"\x1b[{number};1H{new}"
        self._shown = drawn
        if text:
            self._console.file.write(text)
            self._console.file.flush()

    def _codes(self, line: Text, width: int) -> str:
        """Return the text that overwrites a line."""
        with self._console.capture() as captured:
            self._console.print(line, end="", no_wrap=True, overflow="crop")
        # After a full line, terminals would erase its last character.
        return captured.get() + (_ERASE_LINE if line.cell_len < width else "")


@contextmanager
def alternate_screen(console: Console) -> Iterator[Screen]:
    """Draw on the alternate screen; the terminal is always restored at the end.

    Args:
        console: Of a terminal.
    """
    with console.screen(), single_keys():
        yield Screen(console)
