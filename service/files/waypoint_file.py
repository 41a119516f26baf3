"""Waypoint files: CSV with `x,y,yaw[,...]`, as smart_polaris records and drives them.

Such files hold one of three headings and never say which: radians, degrees, or a compass's. Radians
are meant unless told; a file that is visibly otherwise is refused with what to say.
"""

import math
from collections.abc import Iterator
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from domain.errors import PilothouseError
from domain.findings import Finding
from domain.paths.waypoints import COLUMNS, MAX_COORDINATE_M, MAX_WAYPOINTS

MAX_FINDINGS = 20
_LEAST_STEP_M = 0.3
"""Directions between places closer than this say nothing about the heading."""
_FITS_RAD = 0.2
_MISFITS_RAD = 0.6


class Heading(StrEnum):
    """What the third column of a file is."""

    RAD = "rad"
    """Counter-clockwise from the x axis, rad."""
    DEG = "deg"
    """Counter-clockwise from the x axis, degrees."""
    COMPASS = "compass"
    """Clockwise from north, degrees; x is east and y is north."""


class InvalidWaypointsError(PilothouseError):
    """A waypoint file with faults; `findings` hold the first of them."""

    code = "INVALID_WAYPOINTS"

    def __init__(self, findings: list[Finding], hint: str | None = None) -> None:
        first = findings[0]
        more = f" (and {len(findings) - 1} more)" if len(findings) > 1 else ""
        super().__init__(f"line {first.line}: {first.message}{more}")
        self.findings = tuple(findings)
        if hint is not None:
            self.hint = hint


def read_waypoints_csv(text: str, heading: Heading = Heading.RAD) -> NDArray[np.float64]:
    """Return the waypoints of a CSV, with their yaw in rad; shape (n, 3).

    Args:
        text: Lines that end in LF or CRLF; further columns are not looked at.
        heading: What the third column is.

    Raises:
        InvalidWaypointsError: A line is no waypoint, there are fewer than 2 or too many, or the
            headings are visibly not what `heading` says.
    """
    lines = text.replace("\r\n", "\n").split("\n")
    while lines and not lines[-1].strip():
        lines.pop()
    if len(lines) > MAX_WAYPOINTS:
        message = f"there are {len(lines)} lines; a path has at most {MAX_WAYPOINTS} waypoints"
        raise InvalidWaypointsError([_finding(MAX_WAYPOINTS + 1, 1, message)])
    rows: list[tuple[float, ...]] = []
    findings: list[Finding] = []
    for number, line in enumerate(lines, start=1):
        try:
            rows.append(_row(line, number))
        except _BadLineError as error:
            findings.append(error.finding)
            if len(findings) == MAX_FINDINGS:
                break
    if not findings and len(rows) < 2:
        message = f"a path has at least 2 waypoints, this file {len(rows)}"
        findings = [_finding(max(len(lines), 1), 1, message)]
    if findings:
        raise InvalidWaypointsError(findings, _hint_for(lines))
    waypoints = np.array(rows, dtype=np.float64)
    _judge_heading(waypoints, heading)
    return _in_radians(waypoints, heading)


class _BadLineError(Exception):
    def __init__(self, finding: Finding) -> None:
        super().__init__(finding.message)
        self.finding = finding


def _row(line: str, number: int) -> tuple[float, ...]:
    """Return x, y and the heading of a line.

    Raises:
        _BadLineError: It holds no waypoint.
    """
    cells = line.split(",")
    if len(cells) < len(COLUMNS):
        what = "is empty" if not line.strip() else f"has {len(cells)} columns"
        message = f"this line {what}; a waypoint is x,y,yaw"
        raise _BadLineError(_finding(number, 1, message))
    values = []
    column = 1
    for cell, name in zip(cells, COLUMNS, strict=False):
        values.append(_number(cell, name, number, column))
        column += len(cell) + 1
    return tuple(values)


