"""Waypoints as they are given: what can be one, and how many there may be."""

import numpy as np
from numpy.typing import NDArray

from domain.errors import InvalidValueError

MAX_WAYPOINTS = 100_000
MAX_COORDINATE_M = 1e6
COLUMNS = ("x_m", "y_m", "yaw_rad")


def checked_waypoints(waypoints: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return waypoints that can be a path.

    Args:
        waypoints: Shape (n, 3): x and y in m, yaw in rad.

    Raises:
        InvalidValueError: There are fewer than 2 or more than `MAX_WAYPOINTS`, or a number is not
            finite or too large; `pointer` leads to it.
    """
    count = len(waypoints)
    if not 2 <= count <= MAX_WAYPOINTS:
        message = f"a path has 2 to {MAX_WAYPOINTS} waypoints, not {count}"
        raise InvalidValueError(message, "/waypoints")
    limits = np.array([MAX_COORDINATE_M, MAX_COORDINATE_M, np.inf])
    wrong = ~(np.isfinite(waypoints) & (np.abs(waypoints) <= limits))
    if wrong.any():
        row, column = (int(index) for index in np.argwhere(wrong)[0])
        value = float(waypoints[row, column])
        message = f"{value:g} is no {COLUMNS[column]} of a waypoint"
        raise InvalidValueError(message, f"/waypoints/{row}/{COLUMNS[column]}")
    return waypoints
