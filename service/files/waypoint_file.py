"""Waypoint files: a CSV without a header, `x,y,yaw[,...]` in each line.

Source: smart_polaris, `waypoint_logger` and recorded tracks, which use three heading conventions.
"""

from collections.abc import Iterator
from enum import StrEnum
from math import pi, tau

import numpy as np
from numpy.typing import NDArray

from domain.errors import PilothouseError
from domain.findings import Finding
from domain.paths.headings import Ways, wrapped
from domain.paths.waypoints import MAX_COORDINATE_M, MAX_WAYPOINTS

MAX_FINDINGS = 20

_NAMES = ("x", "y", "yaw")
_FORM = "each line must be x,y,yaw in m, m and rad, separated by commas, without a header"
_TURN_RAD = 1.001 * tau
"""A larger value is not a heading in radians, unless headings are unwrapped over several turns."""
_FEW_WAYS = 3
_MISFIT_RAD = 0.3
_GAIN = 4.0
"""How much better another unit must fit than headings of 0, since small degrees are close to 0."""


class Heading(StrEnum):
    """Unit and direction of the third column."""

    RAD = "rad"
    """Radians counter-clockwise from the x axis."""
    DEG = "deg"
    """Degrees counter-clockwise from the x axis."""
    COMPASS = "compass"
    """Degrees clockwise from north, which is the y axis."""


class InvalidWaypointsError(PilothouseError):
    """An invalid waypoint file; `findings` hold the first errors, at most `MAX_FINDINGS`."""

    code = "INVALID_WAYPOINTS"

    def __init__(self, findings: list[Finding], hint: str = _FORM) -> None:
        first = findings[0]
        more = f" (and {len(findings) - 1} more)" if len(findings) > 1 else ""
        super().__init__(f"the waypoints are invalid: line {first.line}: {first.message}{more}")
        self.findings = tuple(findings)
        self.hint = hint


def read_waypoints_csv(text: str, heading: Heading = Heading.RAD) -> NDArray[np.float64]:
    """Read waypoints; 100,000 of them take some 0.2 s.

    Lines end with LF or CRLF; empty lines are allowed only at the end. Further columns are ignored.

    Args:
        text: The CSV.
        heading: Unit and direction of the third column.

    Returns:
        Shape (n, 3): x m, y m, yaw rad.

    Raises:
        InvalidWaypointsError: There are fewer than 2 or more than 100,000 points, a cell is not a
            number or out of range, or headings that should be radians are degrees.
    """
    # Spreadsheets write a byte order mark before the first number.
    lines = text.removeprefix("\ufeff").rstrip().split("\n")
    if lines == [""]:
        raise InvalidWaypointsError([_finding("EMPTY_FILE", "the file has no waypoints", 1)])
    if len(lines) > MAX_WAYPOINTS:
        message = f"the file has {len(lines)} lines; a path has at most {MAX_WAYPOINTS} waypoints"
        finding = _finding("TOO_MANY_POINTS", message, MAX_WAYPOINTS + 1)
        raise InvalidWaypointsError([finding], "thin the points out: one every 0.1 m is enough")
    rows, findings = _numbers(lines)
    waypoints = np.array(rows, dtype=np.float64)
    findings.extend(_out_of_range(waypoints, lines))
    if not findings and len(rows) < 2:
        message = "the file has one waypoint; a path needs at least 2"
        findings = [_finding("TOO_FEW_POINTS", message, 1)]
    if findings:
        findings.sort(key=lambda finding: (finding.line or 0, finding.column or 0))
        raise InvalidWaypointsError(findings[:MAX_FINDINGS])
    if heading is Heading.RAD:
        _check_radians(waypoints, lines)
    else:
        waypoints[:, 2] = _yaws(waypoints[:, 2], heading)
    return waypoints


def _numbers(lines: list[str]) -> tuple[list[tuple[float, float, float]], list[Finding]]:
    """Return the numbers of each line, zeros for an invalid one, and the findings.

    Stops early once there are enough findings.
    """
    rows: list[tuple[float, float, float]] = []
    findings: list[Finding] = []
    for number, line in enumerate(lines, 1):
        cells = line.split(",", 3)
        try:
            rows.append((_number(cells[0]), _number(cells[1]), _number(cells[2])))
        except (ValueError, IndexError):
            rows.append((0.0, 0.0, 0.0))
            findings.extend(_faults(number, line))
            if len(findings) >= MAX_FINDINGS:
                break
    return rows, findings


def _number(cell: str) -> float:
    # float() also accepts "1_0" and the digits of other scripts.
    if "_" in cell or not cell.isascii():
        raise ValueError
    return float(cell)


