"""Lines of the picture: wrapped, cut, and counted where they do not fit."""

from rich.console import Console
from rich.text import Text

from api.cli.monitor.rows import Chosen, RowType
from api.cli.monitor.table import printable


def wrapped(text: str, console: Console, indent: int) -> list[Text]:
    """Return a text as lines of which all but the first are indented.

    Args:
        text: Of any length.
        console: Whose width is used.
        indent: In cells.
    """
    plain = printable(text)
    first = Text(plain).wrap(console, console.width)[0]
    first.rstrip()
    behind = plain[len(first) :].lstrip()
    if not behind:
        return [first]
    more = Text(behind).wrap(console, max(1, console.width - indent))
    return [first, *(Text(" " * indent).append(line.plain.rstrip()) for line in more)]


def cut(lines: list[Text], most: int) -> list[Text]:
    """Return at most so many lines, of which the last counts what is left out."""
    if len(lines) <= most:
        return lines
    return [*lines[: most - 1], Text(f"  ... and {len(lines) - most + 1} more lines")]


def counted(chosen: Chosen[RowType], what: str) -> list[Text]:
    """Return a line that counts the rows for which there was no room; none if all are shown.

    Args:
        chosen: The rows that are shown.
        what: What a row is, in the plural.
    """
    if chosen.left_out == 0:
        return []
    marked = f", {chosen.marked} of them marked" if chosen.marked else ""
    return [Text(f"  ... and {chosen.left_out} more {what}{marked}")]
