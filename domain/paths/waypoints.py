"""Limits on the waypoints of a path: number and range."""

from domain.arrays import Floats, np
from domain.errors import InvalidValueError

MAX_WAYPOINTS = 100_000
MAX_COORDINATE_M = 1e7
"""UTM northings reach 1e7 m."""
COLUMNS = ("x_m", "y_m", "yaw_rad")


def check_waypoints(waypoints: Floats) -> None:
    """Reject waypoints that cannot be a path.

    Args:
        waypoints: Shape (n, 3): x and y in m, yaw in rad.

    Raises:
        InvalidValueError: There are fewer than 2 or more than `MAX_WAYPOINTS`, or a number is not
            finite or out of range; `pointer` leads to it.
    """
    count = len(waypoints)
    if not 2 <= count <= MAX_WAYPOINTS:
        message = f"a path has 2 to {MAX_WAYPOINTS} waypoints, not {count}"
        raise InvalidValueError(message, "/waypoints")
    limits = np.array([MAX_COORDINATE_M, MAX_COORDINATE_M, np.inf])
    wrong = ~(np.isfinite(waypoints) & (np.abs(waypoints) <= limits))
    if wrong.any():
        row, column = (int(index) for index in np.argwhere(wrong)[0])
        value, name = float(waypoints[row, column]), COLUMNS[column]
        within = f" and within +-{MAX_COORDINATE_M:,.0f} m" if name != "yaw_rad" else ""
        message = f"{name} must be finite{within}, not {value:g}"
        raise InvalidValueError(message, f"/waypoints/{row}/{name}")