def _number(cell: str, name: str, line: int, column: int) -> float:
    text = cell.strip()
    try:
        # float() alone accepts "1_0" and digits of other scripts.
        value = float(text) if text.isascii() and "_" not in text else math.nan
    except ValueError:
        value = math.nan
    within = math.inf if name == "yaw_rad" else MAX_COORDINATE_M
    if not math.isfinite(value) or abs(value) > within:
        message = f"{text[:40]!r} is no {name.partition('_')[0]}: a finite number is wanted"
        raise _BadLineError(_finding(line, column, message))
    return value


def _finding(line: int, column: int, message: str) -> Finding:
    return Finding("error", "INVALID_WAYPOINT", message, None, (), line, column)


def _hint_for(lines: list[str]) -> str | None:
    first = lines[0].replace(" ", "").lower() if lines else ""
    if first.startswith(("x,", "#", '"x"', "x_m,")):
        return "a waypoint file has no header line: leave the first line out"
    return None


def _judge_heading(waypoints: NDArray[np.float64], heading: Heading) -> None:
    """Refuse headings that are visibly something else.

    Raises:
        InvalidWaypointsError: They are degrees, or a compass's.
    """
    if heading is not Heading.RAD:
        return
    yaw = waypoints[:, 2]
    misfits = {kind: _misfit(waypoints, kind) for kind in Heading}
    too_large = np.abs(yaw) > math.tau
    others = [kind for kind in (Heading.DEG, Heading.COMPASS) if misfits[kind] < _FITS_RAD]
    # A heading that is the same everywhere was perhaps never recorded at all.
    fits_better = np.ptp(yaw) > 0 and misfits[Heading.RAD] > _MISFITS_RAD and bool(others)
    if not too_large.any() and not fits_better:
        return
    row = int(too_large.argmax()) if too_large.any() else 0
    likely = min(others, key=misfits.__getitem__, default=None)
    looks = {Heading.DEG: "degrees", Heading.COMPASS: "degrees of a compass"}
    guess = f"; they look like {looks[likely]}" if likely else ""
    message = f"the heading {yaw[row]:g} is not in radians{guess}"
    says = [f"?heading={likely}"] if likely else ["?heading=deg", "?heading=compass"]
    hint = f"say {' or '.join(says)} to have them converted"
    raise InvalidWaypointsError([_finding(row + 1, 1, message)], hint)


def _misfit(waypoints: NDArray[np.float64], kind: Heading) -> float:
    """Return by how much headings differ from the directions driven, in the median; rad."""
    differences = np.abs(
        [_wrapped(yaw - direction) for yaw, direction in _directions(waypoints, kind)]
    )
    return float(np.median(differences)) if len(differences) else 0.0


def _directions(waypoints: NDArray[np.float64], kind: Heading) -> Iterator[tuple[float, float]]:
    """Yield heading and direction to the next place that is far enough away; rad."""
    yaw = _in_radians(waypoints, kind)[:, 2].tolist()
    xs, ys = waypoints[:, 0].tolist(), waypoints[:, 1].tolist()
    at = 0
    for index in range(1, len(xs)):
        dx, dy = xs[index] - xs[at], ys[index] - ys[at]
        if math.hypot(dx, dy) >= _LEAST_STEP_M:
            yield yaw[at], math.atan2(dy, dx)
            at = index


def _in_radians(waypoints: NDArray[np.float64], heading: Heading) -> NDArray[np.float64]:
    """Return the waypoints with their headings as yaw; shape (n, 3)."""
    if heading is Heading.RAD:
        return waypoints
    yaw = np.radians(waypoints[:, 2])
    if heading is Heading.COMPASS:
        yaw = math.pi / 2 - yaw
    return np.column_stack((waypoints[:, :2], _wrapped(yaw)))


def _wrapped(angle: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """Return angles within -pi and pi."""
    return np.asarray((np.asarray(angle) + math.pi) % math.tau - math.pi)
