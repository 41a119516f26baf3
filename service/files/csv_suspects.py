"""Files whose first two columns cannot be x and y, although they are numbers.

Recognised by what the first rows hold, for files that do not name their columns.
"""

from dataclasses import dataclass

from domain.arrays import Floats, np

ROWS = 200
COLUMNS = 12

_UNIX_TIME = 1e8
"""Larger than any coordinate; a time in s since 1970 has been since 1973."""
_DEGREES_APART = 0.2
"""A path of that many m is not driven; in degrees of latitude it is 20 km."""
_FAR = 100.0
"""How many times its extent a path in degrees is away from 0."""
_ENOUGH = 0.9
_STEP_M = 0.02
_SOME_ROWS = 10


@dataclass(frozen=True, slots=True)
class Suspect:
    """What the first two columns are instead of x and y."""

    message: str
    hint: str


def other_format_in(sample: Floats) -> Suspect | None:
    """Return what the columns are if they begin with a time, or are matrices.

    Args:
        sample: The first rows and columns, shape (n, k), n >= 1, k >= 2; NaN: not a number.
    """
    if _is_time(sample[:, 0]):
        is_rotated = sample.shape[1] >= 8 and _are_units(sample[:, 4:8])
        columns = "time,x,y,z,qx,qy,qz,qw" if is_rotated else "time,x,y"
        message = "the first column holds a time, so the first two are not x and y"
        return Suspect(message, f"say what the columns are, such as ?columns={columns}")
    if sample.shape[1] == COLUMNS and _are_matrices(sample):
        message = "12 numbers in each line are poses as 3x4 matrices; the first two are not x and y"
        # The plane of a camera that looks ahead is that of x and z.
        places = "?columns=_,_,_,x,_,_,_,_,_,_,_,y"
        return Suspect(message, f"write x,y of each pose, or say where they are, such as {places}")
    return None


def no_place_in(
    sample: Floats, places: Floats, *, is_heading: bool, may_be_heading: bool
) -> Suspect | None:
    """Return what the first two columns are if they cannot be x and y in m; None: they can.

    Args:
        sample: As for `other_format_in`.
        places: The first two columns of all rows; finite.
        is_heading: Whether the third column is a heading beyond doubt.
        may_be_heading: Whether it fits as one.
    """
    if sample.shape[1] >= 3 and not is_heading:
        if _is_distance(sample[:, :3]):
            message = "the first column is the distance along the path of the next two, not x"
            return Suspect(message, "say what the columns are, such as ?columns=s,x,y")
        if _is_count(sample[:, :3]) or (not may_be_heading and _is_clock(sample[:, :3])):
            message = "the first column grows evenly, like a time or a count"
            hint = "say what the columns are, such as ?columns=t,x,y, or ?columns=x,y if it is x"
            return Suspect(f"{message}, and the third is no heading", hint)
    if _are_degrees(places):
        message = "the first two columns look like latitude and longitude, not x and y in m"
        return Suspect(message, "project them, such as to UTM; ?columns=x,y if they are m")
    return None


def _is_time(column: Floats) -> bool:
    return bool((column > _UNIX_TIME).all() and (np.diff(column) >= 0).all())


def _are_units(quaternions: Floats) -> bool:
    return bool((np.abs(np.linalg.norm(quaternions, axis=1) - 1) < 0.01).all())


def _are_matrices(rows: Floats) -> bool:
    """Return whether the first three of each four numbers are a row of a rotation matrix."""
    axes = rows.reshape(-1, 3, 4)[:, :, :3]
    return bool((np.abs(np.linalg.norm(axes, axis=2) - 1) < 0.01).all())


def _is_distance(rows: Floats) -> bool:
    """Return whether the first column grows as the distance between the places of the others."""
    grown = np.diff(rows[:, 0])
    moved = np.hypot(np.diff(rows[:, 1]), np.diff(rows[:, 2]))
    # A vehicle that stands jitters, and so does its heading.
    steps = np.maximum(grown, moved) > _STEP_M
    if steps.sum() < 2 or not (grown >= 0).all():
        return False
    total = float(grown.sum())
    if abs(total - float(moved.sum())) > 0.05 * total:
        return False
    # Each step is rounded, to 1 cm in some files.
    close = np.abs(grown - moved)[steps] <= 0.25 * grown[steps]
    return float(close.mean()) >= _ENOUGH


def _is_count(rows: Floats) -> bool:
    """Return whether the first column counts the rows, while the other two change."""
    return len(rows) > 2 and bool((np.diff(rows[:, 0]) == 1).all()) and _change(rows)


def _is_clock(rows: Floats) -> bool:
    """Return whether the first column grows evenly, while the other two change."""
    grown = np.diff(rows[:, 0])
    if len(rows) < _SOME_ROWS or not (grown > 0).all():
        return False
    return float(grown.std()) <= 0.2 * float(grown.mean()) and _change(rows)


def _change(rows: Floats) -> bool:
    return bool((np.ptp(rows[:, 1:], axis=0) > 0).all())


def _are_degrees(places: Floats) -> bool:
    """Return whether places are in the range of degrees, all but one in m, and far from 0."""
    if not (np.abs(places) <= 180.0).all():
        return False
    extent = float(np.ptp(places, axis=0).max())
    return 0 < extent < _DEGREES_APART and float(np.abs(places[0]).max()) > _FAR * extent
