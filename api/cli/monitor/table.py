"""Tables that fit the terminal; cells that are too long end with an ellipsis."""

from collections.abc import Sequence
from dataclasses import dataclass

from rich.cells import cell_len
from rich.text import Text


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
    is_right: bool = False
    """Whether its cells are aligned to the right."""


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
    titles = [column.title for column in columns]
    layout = Layout(columns, [titles, *(cells for cells, _ in rows)], width)
    return [layout.line(titles, style), *(layout.line(cells, of_row) for cells, of_row in rows)]


class Layout:
    """Columns, each as wide as it needs to be and as the terminal allows."""

    def __init__(
        self,
        columns: Sequence[Column],
        rows: Sequence[Sequence[str]],
        width: int,
        gap: str = " ",
    ) -> None:
        """Fit columns to what is to be shown; all that the terminal is too narrow for are left out.

        Args:
            columns: From left to right.
            rows: The cells of each line, titles included.
            width: Of the terminal, in cells.
            gap: Between two columns.
        """
        self._columns = columns
        self._shown = [place for place, column in enumerate(columns) if width >= column.needs_width]
        self._gap = gap
        own = [columns[place] for place in self._shown]
        cells = [[printable(row[place]) for place in self._shown] for row in rows]
        room = width - len(gap) * (len(own) - 1)
        self._widths = dict(zip(self._shown, _widths(own, cells, room), strict=True))

    @property
    def width(self) -> int:
        """Return the width of a line, in cells."""
        return self._width_of(self._shown)

    def line(self, cells: Sequence[str], style: str = "") -> Text:
        """Return a line with one cell for each column, also for those that are left out."""
        pieces = [
            _fitted(cells[place], self._widths[place], right=self._columns[place].is_right)
            for place in self._shown
        ]
        return self._joined(pieces, style)

    def spanning(self, cells: Sequence[tuple[str, Sequence[int]]], style: str = "") -> Text:
        """Return a line of cells that each span several columns, aligned as the first of them.

        Args:
            cells: Texts, and the places of the columns below.
            style: Of the line.
        """
        pieces = []
        for text, places in cells:
            shown = [place for place in places if place in self._widths]
            is_right = self._columns[places[0]].is_right
            pieces.append(_fitted(text, self._width_of(shown), right=is_right))
        return self._joined(pieces, style)

    def _width_of(self, places: Sequence[int]) -> int:
        return sum(self._widths[each] for each in places) + len(self._gap) * (len(places) - 1)

    def _joined(self, pieces: Sequence[Text], style: str) -> Text:
        line = Text(self._gap).join(pieces)
        line.style = style
        line.rstrip()
        return line


def _widths(columns: Sequence[Column], lines: Sequence[Sequence[str]], room: int) -> list[int]:
    """Give each column the width it needs, and its usual width as far as there is room.

    If there is too little room, the widest columns are reduced, down to the least of each.
    """
    widths = [max(map(cell_len, cells)) for cells in zip(*lines, strict=True)]
    spare = room - sum(widths)
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


def _fitted(cell: str, width: int, *, right: bool) -> Text:
    text = Text(printable(cell))
    text.truncate(width, overflow="ellipsis")
    missing = width - text.cell_len
    if missing > 0:
        (text.pad_left if right else text.pad_right)(missing)
    return text
