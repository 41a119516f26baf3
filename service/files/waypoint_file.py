"""Waypoint files: CSV as recorders, planners and spreadsheets write it, read as x, y and yaw.

`csv_dialect` finds the separator, `csv_table` header and rows, `csv_columns` what the columns mean,
`csv_numbers` the numbers, and `csv_suspects` columns that are something else. Here headings are
read, and checked against the path.
"""

from dataclasses import dataclass

from domain.arrays import Floats, np
from domain.paths.headings import Fit, Heading, Ways, along, wrapped
from domain.paths.preview import PathWarning
from service.files.csv_columns import (
    EXAMPLE,
    Columns,
    UnknownColumnsError,
    named,
    unnamed,
)
from service.files.csv_names import Meaning
from service.files.csv_numbers import Numbers, first_rows, read_numbers
from service.files.csv_reading import CsvReading, reading_of
from service.files.csv_suspects import COLUMNS, ROWS, Suspect, no_place_in, other_format_in
from service.files.csv_table import (
    MAX_FINDINGS,
    CsvTable,
    InvalidWaypointsError,
    Names,
    finding,
    read_table,
    refused,
    shown,
)

_NO_ROTATION = 1e-6
_QUATERNION = (Heading.RAD,)


@dataclass(frozen=True, slots=True)
class WaypointFile:
    """The waypoints of a file, and how it was read."""

    waypoints: Floats
    """Shape (n, 3): x m, y m, yaw rad."""
    reading: CsvReading
    refusal: InvalidWaypointsError | None
    """Why no task is made of it until somebody says what the columns are; None: it is clear."""


@dataclass(frozen=True, slots=True)
class _Headings:
    """Headings of all waypoints, and what is to be told of them."""

    yaws: Floats
    unit: Heading | None = None
    fit: Fit | None = None
    """None: they do not fit, or are those of the path."""
    from_path: bool = False
    warning: PathWarning | None = None
    misfit_at: int | None = None
    """Index of the first waypoint whose heading does not fit; None: they fit, or have to."""


def read_waypoints_csv(
    text: str, heading: Heading | None = None, columns: Names | None = None
) -> Floats:
    """Return the waypoints of a file of which it is clear what its columns are.

    Args:
        text: The CSV.
        heading: Unit of the headings; None: the one that is named, or fits the path.
        columns: Names of the columns; None: those in the file, or `x,y[,yaw[,...]]`.

    Returns:
        Shape (n, 3): x m, y m, yaw rad.

    Raises:
        InvalidWaypointsError: As for `read_waypoint_file`; or the headings fit in no unit.
    """
    found = read_waypoint_file(text, heading, columns)
    if found.refusal is not None:
        raise found.refusal
    return found.waypoints


def read_waypoint_file(
    text: str, heading: Heading | None = None, columns: Names | None = None
) -> WaypointFile:
    """Read a file; 100,000 waypoints take some 0.3 s.

    Args:
        text: The CSV.
        heading: As for `read_waypoints_csv`.
        columns: As for `read_waypoints_csv`; see `csv_columns.column_names`.

    Raises:
        InvalidWaypointsError: There are fewer than 2 or more than 100,000 points, rows differ in
            length, a cell is not a number or out of range, or the columns cannot be a path.
    """
    table = read_table(text, _is_header if columns is None else None)
    names = columns or (() if table.header is None else table.header.names)
    where = _columns_of(table, names)
    sample = None if names else first_rows(table, ROWS, COLUMNS)
    if sample is not None:
        _refuse(table, other_format_in(sample))
    labels = [where.names[index].meaning for index in where.used]
    numbers = read_numbers(table, where.used, labels)
    ways = Ways(numbers.values[:, :2])
    is_given = heading is not None or columns is not None
    headings = _headings(numbers, where, ways, heading, is_given=is_given)
    if sample is not None:
        fit = headings.fit
        suspect = no_place_in(
            sample,
            numbers.values[:, :2],
            is_heading=_is_heading(fit, sample),
            may_be_heading=fit is not None and fit.is_close,
        )
        _refuse(table, suspect)
    reading = reading_of(
        table,
        names,
        where,
        headings.unit,
        has_decimal_comma=numbers.has_decimal_comma,
        headings_from_path=headings.from_path,
        warnings=() if headings.warning is None else (headings.warning,),
    )
    waypoints = np.column_stack((numbers.values[:, :2], headings.yaws))
    return WaypointFile(waypoints, reading, _refusal(table, numbers, where, headings))


# --- columns -------------------------------------------------------------------------------------


def _is_header(names: Names) -> bool:
    """Return whether a line names x and y, or latitude and longitude, or several of them."""
    try:
        named(names)
    except UnknownColumnsError as error:
        return error.are_columns
    return True


def _columns_of(table: CsvTable, names: Names) -> Columns:
    """Return what the columns mean.

    Raises:
        InvalidWaypointsError: Header or number of columns do not say where x and y are.
    """
    first = table.first + 1
    if table.least < 2:
        message = "one column; x and y are needed, separated by comma, semicolon, tab or blanks"
        raise refused("TOO_FEW_COLUMNS", message, first)
    if not names:
        if table.title is not None:
            line = shown(table.lines[table.title])
            message = f"{line} does not name {table.least} columns with x and y among them"
            raise refused("HEADER", message, table.title + 1, _say_columns())
        return unnamed(table.least)
    try:
        where = named(names)
    except UnknownColumnsError as error:
        line_number = first if table.header is None else table.header.line
        raise refused(error.code, error.message, line_number, error.hint) from error
    if max(where.used) >= table.most:
        message = f"{table.most} columns, and x, y or the heading was said to be in a later one"
        raise refused("TOO_FEW_COLUMNS", message, first, _say_columns())
    return where