def _faults(number: int, line: str) -> Iterator[Finding]:
    """Yield the findings of a line that does not begin with three numbers."""
    cells = _columns(line)
    if not line.strip():
        yield _finding("EMPTY_LINE", "empty line; empty lines are allowed only at the end", number)
    elif number == 1 and all(map(_is_text, cells)):
        message = f"{_shown(line)} looks like a header; remove it"
        yield _finding("HEADER", message, number)
    elif len(cells) < len(_NAMES):
        message = f"{len(cells)} columns; x, y and yaw are required, separated by commas"
        yield _finding("TOO_FEW_COLUMNS", message, number)
    else:
        for name, cell, column in zip(_NAMES, cells, _starts(cells), strict=False):
            if _is_text(cell):
                what = f"{_shown(cell)} is not a number" if cell.strip() else "missing number"
                yield _finding("NOT_A_NUMBER", f"{name}: {what}", number, column)


def _out_of_range(waypoints: NDArray[np.float64], lines: list[str]) -> Iterator[Finding]:
    """Yield the numbers that are not finite or out of range, at most `MAX_FINDINGS`."""
    limits = np.array([MAX_COORDINATE_M, MAX_COORDINATE_M, np.inf])
    wrong = np.argwhere(~(np.isfinite(waypoints) & (np.abs(waypoints) <= limits)))
    for row, k in wrong[:MAX_FINDINGS].tolist():
        cells = _columns(lines[row])
        if np.isfinite(waypoints[row, k]):
            code, what = "TOO_FAR", f"is not within +-{MAX_COORDINATE_M:,.0f} m"
        else:
            code, what = "NOT_FINITE", "is not finite"
        message = f"{_NAMES[k]}: {_shown(cells[k])} {what}"
        yield _finding(code, message, row + 1, _starts(cells)[k])


def _check_radians(waypoints: NDArray[np.float64], lines: list[str]) -> None:
    """Check that headings are radians.

    Headings within one turn count as degrees only if they fit the path as degrees and not as
    radians: headings that are all 0, or noise, are not rejected.

    Raises:
        InvalidWaypointsError: They are degrees.
    """
    yaws = waypoints[:, 2]
    beyond = np.abs(yaws) > _TURN_RAD
    ways = Ways(waypoints[:, :2])
    unit = _better_unit(ways, yaws, within_a_turn=not beyond.any())
    if unit is None:
        return
    row = int(beyond.argmax())
    cell, column = _columns(lines[row])[2], _starts(_columns(lines[row]))[2]
    why = "is more than a turn" if beyond.any() else "does not fit the direction of the path"
    message = f"yaw: {_shown(cell)} {why} in radians; these look like {_UNITS[unit]}"
    other = Heading.COMPASS if unit is Heading.DEG else Heading.DEG
    hint = f"set ?heading={unit} ({_UNITS[unit]}) or ?heading={other} ({_UNITS[other]})"
    raise InvalidWaypointsError([_finding("NOT_RADIANS", message, row + 1, column)], hint)


_UNITS = {
    Heading.DEG: "degrees counter-clockwise from east",
    Heading.COMPASS: "degrees clockwise from north",
}


def _better_unit(ways: Ways, yaws: NDArray[np.float64], *, within_a_turn: bool) -> Heading | None:
    """Return the unit of the headings; None: radians."""
    if not ways.count:
        return None if within_a_turn else Heading.DEG
    own = ways.misfit(yaws)
    misfits = {unit: ways.misfit(_yaws(yaws, unit)) for unit in _UNITS}
    best = min(misfits, key=lambda unit: misfits[unit])
    if not within_a_turn:
        return None if own < min(misfits[best], _MISFIT_RAD) else best
    silent = ways.misfit(_yaws(np.zeros_like(yaws), best))
    clear = misfits[best] * _GAIN < silent
    return best if clear and own > _MISFIT_RAD and ways.count >= _FEW_WAYS else None


def _yaws(degrees: NDArray[np.float64], unit: Heading) -> NDArray[np.float64]:
    """Return headings in rad, wrapped to [-pi, pi); shape (n,)."""
    radians = np.radians(degrees)
    return wrapped(pi / 2 - radians if unit is Heading.COMPASS else radians)


def _columns(line: str) -> list[str]:
    return line.rstrip("\r").split(",")


def _starts(cells: list[str]) -> list[int]:
    """Return the column of the line in which each cell begins, from 1."""
    starts, at = [], 1
    for cell in cells:
        starts.append(at + len(cell) - len(cell.lstrip()))
        at += len(cell) + 1
    return starts


def _is_text(cell: str) -> bool:
    try:
        _number(cell)
    except ValueError:
        return True
    return False


def _shown(text: str) -> str:
    text = text.strip()
    return repr(text if len(text) <= 40 else f"{text[:37]}...")


def _finding(code: str, message: str, line: int, column: int = 1) -> Finding:
    return Finding("error", code, message, line=line, column=column)
