"""The last lines of what a program prints."""

from collections import deque

MAX_LINES = 200
MAX_LINE_BYTES = 2_000
"""What is longer is cut."""

_CUT = b" ..."


class OutputTail:
    """Keeps the last lines, each up to a length, whatever comes in whatever pieces."""

    def __init__(self) -> None:
        self._lines: deque[bytes] = deque(maxlen=MAX_LINES)
        self._rest = b""
        """Of a line that has not ended; a byte more than is kept, if there was more."""

    def add(self, data: bytes) -> None:
        """Take what a program printed."""
        # What comes before the last lines of a large piece would be dropped at once.
        first, *further = data.rsplit(b"\n", MAX_LINES)
        if b"\n" in first:
            self._rest = b""
            first = first.rpartition(b"\n")[2]
        *ended, rest = first, *further
        for line in ended:
            self._lines.append(_cut(self._rest + line[: MAX_LINE_BYTES + 1]))
            self._rest = b""
        self._rest = (self._rest + rest[: MAX_LINE_BYTES + 1])[: MAX_LINE_BYTES + 1]

    def lines(self) -> list[str]:
        """Return the lines, the oldest first; one that has not ended is the last."""
        raw = [*self._lines, _cut(self._rest)] if self._rest else list(self._lines)
        return [line.decode("utf-8", "replace").rstrip("\r") for line in raw[-MAX_LINES:]]


def _cut(line: bytes) -> bytes:
    return line if len(line) <= MAX_LINE_BYTES else line[:MAX_LINE_BYTES] + _CUT