def _say_columns(example: str = EXAMPLE) -> str:
    return f"say what the columns are, such as {example}; _ stands for any other"


def _refuse(table: CsvTable, suspect: Suspect | None) -> None:
    """Refuse a file whose columns are something else.

    Raises:
        InvalidWaypointsError: They are.
    """
    if suspect is not None:
        raise refused("NOT_A_PATH", suspect.message, table.first + 1, suspect.hint)


def _is_heading(fit: Fit | None, sample: Floats) -> bool:
    """Return whether the third column is a heading beyond doubt.

    Degrees also have to be the same everywhere: y in m is within 10 degrees of a way along x soon.
    """
    if fit is None or fit.follows:
        return fit is not None
    return fit.is_close and (fit.heading is Heading.RAD or float(np.ptp(sample[:, 2])) == 0.0)


# --- headings ------------------------------------------------------------------------------------


def _headings(
    numbers: Numbers, where: Columns, ways: Ways, heading: Heading | None, *, is_given: bool
) -> _Headings:
    """Read the headings.

    Args:
        numbers: The columns of `where.used`.
        where: What they mean.
        ways: Directions of the path.
        heading: Unit of the headings, if it was said.
        is_given: Whether somebody said what the columns or headings are: then they are taken.

    Raises:
        InvalidWaypointsError: A quaternion is 0.
    """
    places = numbers.values[:, :2]
    among: tuple[Heading, ...]
    if where.quaternion is not None:
        values, among = _yaws_of_quaternions(numbers, where), _QUATERNION
    elif where.yaw is not None:
        values, among = numbers.values[:, 2], where.headings
    else:
        return _Headings(along(places), from_path=True)
    if heading is not None and where.yaw is not None:
        among = (heading,)
    is_empty = not is_given and not values.any()
    among = (Heading.RAD,) if is_empty else among
    is_known = where.is_named or heading is not None
    fit, fits = ways.best_fit(values, among, is_named=is_known or is_empty)
    if is_empty and not fits:
        message = "all headings are 0 and do not fit the path; the directions of the path are used"
        warning = PathWarning("HEADINGS_ZERO", message)
        return _Headings(along(places), from_path=True, warning=warning)
    unit = None if where.quaternion is not None else fit.heading
    yaws = fit.heading.yaws(values)
    if fits:
        warning_or_none = _reversed_warning() if fit.is_reversed else None
        return _Headings(yaws, unit, fit, warning=warning_or_none)
    at = ways.first_misfit(values, fit.heading)
    misfit = _misfit_warning(fit, where, at, is_given=is_given)
    if is_given:
        return _Headings(yaws, unit, warning=misfit)
    return _Headings(yaws, unit if len(among) == 1 else None, warning=misfit, misfit_at=at)


def _yaws_of_quaternions(numbers: Numbers, where: Columns) -> Floats:
    """Return headings of rotations, which need not be normalised; shape (n,), rad.

    Raises:
        InvalidWaypointsError: A quaternion is 0.
    """
    columns = dict(zip(where.used, numbers.values.T, strict=True))
    zeros = np.zeros(len(numbers.values))
    parts = np.array(
        [zeros if index is None else columns[index] for index in where.quaternion or ()]
    )
    largest = np.abs(parts).max(axis=0)
    wrong = np.flatnonzero(largest < _NO_ROTATION)[:MAX_FINDINGS].tolist()
    if wrong:
        message = "a quaternion of 0 is no rotation"
        found = [finding("NO_ROTATION", message, numbers.lines[row]) for row in wrong]
        raise InvalidWaypointsError(found, _say_columns("?columns=x,y"))
    x, y, z, w = parts / largest
    return wrapped(np.arctan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z))


def _reversed_warning() -> PathWarning:
    message = (
        "the headings point backwards along the path, as of a vehicle that reversed;"
        " the path is driven forwards"
    )
    return PathWarning("HEADINGS_REVERSED", message)


def _misfit_warning(fit: Fit, where: Columns, at: int, *, is_given: bool) -> PathWarning:
    angle = f"{np.degrees(fit.misfit_rad):.0f} degrees off"
    if where.yaw is None:
        message = f"the quaternions do not fit the path as headings: {angle}"
    elif is_given or len(where.headings) == 1:
        message = f"the headings do not fit the path in {fit.heading.words}: {angle}"
    else:
        which = "third" if not where.is_named else "heading"
        message = f"the {which} column fits the path as a heading in no unit: {angle} at best"
    hint = None if is_given else _hint_without_headings(where)
    return PathWarning("HEADINGS_MISFIT", message, at, hint)


def _refusal(
    table: CsvTable, numbers: Numbers, where: Columns, headings: _Headings
) -> InvalidWaypointsError | None:
    """Return why the file is not driven as it is; None: it is."""
    if headings.misfit_at is None or headings.warning is None:
        return None
    line = numbers.lines[headings.misfit_at]
    column = (where.quaternion or (0, 0, 0, 0))[2] if where.yaw is None else where.yaw
    place = table.dialect.place(table.lines[line - 1], column)
    found = finding(headings.warning.code, headings.warning.message, line, place)
    return InvalidWaypointsError([found], _hint_without_headings(where))


def _hint_without_headings(where: Columns) -> str:
    """Return how to say that a column is no heading, or that it is one."""
    last = max(where.x, where.y)
    roles = {where.x: Meaning.X, where.y: Meaning.Y}
    names = ",".join(roles.get(index, "_") for index in range(last + 1))
    if where.quaternion is not None:
        return f"?columns={names} leaves the quaternions out"
    return (
        f"?columns={names} if it is no heading, or all columns, such as ?columns=s,x,y;"
        f" ?heading=rad, deg or compass if it is one"
    )
