"""How a file of waypoints separates and writes its cells.

Separators are commas, semicolons, tabs or blanks. Where the separator is not a comma, or cells are
quoted, a decimal comma is read too.
"""

import csv
import re
from dataclasses import dataclass
from itertools import islice

MAX_COLUMNS = 1_000

_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+(?:[eE][+-]?\d+)?", re.ASCII)
_BLANKS = " "
_SEPARATORS = (";", "\t", ",", _BLANKS)
_WORDS = {";": "semicolon", "\t": "tab", ",": "comma", _BLANKS: "blank"}


@dataclass(frozen=True, slots=True)
class Dialect:
    """A separator."""

    separator: str
    """`,`, `;` or a tab; a blank stands for any number of blanks and tabs."""

    @property
    def word(self) -> str:
        """Return the name of the separator: comma, semicolon, tab or blank."""
        return _WORDS[self.separator]

    def cells(self, line: str, most: int = MAX_COLUMNS) -> list[str]:
        """Split a line; whatever follows the `most` first cells is one further cell."""
        if '"' in line:
            return self._quoted_cells(line, most)
        return line.split(None if self.separator == _BLANKS else self.separator, most)

    def _quoted_cells(self, line: str, most: int) -> list[str]:
        blanks = self.separator == _BLANKS
        if line.count(self.separator) > MAX_COLUMNS and not blanks:
            return line.split(self.separator, most)
        text = " ".join(line.split()) if blanks else line
        try:
            cells = next(csv.reader([text], delimiter=self.separator, skipinitialspace=True), [])
        except csv.Error:
            # A cell that is longer than any number.
            return line.split(self.separator, most)
        rest = self.separator.join(cells[most:])
        return [*cells[:most], rest] if len(cells) > most else cells

    def place(self, line: str, cell: int) -> int:
        """Return the column of the line in which a cell begins, from 1.

        Args:
            line: The line.
            cell: Index of the cell.
        """
        at = 0
        cells = self.cells(line)
        exact = self.separator != _BLANKS and '"' not in line
        for text in islice(cells, cell):
            at = at + len(text) + 1 if exact else max(line.find(text, at), at) + len(text)
        rest = line[at:]
        if not exact:
            found = rest.find(cells[cell]) if cell < len(cells) else 0
            return at + max(found, 0) + 1
        blank = cells[cell] if cell < len(cells) else ""
        return at + len(blank) - len(blank.lstrip()) + 1

    def is_rest_empty(self, rest: str) -> bool:
        """Return whether a part of a line holds separators and blanks only."""
        return not rest.strip(f'{self.separator} \t"')


def dialect_of(line: str) -> Dialect:
    """Return the dialect in which a line of numbers is written.

    It is the first of semicolon, tab, comma and blank that makes it a line of numbers only;
    otherwise the first that makes at least two cells numbers, or that occurs.
    """
    occurring = [
        Dialect(separator)
        for separator in _SEPARATORS
        if (separator in line.strip() or (separator == _BLANKS and len(line.split(None, 1)) > 1))
    ]
    if not occurring:
        return Dialect(",")
    counts = [_count_numbers(dialect, line) for dialect in occurring]
    for dialect, (numbers, others) in zip(occurring, counts, strict=True):
        if numbers >= 2 and not others:
            return dialect
    several = [
        dialect for dialect, (numbers, _) in zip(occurring, counts, strict=True) if numbers >= 2
    ]
    return (several or occurring)[0]


def is_text(line: str) -> bool:
    """Return whether a line holds words and no number in any cell, as a header does."""
    if not any(character.isalpha() for character in line[:1_000]):
        return False
    dialect = next((Dialect(mark) for mark in _SEPARATORS if mark in line), Dialect(_BLANKS))
    return not any(is_number(cell) for cell in dialect.cells(line)[:MAX_COLUMNS])


def number_in(cell: str) -> float:
    """Return the number in a cell, with a decimal point or a decimal comma.

    Raises:
        ValueError: It is not a number.
    """
    # float() also accepts "1_0" and the digits of other scripts.
    if "_" in cell or not cell.isascii():
        raise ValueError
    if has_decimal_comma(cell):
        return float(cell.replace(",", "."))
    return float(cell)


def has_decimal_comma(cell: str) -> bool:
    """Return whether a cell holds a number with a decimal comma."""
    return "," in cell and _DECIMAL_COMMA.fullmatch(cell.strip()) is not None


def is_number(cell: str) -> bool:
    """Return whether a cell holds a number, finite or not."""
    try:
        number_in(cell)
    except ValueError:
        return False
    return True


def _count_numbers(dialect: Dialect, line: str) -> tuple[int, int]:
    """Return the number of cells that are numbers, and of those that are something else."""
    cells = [cell for cell in dialect.cells(line)[:MAX_COLUMNS] if cell.strip()]
    numbers = sum(is_number(cell) for cell in cells)
    return numbers, len(cells) - numbers
