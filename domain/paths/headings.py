"""How well the headings of waypoints fit the way that leads along them.

For whoever doubts in which unit, or from which direction, headings are counted.
"""

from math import hypot, pi

import numpy as np
from numpy.typing import NDArray

_CHORD_M = 0.5
"""Ways are looked at over so much, or a tenth of the path, since a receiver at rest jitters."""


class Ways:
    """Where the way between waypoints leads."""

    def __init__(self, places: NDArray[np.float64]) -> None:
        """Take the places.

        Args:
            places: Shape (n, 2), n >= 1: x m, y m; finite.
        """
        kept = _apart(places)
        steps = np.diff(places[kept], axis=0)
        self._middles = (kept[:-1] + kept[1:]) // 2
        self._angles = np.arctan2(steps[:, 1], steps[:, 0])

    @property
    def count(self) -> int:
        """Return how many ways are looked at; 0 if all places are the same."""
        return len(self._angles)

    def misfit(self, yaws: NDArray[np.float64]) -> float:
        """Return the median angle between heading and way, rad; 0 to pi / 2.

        Who drives backwards all the time fits as well as who drives forwards.

        Args:
            yaws: Of all waypoints, shape (n,), rad counter-clockwise from the x axis.
        """
        errors = np.abs(wrapped(yaws[self._middles] - self._angles))
        median = float(np.median(errors))
        return min(median, pi - median)


def wrapped(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return angles from -pi to below pi; shape as given, rad."""
    return np.asarray((angles + pi) % (2 * pi) - pi)


def _apart(places: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the indexes of waypoints a chord or more apart, the first among them; shape (k,)."""
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
