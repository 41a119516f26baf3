"""Where a waypoint file has x, y and the heading, by the names of its columns or their order."""

from collections.abc import Sequence
from dataclasses import dataclass

from domain.errors import InvalidValueError
from domain.paths.headings import Heading
from service.files.csv_names import (
    ColumnName,
    Meaning,
    column_name,
    is_degrees,
    is_metres,
    is_radians,
)

EXAMPLE = "?columns=x,y,yaw"

_QUATERNION = (Meaning.QX, Meaning.QY, Meaning.QZ, Meaning.QW)


_UNKNOWN = "UNKNOWN_COLUMNS"


class UnknownColumnsError(Exception):
    """Names of columns from which x and y do not follow; whoever reads a file knows the line."""

    def __init__(self, message: str, code: str = _UNKNOWN, hint: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.code = code
        self.hint = hint or f"say what the columns are, such as {EXAMPLE}; _ stands for any other"

    @property
    def are_columns(self) -> bool:
        """Return whether these are names of columns at all, although not of x and y."""
        return self.code != _UNKNOWN


@dataclass(frozen=True, slots=True)
class Columns:
    """Where a file has its waypoints; each is the index of a column."""

    x: int
    y: int
    yaw: int | None
    headings: tuple[Heading, ...]
    """Possible units of `yaw`, the most usual first."""
    quaternion: tuple[int | None, int | None, int, int] | None
    """x, y, z and w of a rotation; x and y may be missing, and are 0 then."""
    names: tuple[ColumnName, ...]
    is_named: bool
    """Whether names say so; otherwise it is the order of columns."""

    @property
    def used(self) -> tuple[int, ...]:
        """Return the indices of the columns that are read."""
        more = (self.yaw, *(self.quaternion or ()))
        return (self.x, self.y, *(index for index in more if index is not None))


def column_names(text: str) -> tuple[str, ...]:
    """Return the names in a list of columns such as `s,x,y,psi_rad`; `-` and `_` are no names.

    Raises:
        InvalidValueError: There is no x and y in m among them, or more than one.
    """
    names = tuple(name.strip() for name in text.split(","))
    try:
        named(names)
    except UnknownColumnsError as error:
        raise InvalidValueError(f"{error.message}; name the columns, such as x,y,yaw") from error
    return names


def unnamed(width: int) -> Columns:
    """Return the columns of a file that names none: `x,y[,yaw[,...]]`.

    Args:
        width: Number of its columns, at least 2.
    """
    meanings = [Meaning.X, Meaning.Y, Meaning.YAW][:width]
    names = [ColumnName(meaning) for meaning in meanings]
    names += [ColumnName(Meaning.OTHER)] * (width - len(names))
    usual = (Heading.RAD, Heading.DEG, Heading.COMPASS)
    return Columns(0, 1, 2 if width > 2 else None, usual, None, tuple(names), is_named=False)


def named(names: Sequence[str]) -> Columns:
    """Return the columns that names describe.

    Raises:
        UnknownColumnsError: There is no x and y in m among them, or more than one.
    """
    found = tuple(column_name(name) for name in names)
    x, y = _position(found)
    yaw = _yaw(found)
    quaternion = _quaternion(found)
    if yaw is not None:
        # One of them is enough, and an angle needs no normalising.
        quaternion = None
    headings = () if yaw is None else _headings_in(found[yaw].unit)
    return Columns(x, y, yaw, headings, quaternion, found, is_named=True)


def _position(names: Sequence[ColumnName]) -> tuple[int, int]:
    """Return the indices of x and y.

    Raises:
        UnknownColumnsError: There are none, or several, or they are not in m.
    """
    pairs: dict[tuple[int, tuple[str, ...]], tuple[list[int], list[int]]] = {}
    for index, name in enumerate(names):
        if name.meaning in (Meaning.X, Meaning.Y):
            found = pairs.setdefault((name.rank, name.context), ([], []))
            found[name.meaning is Meaning.Y].append(index)
    complete = {key: pair for key, pair in pairs.items() if pair[0] and pair[1]}
    if not complete:
        if {Meaning.LATITUDE, Meaning.LONGITUDE} <= {name.meaning for name in names}:
            message = "latitude and longitude are not x and y in m"
            hint = "project them first, such as to UTM"
            raise UnknownColumnsError(message, "LATITUDE_LONGITUDE", hint)
        raise UnknownColumnsError("no column is named x, or none y")
    best = min(rank for rank, _ in complete)
    pairs_of_best = [pair for (rank, _), pair in complete.items() if rank == best]
    if len(pairs_of_best) > 1 or any(len(axis) > 1 for axis in pairs_of_best[0]):
        raise UnknownColumnsError("more than one column could be x, or y", "AMBIGUOUS_COLUMNS")
    (x,), (y,) = pairs_of_best[0]
    for index in (x, y):
        unit = names[index].unit
        if not is_metres(unit):
            message = f"{names[index].meaning} is in {unit}: only m are read"
            hint = "convert it to m, or say ?columns=x,y if it is in m"
            raise UnknownColumnsError(message, "WRONG_UNIT", hint)
    return x, y


def _yaw(names: Sequence[ColumnName]) -> int | None:
    """Return the index of the heading; of several, the first with the plainest name."""
    found = [index for index, name in enumerate(names) if name.meaning is Meaning.YAW]
    return min(found, key=lambda index: names[index].rank, default=None)


def _quaternion(
    names: Sequence[ColumnName],
) -> tuple[int | None, int | None, int, int] | None:
    """Return the indices of the first quaternion that has z and w; None: there is none."""
    parts: dict[tuple[str, ...], dict[Meaning, int]] = {}
    for index, name in enumerate(names):
        if name.meaning in _QUATERNION:
            parts.setdefault(name.context, {}).setdefault(name.meaning, index)
    for found in parts.values():
        z, w = found.get(Meaning.QZ), found.get(Meaning.QW)
        if z is not None and w is not None:
            return found.get(Meaning.QX), found.get(Meaning.QY), z, w
    return None


def _headings_in(unit: str | None) -> tuple[Heading, ...]:
    if unit == "compass":
        return (Heading.COMPASS,)
    if is_degrees(unit):
        return (Heading.DEG, Heading.COMPASS)
    radians = (Heading.RAD, Heading.RAD_NORTH, Heading.RAD_COMPASS)
    if is_radians(unit):
        return radians
    return (Heading.RAD, Heading.DEG, Heading.COMPASS, *radians[1:])
