"""The numbers in the columns of a waypoint file that are read, and what is wrong with them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from domain.arrays import Floats, np
from domain.findings import Finding
from domain.paths.waypoints import MAX_COORDINATE_M, MAX_WAYPOINTS
from service.files.csv_dialect import has_decimal_comma, is_number, number_in
from service.files.csv_table import (
    MAX_FINDINGS,
    CsvTable,
    InvalidWaypointsError,
    finding,
    refused,
    shown,
    too_many_points,
)

_LARGEST = 1e20
"""A time in ns is less, and its square is finite."""


@dataclass(frozen=True, slots=True)
class Numbers:
    """Numbers of all rows."""

    values: Floats
    """Shape (n, k), finite: the n waypoints, and the k columns that were asked for."""
    lines: list[int]
    """Number of the line of each waypoint."""
    has_decimal_comma: bool


class _Rows:
    """Reads row after row, and collects the faults: one in each line."""

    def __init__(self, table: CsvTable, used: Sequence[int], names: Sequence[str]) -> None:
        self._table = table
        self._used = used
        self._names = names
        self.rows: list[list[float]] = []
        self.lines: list[int] = []
        self.findings: list[Finding] = []
        self.first_comma: int | None = None

    def read(self) -> None:
        """Read all rows; stop early once there are enough findings.

        Raises:
            InvalidWaypointsError: There are too many.
        """
        cells_of, least, most = self._table.dialect.cells, self._table.least, self._table.most
        used = self._used
        for number, line in self._table.rows():
            if len(self.rows) == MAX_WAYPOINTS:
                raise too_many_points(number)
            cells = cells_of(line, most)
            row = None
            if least <= len(cells) <= most and "_" not in line and line.isascii():
                try:
                    row = [float(cells[index]) for index in used]
                except (ValueError, IndexError):
                    row = None
            if row is None:
                row = self._read_slowly(number, line, cells)
                if len(self.findings) >= MAX_FINDINGS:
                    return
            self.rows.append(row)
            self.lines.append(number)

    def _read_slowly(self, number: int, line: str, cells: list[str]) -> list[float]:
        """Return the numbers of any line, zeros after a fault."""
        fault = self._fault_of_line(line, cells)
        if fault is not None:
            self.findings.append(finding(*fault, number))
            return [0.0] * len(self._used)
        row = []
        for index, name in zip(self._used, self._names, strict=True):
            cell = cells[index] if index < len(cells) else ""
            if has_decimal_comma(cell):
                self.first_comma = self.first_comma or number
            if is_number(cell):
                row.append(number_in(cell))
                continue
            what = f"{shown(cell)} is not a number" if cell.strip() else "missing number"
            place = self._table.dialect.place(line, index)
            self.findings.append(finding("NOT_A_NUMBER", f"{name}: {what}", number, place))
            return [0.0] * len(self._used)
        return row

    def _fault_of_line(self, line: str, cells: list[str]) -> tuple[str, str] | None:
        """Return code and message if a line is empty or has too few or too many columns."""
        least, most = self._table.least, self._table.most
        if not line.strip():
            return "EMPTY_LINE", "empty line between waypoints"
        if len(cells) > most and not self._table.dialect.is_rest_empty(cells[most]):
            return "TOO_MANY_COLUMNS", f"more columns than in the first row, which has {least}"
        if len(cells) < least:
            row = f"{len(cells)} column{'s' if len(cells) > 1 else ''}"
            return "TOO_FEW_COLUMNS", f"{row}; the first row has {least}"
        return None

    def check_decimal_marks(self) -> None:
        """Refuse a file that has both decimal commas and decimal points.

        Raises:
            InvalidWaypointsError: It has.
        """
        if self.first_comma is None:
            return
        for number, line in self._table.rows():
            cells = self._table.dialect.cells(line, self._table.most)
            if any("." in cells[index] for index in self._used if index < len(cells)):
                message = (
                    f"decimal points here and decimal commas in line {self.first_comma}:"
                    " it is not clear which of them separates thousands"
                )
                raise refused("DECIMAL_MARKS", message, number, "write decimal points only")


def read_numbers(table: CsvTable, used: Sequence[int], names: Sequence[str]) -> Numbers:
    """Read some columns of all rows.

    Args:
        table: The file.
        used: Indices of the columns, the first two of which are x and y.
        names: What to call them in findings, as many.

    Raises:
        InvalidWaypointsError: There are fewer than 2 or more than 100,000 waypoints, rows have
            different numbers of columns, or a cell is not a number or out of range.
    """
    reader = _Rows(table, used, names)
    reader.read()
    findings = reader.findings
    values = np.array(reader.rows, dtype=np.float64).reshape(-1, len(used))
    findings.extend(_out_of_range(values, reader.lines, table, used, names))
    if findings:
        findings.sort(key=lambda found: found.line or 0)
        raise InvalidWaypointsError(findings[:MAX_FINDINGS])
    if len(values) < 2:
        message = "the file has one waypoint; a path needs at least 2"
        raise refused("TOO_FEW_POINTS", message, table.first + 1)
    reader.check_decimal_marks()
    return Numbers(values, reader.lines, reader.first_comma is not None)


def first_rows(table: CsvTable, rows: int, columns: int) -> Floats:
    """Return the numbers of the first rows and columns; NaN where there is none, or an endless one.

    Args:
        table: The file.
        rows: How many.
        columns: How many.

    Returns:
        Shape (n, k), n <= rows, k <= columns.
    """
    width = min(columns, table.least)
    found = []
    for _, line in table.rows():
        cells = table.dialect.cells(line, table.most)[:width]
        row = [_number_or_nan(cell) for cell in cells]
        found.append(row + [np.nan] * (width - len(row)))
        if len(found) == rows:
            break
    return np.array(found, dtype=np.float64).reshape(-1, width)


def _number_or_nan(cell: str) -> float:
    try:
        number = number_in(cell)
    except ValueError:
        return np.nan
    return number if abs(number) < _LARGEST else np.nan


def _out_of_range(
    values: Floats, lines: list[int], table: CsvTable, used: Sequence[int], names: Sequence[str]
) -> Iterator[Finding]:
    """Yield the first number of each row that is not finite or out of range, for some rows."""
    limits = np.array([MAX_COORDINATE_M, MAX_COORDINATE_M, *[np.inf] * (len(used) - 2)])
    wrong = ~(np.isfinite(values) & (np.abs(values) <= limits))
    for row in np.flatnonzero(wrong.any(axis=1))[:MAX_FINDINGS].tolist():
        k = int(wrong[row].argmax())
        line = table.lines[lines[row] - 1]
        if np.isfinite(values[row, k]):
            code, what = "TOO_FAR", f"is not within +-{MAX_COORDINATE_M:,.0f} m"
        else:
            code, what = "NOT_FINITE", "is not finite"
        cell = table.dialect.cells(line, table.most)[used[k]]
        place = table.dialect.place(line, used[k])
        yield finding(code, f"{names[k]}: {shown(cell)} {what}", lines[row], place)
