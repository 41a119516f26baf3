"""Waypoints as a line on the ground: how long it is, where it leads, and where a vehicle is on it.

Geometry follows from the places of the waypoints alone; their yaw is kept and not looked at, since
a recorded one is noisy, or a compass's. Places closer together than `SPACING_M` are one place: who
records while standing still, or with a receiver that jitters, would otherwise add length where
there is none, and headings that point anywhere.
"""

from array import array
from bisect import bisect_right
from dataclasses import dataclass
from math import atan2, copysign, hypot, inf, pi, sqrt
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from domain.errors import InvalidValueError
from domain.paths.waypoints import check_waypoints
from domain.vehicle import Point

SPACING_M = 0.1
"""Least distance between two places of a path that is longer than 10 m; else a hundredth of it."""
WINDOW_M = 6.0
"""How far ahead of the first waypoint not yet passed a vehicle is looked for."""
SKIP_PRICE = 0.1
"""How much nearer the path has to be behind a stretch that leads away, per metre of the stretch.

So a vehicle that is on its path passes every bend, however near the path comes back to itself, and
one that cut a corner is found again behind it.
"""
SMOOTHING_M = 1.0
"""Headings are those from the middle of so much path behind to the middle of so much ahead."""
CURVATURE_OVER_M = 1.5
"""Curvatures are the change of heading over so much path."""

_END_M = 0.5
"""The path goes on beyond its end as straight as over the last half metre."""
_LEAST_EXTENT_M = 1e-6


@dataclass(frozen=True, slots=True)
class Projection:
    """Where a vehicle is along a path."""

    distance_m: float
    """From waypoint 0; exactly the length of the path once its end is passed."""
    cross_track_error_m: float
    """Distance from the path, or, before its start and beyond its end, from the straight that
    continues it; positive: the vehicle is left of it."""
    heading_rad: float
    """Where the path leads there."""


_Array: TypeAlias = NDArray[np.float64]
_State: TypeAlias = tuple[_Array, _Array, _Array, _Array, tuple[float, float]]


