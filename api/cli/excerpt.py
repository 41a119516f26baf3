"""The line of a file that a message is about, with a caret below, as compilers show it."""

import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain

from api.terminal_text import escape, is_hidden

WHOLE = 100
"""Columns of a line that is shown whole."""

BEFORE, AFTER = 60, 40
"""Columns shown before and after the caret of a longer one, at most."""

_GUTTER = 5
_TAB = 4
_CUT = "..."
_NO_WIDTH = frozenset(("Mn", "Me"))


def excerpt(lines: Sequence[str], line: int, column: int) -> Iterator[str]:
    """Yield a line with its number, and a caret below one of its characters.

    Args:
        lines: The lines of the file.
        line: From 1; beyond the last one, nothing is shown.
        column: From 1, in characters; at most one after the end of the line.
    """
    if line > len(lines):
        return
    text, caret = _window(lines[line - 1], column - 1)
    yield f"{line:>{_GUTTER}} | {text}"
    yield f"{'':>{_GUTTER}} | {' ' * caret}^"


def _window(text: str, index: int) -> tuple[str, int]:
    """Return the part of a line around a character, and the column where that begins, from 0."""
    whole = list(_cells(text[: WHOLE + 1]))
    if len(whole) <= WHOLE and sum(map(_width, chain.from_iterable(whole))) <= WHOLE:
        return "".join(whole), sum(map(_width, chain.from_iterable(whole[:index])))
    # No more characters than columns fit but for those without width, of which few are shown.
    first = max(0, index - BEFORE * 2)
    before = list(_cells(text[first:index]))
    kept = _fitting(reversed(before), BEFORE)
    is_cut = first > 0 or len(kept) < len(before)
    left = (_CUT if is_cut else "") + "".join(reversed(kept))
    after = list(_cells(text[index : index + AFTER * 2]))
    right = _fitting(after, AFTER)
    is_cut = len(right) < len(after) or len(text) > index + AFTER * 2
    return left + "".join(right) + (_CUT if is_cut else ""), sum(map(_width, left))


def _fitting(cells: Iterable[str], columns: int) -> list[str]:
    """Return the first cells that fit into a number of columns."""
    kept: list[str] = []
    for cell in cells:
        columns -= sum(map(_width, cell))
        if columns < 0:
            break
        kept.append(cell)
    return kept


def _cells(text: str) -> Iterator[str]:
    """Yield what is printed for each character; tabs become blanks."""
    for character in text:
        if character == "\t":
            yield " " * _TAB
        else:
            yield escape(character) if is_hidden(character) else character


def _width(character: str) -> int:
    """Return the columns that a terminal takes for a printable character."""
    if unicodedata.category(character) in _NO_WIDTH:
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1
