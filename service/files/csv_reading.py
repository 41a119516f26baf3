"""How a waypoint file was read, for a person to check."""

from collections.abc import Iterable
from dataclasses import dataclass

from domain.paths.headings import Heading
from domain.paths.preview import PathWarning
from service.files.csv_columns import Columns
from service.files.csv_names import Meaning
from service.files.csv_table import CsvTable

MAX_SHOWN = 50
"""Columns that are described."""
_MAX_NAMED = 8


@dataclass(frozen=True, slots=True)
class ColumnReading:
    """How one column was read."""

    name: str | None
    """In the file, or as asked; None: it has none."""
    meaning: Meaning | None
    """None: unknown, and not used."""
    used: bool
    unit: str | None
    """`m`, that of the heading, or the unit in the name of a column that is not used."""


@dataclass(frozen=True, slots=True)
class CsvReading:
    """How a file was read."""

    separator: str
    """comma, semicolon, tab or blank."""
    has_decimal_comma: bool
    header_line: int | None
    """Number of the line that names the columns, from 1; None: none does."""
    columns: tuple[ColumnReading, ...]
    """At most `MAX_SHOWN`."""
    column_count: int
    heading: Heading | None
    """Unit of the headings; None: they are from the path or from quaternions, or fit in no unit."""
    headings_from_path: bool
    warnings: tuple[PathWarning, ...]

    @property
    def words(self) -> str:
        """Return one sentence about it."""
        marks = ", with decimal commas" if self.has_decimal_comma else ""
        where = f", named in line {self.header_line}" if self.header_line else ""
        used = [
            f"{column.meaning} from {self._place(number, column)}"
            for number, column in self._numbered(used=True)
            if column.meaning in (Meaning.X, Meaning.Y)
        ]
        unused = [column.name or str(number) for number, column in self._numbered(used=False)]
        left_out = _listed(unused, self.column_count - len(self.columns))
        ending = f"; not used: {left_out}" if left_out else ""
        used.append(self._heading_words())
        return f"{self.separator}-separated{marks}{where}: {', '.join(used)}{ending}"

    def _heading_words(self) -> str:
        if self.headings_from_path:
            return "headings from the path"
        places = [
            self._place(number, column)
            for number, column in self._numbered(used=True)
            if column.meaning not in (Meaning.X, Meaning.Y)
        ]
        if self.columns_are_rotations:
            numbers = [
                str(number)
                for number, column in self._numbered(used=True)
                if column.meaning not in (Meaning.X, Meaning.Y)
            ]
            return f"heading from the quaternion in columns {', '.join(numbers)}"
        unit = "in a unit that is not clear" if self.heading is None else self.heading.words
        return f"heading from {places[0] if places else 'a later column'}, {unit}"

    @property
    def columns_are_rotations(self) -> bool:
        """Return whether headings are from quaternions."""
        return any(column.used and column.meaning is Meaning.QW for column in self.columns)

    def _numbered(self, *, used: bool) -> Iterable[tuple[int, ColumnReading]]:
        return (
            (number, column) for number, column in enumerate(self.columns, 1) if column.used is used
        )

    def _place(self, number: int, column: ColumnReading) -> str:
        if column.name is not None and self.header_line is not None:
            return f"{column.name} (column {number})"
        return f"column {number}"


def reading_of(
    table: CsvTable,
    names: tuple[str, ...],
    columns: Columns,
    heading: Heading | None,
    *,
    has_decimal_comma: bool,
    headings_from_path: bool,
    warnings: Iterable[PathWarning],
) -> CsvReading:
    """Describe how a file was read.

    Args:
        table: The file.
        names: Of its columns, as in the file or as asked; empty: none.
        columns: What they mean.
        heading: As in `CsvReading`.
        has_decimal_comma: Whether numbers have one.
        headings_from_path: Whether the file has no headings, or they are not used.
        warnings: What a person should check.
    """
    count = max(table.least, len(names))
    unused = {columns.yaw, *(columns.quaternion or ())} if headings_from_path else set()
    used = frozenset(columns.used) - unused
    shown = []
    for index in range(min(count, MAX_SHOWN)):
        name = columns.names[index] if index < len(columns.names) else None
        meaning = None if name is None or name.meaning is Meaning.OTHER else name.meaning
        unit = None if name is None else name.unit
        if index in (columns.x, columns.y):
            unit = "m"
        elif index == columns.yaw:
            unit = heading or unit
        given = names[index] if index < len(names) else ""
        is_name = any(character.isalnum() for character in given)
        shown.append(ColumnReading(given if is_name else None, meaning, index in used, unit))
    return CsvReading(
        table.dialect.word,
        has_decimal_comma,
        None if table.header is None else table.header.line,
        tuple(shown),
        count,
        heading,
        headings_from_path,
        tuple(warnings),
    )


def _listed(names: list[str], more: int) -> str:
    """Return some names, and how many there are besides."""
    rest = len(names) - _MAX_NAMED + more if len(names) > _MAX_NAMED else more
    listed = ", ".join(names[:_MAX_NAMED])
    if not names:
        return f"{more} more" if more else ""
    return f"{listed} and {rest} more" if rest else listed
