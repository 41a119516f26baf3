"""How well the headings of waypoints fit the direction of the path.

Used to check the unit and the zero direction of headings.
"""

from math import hypot, pi

import numpy as np
from numpy.typing import NDArray

_CHORD_M = 0.5
"""Directions are taken over this chord, or a tenth of the path, since a receiver jitters."""


class Ways:
    """Directions of the path between waypoints."""

    def __init__(self, places: NDArray[np.float64]) -> None:
        """Find the directions.

        Args:
            places: Positions of the waypoints, shape (n, 2), n >= 1: x m, y m; finite.
        """
        kept = _apart(places)
        steps = np.diff(places[kept], axis=0)
        self._middles = (kept[:-1] + kept[1:]) // 2
        self._angles = np.arctan2(steps[:, 1], steps[:, 0])

    @property
    def count(self) -> int:
        """Return the number of directions; 0 if all positions are the same."""
        return len(self._angles)

    def misfit(self, yaws: NDArray[np.float64]) -> float:
        """Return the median angle between heading and path, rad; 0 to pi / 2.

        Headings against the path fit as well: the recording vehicle may have driven backwards.

        Args:
            yaws: Headings of all waypoints, shape (n,), rad counter-clockwise from the x axis.
        """
        errors = np.abs(wrapped(yaws[self._middles] - self._angles))
        median = float(np.median(errors))
        return min(median, pi - median)


def wrapped(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return angles wrapped to [-pi, pi), rad; same shape."""
    return np.asarray((angles + pi) % (2 * pi) - pi)


def _apart(places: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the indices of waypoints at least a chord apart, from the first one; shape (k,)."""
    extent = float(np.hypot(*(places - places[0]).T).max())
    chord = min(_CHORD_M, extent / 10)
    kept = [0]
    if chord > 0:
        xs, ys = places[:, 0].tolist(), places[:, 1].tolist()
        x, y = xs[0], ys[0]
        for index in range(1, len(xs)):
            if hypot(xs[index] - x, ys[index] - y) >= chord:
                kept.append(index)
                x, y = xs[index], ys[index]
    return np.array(kept, dtype=np.int64)
