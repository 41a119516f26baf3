"""Tables that fit the terminal; cells that are too long end with an ellipsis."""

from collections.abc import Sequence
from dataclasses import dataclass

from rich.cells import cell_len
from rich.text import Text

_GAP = 1


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table."""

    title: str
    least: int
    """Width in cells down to which it may be cut."""
    usual: int = 0
    """Width that it has where there is room, so that it stays where it is."""
    needs_width: int = 0
    """Width of the terminal below which it is left out."""


def printable(text: str) -> str:
    """Replace control characters, since names and reasons come from other programs."""
    return "".join(character if character.isprintable() else "?" for character in text)


def table(
    columns: Sequence[Column],
    rows: Sequence[tuple[Sequence[str], str]],
    width: int,
    style: str = "",
) -> list[Text]:
    """Return a line of titles, and one for each row.

    Args:
        columns: From left to right.
        rows: The cells of each, and its style.
        width: Of the terminal, in cells.
        style: Of the titles.
    """
    shown = [place for place, column in enumerate(columns) if width >= column.needs_width]
    titles = [columns[place].title for place in shown]
    cells = [[printable(row[place]) for place in shown] for row, _ in rows]
    widths = _widths([columns[place] for place in shown], [titles, *cells], width)
    styles = [row_style for _, row_style in rows]
    return [
        _line(line, widths, line_style)
        for line, line_style in zip([titles, *cells], [style, *styles], strict=True)
    ]


def _widths(columns: Sequence[Column], lines: Sequence[Sequence[str]], width: int) -> list[int]:
    """Give each column the width it needs, and its usual width as far as there is room.

    If there is too little room, the widest columns are reduced, down to the least of each.
    """
    widths = [max(map(cell_len, cells)) for cells in zip(*lines, strict=True)]
    spare = width - sum(widths) - _GAP * (len(widths) - 1)
    for place, column in enumerate(columns):
        more = min(max(0, column.usual - widths[place]), max(0, spare))
        widths[place] += more
        spare -= more
    while spare < 0:
        cuttable = [has - column.least for has, column in zip(widths, columns, strict=True)]
        most = max(cuttable)
        if most <= 0:
            break
        widths[cuttable.index(most)] -= 1
        spare += 1
    return widths


def _line(cells: Sequence[str], widths: Sequence[int], style: str) -> Text:
    line = Text(style=style)
    for cell, wide in zip(cells, widths, strict=True):
        text = Text(cell)
        text.truncate(wide, overflow="ellipsis", pad=True)
        line.append(text).append(" " * _GAP)
    line.rstrip()
    return line