class Path:
    """The line through waypoints; it never changes. Distances count from waypoint 0, in metres."""

    def __init__(self, waypoints: NDArray[np.float64]) -> None:
        """Take the waypoints; 100,000 of them need some 40 ms.

        Args:
            waypoints: Shape (n, 3): x m, y m, yaw rad.

        Raises:
            InvalidValueError: The shape is another, there are too few or too many waypoints, one of
                them is not finite or too far out (`check_waypoints`), or all are at one place.
        """
        self.waypoints = _checked(waypoints)
        """Shape (n, 3): x m, y m, yaw rad; read only."""
        places = self.waypoints[:, :2]
        kept = _places_apart(places)
        knots = places[kept]
        steps = np.diff(knots, axis=0)
        lengths = _lengths(steps)
        self._along = np.concatenate(([0.0], np.cumsum(lengths)))
        ways = np.concatenate((steps / lengths[:, np.newaxis], [[0.0, 0.0]]))
        ways[-1] = _way_of_the_end(knots, self._along, ways)
        # Integral of the place over the distance: means of places without a loop.
        middles = (knots[:-1] + knots[1:]) / 2 - knots[0]
        sums = np.concatenate(([[0.0, 0.0]], np.cumsum(middles * lengths[:, np.newaxis], axis=0)))
        self._knots = np.hstack((knots - knots[0], ways, sums))
        recorded = np.concatenate(([0.0], np.cumsum(_lengths(np.diff(places, axis=0)))))
        self._distances = np.interp(recorded, recorded[kept], self._along)
        self._origin = (float(knots[0, 0]), float(knots[0, 1]))
        self._take_numbers()

    def _take_numbers(self) -> None:
        """Hold what single numbers are read from, in the form in which that is quickest."""
        self._s = _numbers(self._along)
        self._x, self._y, self._ux, self._uy, self._sum_x, self._sum_y = map(
            _numbers, self._knots.T
        )

    def __getstate__(self) -> _State:
        # What took time to find is sent to another process, too: who receives it has none to spare.
        return self.waypoints, self._along, self._knots, self._distances, self._origin

    def __setstate__(self, state: _State) -> None:
        self.waypoints, self._along, self._knots, self._distances, self._origin = state
        self.waypoints.flags.writeable = False
        self._take_numbers()

    @property
    def count(self) -> int:
        """Return how many waypoints there are."""
        return len(self.waypoints)

    @property
    def length_m(self) -> float:
        """Return the length; > 0."""
        return self._s[-1]

    def waypoint(self, index: int) -> Point:
        """Return where a waypoint is."""
        x_m, y_m, _ = self.waypoints[index].tolist()
        return Point(x_m, y_m)

    def distance_of(self, index: int) -> float:
        """Return how far along the path a waypoint is, m."""
        return float(self._distances[index])

    def index_after(self, distance_m: float) -> int:
        """Return the first waypoint that is not passed at `distance_m`; at the end the last."""
        index = int(self._distances.searchsorted(distance_m, side="right"))
        return min(index, self.count - 1)

    def point_at(self, distance_m: float) -> Point:
        """Return the place at `distance_m`; the path goes straight on at both its ends."""
        k = self._segment(distance_m)
        ahead = distance_m - self._s[k]
        x_m, y_m = self._origin
        return Point(x_m + self._x[k] + self._ux[k] * ahead, y_m + self._y[k] + self._uy[k] * ahead)

    def heading_at(self, distance_m: float) -> float:
        """Return where the path leads at `distance_m`, rad, smoothed by `SMOOTHING_M`."""
        x0, y0 = self._sums(distance_m - SMOOTHING_M)
        x1, y1 = self._sums(distance_m)
        x2, y2 = self._sums(distance_m + SMOOTHING_M)
        dx, dy = x2 - 2 * x1 + x0, y2 - 2 * y1 + y0
        if hypot(dx, dy) > _LEAST_EXTENT_M:
            return atan2(dy, dx)
        # Where a path turns back on itself, it leads nowhere in the mean.
        k = self._segment(distance_m)
        return atan2(self._uy[k], self._ux[k])

    def curvature_at(self, distance_m: float) -> float:
        """Return the curvature at `distance_m`, 1/m, left positive.

        It is the change of `heading_at` over `CURVATURE_OVER_M`, so that of a recording with
        centimetres of noise is good to some 0.01 1/m.
        """
        half = CURVATURE_OVER_M / 2
        turn = self.heading_at(distance_m + half) - self.heading_at(distance_m - half)
        return ((turn + pi) % (2 * pi) - pi) / CURVATURE_OVER_M

    def curvatures_at(self, distances_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what `curvature_at` does for many distances at once; shape (n,) each, 1/m."""
        half = CURVATURE_OVER_M / 2
        turn = self._headings(distances_m + half) - self._headings(distances_m - half)
        return np.asarray((turn + pi) % (2 * pi) - pi) / CURVATURE_OVER_M

    def project(self, x_m: float, y_m: float, start_index: int) -> Projection:
        """Find a place that a vehicle is at on the path, as the nearest point ahead.

        The search begins at the last waypoint that was passed and goes forward; a stretch that
        leads away from the vehicle is skipped only at `SKIP_PRICE`, and never more than
        `WINDOW_M` of it.

        Args:
            x_m: Of the vehicle; finite.
            y_m: Of the vehicle; finite.
            start_index: First waypoint not yet passed.
        """
        start_index = min(max(start_index, 1), self.count - 1)
        passed = float(self._distances[start_index - 1])
        until = float(self._distances[start_index]) + WINDOW_M
        distance, error = self._nearest(x_m - self._origin[0], y_m - self._origin[1], passed, until)
        return Projection(distance, error, self.heading_at(distance))

    def _nearest(self, x: float, y: float, passed: float, until: float) -> tuple[float, float]:
        """Return distance and cross-track error of the nearest point not before `passed`, m."""
        s, xs, ys, uxs, uys = self._s, self._x, self._y, self._ux, self._uy
        last = len(s) - 2
        first = min(self._segment(passed), last)
        best, best_at, error = inf, passed, 0.0
        for k in range(first, last + 1):
            begin = s[k]
            gap = begin - best_at
            # Nothing behind a gap at that price can be nearer: on the path that ends it soon.
            if begin > until or gap > WINDOW_M or gap * SKIP_PRICE >= best:
                break
            rx, ry, ux, uy = x - xs[k], y - ys[k], uxs[k], uys[k]
            end = s[k + 1]
            at = begin + rx * ux + ry * uy
            foot = min(max(at, begin if k > first else passed), end)
            beyond = at - foot
            side = ux * ry - uy * rx
            far = sqrt(side * side + beyond * beyond)
            if far + SKIP_PRICE * max(gap, 0.0) < best:
                best, best_at = far, foot
                # Outside of a corner it is the distance from the corner.
                at_corner = k < last if beyond > 0 else k > first and beyond < 0
                error = copysign(far, side) if at_corner else side
        return best_at, error

    def _segment(self, distance_m: float) -> int:
        """Return the number of the last place not after `distance_m`."""
        return max(bisect_right(self._s, distance_m) - 1, 0)

    def _sums(self, distance_m: float) -> tuple[float, float]:
        """Return the integral of the place from 0 to `distance_m`, m2."""
        k = self._segment(distance_m)
        ahead = distance_m - self._s[k]
        half = ahead * ahead / 2
        return (
            self._sum_x[k] + self._x[k] * ahead + self._ux[k] * half,
            self._sum_y[k] + self._y[k] * ahead + self._uy[k] * half,
        )

    def _headings(self, distances_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what `heading_at` does for many distances; shape (n,) each, rad."""
        at = distances_m[:, np.newaxis] + np.array([-SMOOTHING_M, 0.0, SMOOTHING_M])
        k = np.maximum(self._along.searchsorted(at, side="right") - 1, 0)
        ahead = (at - self._along[k])[..., np.newaxis]
        near = self._knots[k]
        sums = near[..., 4:6] + near[..., 0:2] * ahead + near[..., 2:4] * ahead**2 / 2
        way = sums[:, 2] - 2 * sums[:, 1] + sums[:, 0]
        nowhere = _lengths(way) <= _LEAST_EXTENT_M
        way[nowhere] = near[nowhere, 1, 2:4]
        return np.asarray(np.arctan2(way[:, 1], way[:, 0]))


def _checked(waypoints: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a copy of its own that nobody can write to; shape (n, 3).

    Raises:
        InvalidValueError: See `Path`.
    """
    rows = np.array(waypoints, dtype=np.float64, order="C")
    if rows.ndim != 2 or rows.shape[1] != 3:
        message = f"waypoints are rows of x, y, yaw; these have the shape {rows.shape}"
        raise InvalidValueError(message, "waypoints")
    check_waypoints(rows)
    rows.flags.writeable = False
    return rows


def _numbers(column: NDArray[np.float64]) -> "array[float]":
    """Return numbers that are read one by one: several times faster than from a numpy array."""
    return array("d", column.tobytes())


def _lengths(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the lengths of vectors; shape (n,) of shape (n, 2). Faster than `numpy.hypot`."""
    return np.asarray(np.sqrt(vectors[:, 0] ** 2 + vectors[:, 1] ** 2))


def _places_apart(places: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return which waypoints are a place of their own, the first and the last among them.

    Args:
        places: Shape (n, 2): x m, y m.

    Returns:
        Their indexes, rising; shape (k,), k >= 2.

    Raises:
        InvalidValueError: All waypoints are at the same place.
    """
    extent = float(_lengths(places - places[0]).max())
    if extent < _LEAST_EXTENT_M:
        raise InvalidValueError("all waypoints are at the same place", "waypoints")
    spacing = min(SPACING_M, extent / 100)
    if bool((_lengths(np.diff(places, axis=0)) >= spacing).all()):
        return np.arange(len(places))
    limit = spacing * spacing
    xs, ys = places[:, 0].tolist(), places[:, 1].tolist()
    kept = [0]
    x, y = xs[0], ys[0]
    for index in range(1, len(xs)):
        dx, dy = xs[index] - x, ys[index] - y
        if dx * dx + dy * dy >= limit:
            kept.append(index)
            x, y = xs[index], ys[index]
    # The path ends at its last waypoint; places that this one is too near to make way for it.
    last = len(xs) - 1
    while len(kept) > 1 and hypot(xs[last] - xs[kept[-1]], ys[last] - ys[kept[-1]]) < spacing:
        kept.pop()
    return np.array([*kept, last])


def _way_of_the_end(
    knots: NDArray[np.float64], along: NDArray[np.float64], ways: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the unit vector in which a path goes on beyond its end; shape (2,).

    Args:
        knots: Places, shape (k, 2): x m, y m.
        along: Their distances, shape (k,), m.
        ways: Unit vectors from each place to the next, shape (k, 2); the last is not looked at.
    """
    before = max(float(along[-1]) - _END_M, 0.0)
    k = int(along.searchsorted(before, side="right")) - 1
    way = knots[-1] - (knots[k] + ways[k] * (before - along[k]))
    length = float(np.hypot(way[0], way[1]))
    return np.asarray(way / length if length > _LEAST_EXTENT_M else ways[-2])
