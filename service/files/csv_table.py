"""A file of waypoints as lines of cells: comments, header, separator and rows.

It knows nothing of what the columns mean.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from domain.errors import PilothouseError
from domain.findings import Finding
from domain.paths.waypoints import MAX_WAYPOINTS
from service.files.csv_dialect import MAX_COLUMNS, Dialect, dialect_of, is_text
from service.files.text_file import lines_of

MAX_FINDINGS = 20

_MAX_LINES = 2 * MAX_WAYPOINTS
_COMMENTS = ("#", "%")
_MAX_TITLES = 20
"""Lines of text before the first number."""
_MAX_NAME = 80
_BEFORE_UNIT = re.compile(r"[ \t]+(?=[\[(])")
_HINT = "each line must be x,y or x,y,yaw in m and rad; ?columns= names other columns"


class InvalidWaypointsError(PilothouseError):
    """An invalid waypoint file; `findings` hold the first errors, at most `MAX_FINDINGS`."""

    code = "INVALID_WAYPOINTS"

    def __init__(self, findings: Sequence[Finding], hint: str = _HINT) -> None:
        first = findings[0]
        more = f" (and {len(findings) - 1} more)" if len(findings) > 1 else ""
        super().__init__(f"the waypoints are invalid: line {first.line}: {first.message}{more}")
        self.findings = tuple(findings)
        self.hint = hint


Names = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Header:
    """The line that names the columns."""

    line: int
    names: Names


@dataclass(frozen=True, slots=True)
class CsvTable:
    """The rows of a file, as yet unread."""

    dialect: Dialect
    header: Header | None
    """None: no line names the columns."""
    title: int | None
    """Index in `lines` of the line of text before the rows, which is no header; None: there is
    none."""
    lines: list[str]
    first: int
    """Index of the first row in `lines`."""
    least: int
    """Columns that each row must have."""
    most: int
    """Columns that a row may have; further empty ones are ignored."""

    def rows(self) -> Iterator[tuple[int, str]]:
        """Yield the number and text of each line that is not a comment, also of empty ones."""
        for index in range(self.first, len(self.lines)):
            line = self.lines[index]
            if not line.startswith(_COMMENTS) and not line.lstrip().startswith(_COMMENTS):
                yield index + 1, line


def read_table(text: str, names_columns: Callable[[Names], bool] | None) -> CsvTable:
    """Find header, separator and rows of a file.

    Args:
        text: The file.
        names_columns: Decides whether a line of text is the header; None: none is needed.

    Raises:
        InvalidWaypointsError: It has no row of numbers, or too many lines or columns.
    """
    # Spreadsheets write a byte order mark before the first number.
    text = text.removeprefix("\ufeff").rstrip()
    if "\0" in text:
        line = len(lines_of(text[: text.index("\0")]))
        message = "this is not text: it contains null characters"
        raise refused("NOT_TEXT", message, line, "save the file as CSV in UTF-8")
    # CRLF counts twice, and is not yet one character.
    if text.count("\n") + text.count("\r") >= 2 * _MAX_LINES:
        raise too_many_points(_MAX_LINES + 1)
    lines = lines_of(text)
    if len(lines) > _MAX_LINES:
        raise too_many_points(_MAX_LINES + 1)
    comments, titles, first = _top(lines)
    row = lines[first]
    dialect = dialect_of(row)
    cells = dialect.cells(row)
    if len(cells) > MAX_COLUMNS:
        raise refused("TOO_MANY_COLUMNS", f"more than {MAX_COLUMNS:,} columns", first + 1)
    least, most = len(_trimmed(cells)), len(cells)
    header = None
    if names_columns is not None:
        # A line of text right before the rows that names nothing may hold units: that is an error.
        candidates = titles[-1:] or comments[: -_MAX_TITLES - 1 : -1]
        header = _header(candidates, lines, dialect, (least, most), names_columns)
    if header is not None:
        most = max(most, len(header.names))
    title = titles[-1] if titles and header is None else None
    return CsvTable(dialect, header, title, lines, first, least, most)


def refused(
    code: str, message: str, line: int, hint: str = _HINT, column: int = 1
) -> InvalidWaypointsError:
    """Return the error with one finding."""
    return InvalidWaypointsError([finding(code, message, line, column)], hint)


def finding(code: str, message: str, line: int, column: int = 1) -> Finding:
    """Return a finding; line and column count from 1."""
    return Finding("error", code, message, line=line, column=column)


def too_many_points(line: int) -> InvalidWaypointsError:
    """Return the error for a path that is too long."""
    message = f"a path has at most {MAX_WAYPOINTS:,} waypoints"
    hint = "thin the points out: one every 0.1 m is enough"
    return refused("TOO_MANY_POINTS", message, line, hint)


def shown(text: str) -> str:
    """Return a cell or a line as it is quoted in messages."""
    text = text[:200].strip()
    return repr(text if len(text) <= 40 else f"{text[:37]}...")


def _top(lines: list[str]) -> tuple[list[int], list[int], int]:
    """Return the indices of comments and of lines of text before the first row, and of this row.

    Raises:
        InvalidWaypointsError: There is no row.
    """
    comments: list[int] = []
    titles: list[int] = []
    for index, line in enumerate(lines):
        bare = line.lstrip()
        if not bare:
            continue
        if bare.startswith(_COMMENTS):
            comments.append(index)
        elif is_text(line) and len(titles) < _MAX_TITLES:
            titles.append(index)
        elif is_text(line):
            break
        else:
            return comments, titles, index
    if titles:
        message = f"{shown(lines[titles[0]])} and no line of numbers"
        raise refused("NO_NUMBERS", message, titles[0] + 1)
    raise refused("EMPTY_FILE", "the file has no waypoints", 1)


def _header(
    candidates: list[int],
    lines: list[str],
    dialect: Dialect,
    columns: tuple[int, int],
    names_columns: Callable[[Names], bool],
) -> Header | None:
    """Return the first of some lines that names as many columns as a row has."""
    for index in candidates:
        line = lines[index].lstrip().lstrip("".join(_COMMENTS))
        for separator in dict.fromkeys((dialect.separator, ",", ";", "\t", " ")):
            # Blanks before a unit separate nothing.
            text = _BEFORE_UNIT.sub("", line) if separator == " " and '"' not in line else line
            cells = Dialect(separator).cells(text)
            names = tuple(cell.strip().strip('"')[:_MAX_NAME] for cell in cells)
            fitting = len(names) == columns[1] or columns[0] <= len(_trimmed(names)) <= columns[1]
            if fitting and names_columns(names):
                return Header(index + 1, names)
    return None


def _trimmed(cells: Sequence[str]) -> Sequence[str]:
    """Return cells without empty ones at the end."""
    count = len(cells)
    while count and not cells[count - 1].strip():
        count -= 1
    return cells[:count]
