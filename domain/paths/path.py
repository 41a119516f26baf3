"""Waypoints as a line on the ground: length, headings, curvature, and projection of a vehicle.

The geometry follows from the positions of the waypoints alone; their yaw is kept but not used,
since a recorded one may be noisy or a compass heading. Positions closer together than `SPACING_M`
are merged: recording at standstill, or with a jittering receiver, would otherwise add length and
random headings.
"""

from array import array
from bisect import bisect_right
from dataclasses import dataclass
from math import atan2, copysign, hypot, inf, pi, sqrt
from typing import TypeAlias

from domain.arrays import Floats, Integers, np
from domain.errors import InvalidValueError
from domain.paths.waypoints import check_waypoints
from domain.vehicle import Point, VehicleLimits

SPACING_M = 0.1
"""Minimum distance between two positions of a path longer than 10 m; else a hundredth of it."""
_SPACING_SLACK = 1 - 1e-5
"""Positions exactly `SPACING_M` apart are kept also far from the origin, where the last digits of
coordinates are missing: in UTM, a northing of 5e6 m has steps of 1e-9 m."""
WINDOW_M = 6.0
"""How far ahead of the first waypoint not yet passed the projection searches."""
SKIP_PRICE = 0.1
"""How much nearer the path must be after a stretch to skip it, per metre of that stretch.

A vehicle on its path then follows every bend, however close the path comes to itself, and a vehicle
that cut a corner is projected onto the path behind it.
"""
SMOOTHING_M = 1.0
"""Headings point from the mean position of this length behind to that of this length ahead."""
CURVATURE_OVER_M = 1.5
"""Curvatures are the change of heading over this length of path."""

_END_M = 0.5
"""Beyond its end the path continues straight, in the direction of this last stretch."""
_LEAST_EXTENT_M = 1e-6


@dataclass(frozen=True, slots=True)
class Projection:
    """Projection of a vehicle onto a path."""

    distance_m: float
    """Distance from waypoint 0; exactly the length of the path once its end is passed."""
    cross_track_error_m: float
    """Distance from the path or, before its start and beyond its end, from the straight line that
    extends it; positive: the vehicle is left of it."""
    heading_rad: float
    """Heading of the path there."""


_State: TypeAlias = tuple[Floats, Floats, Floats, Floats, tuple[float, float], float]


class Path:
    """The immutable line through waypoints. Distances count from waypoint 0, in metres.

    Positions are kept relative to waypoint 0, so that coordinates of UTM cost no accuracy.
    """

    def __init__(self, waypoints: Floats) -> None:
        """Prepare the geometry; 100,000 waypoints take some 40 ms.

        Args:
            waypoints: Shape (n, 3): x m, y m, yaw rad.

        Raises:
            InvalidValueError: The shape is wrong, there are too few or too many waypoints, one of
                them is not finite or out of range (`check_waypoints`), or all are at one position.
        """
        self._prepare(_checked(waypoints))

    @classmethod
    def of_computed(cls, waypoints: Floats) -> "Path":
        """Return the line through computed waypoints.

        Those of a way onto a path may be beyond the range that given ones have.

        Args:
            waypoints: Shape (n, 3): x m, y m, yaw rad; finite, and not all at one position.
        """
        path = cls.__new__(cls)
        cls._prepare(path, waypoints)
        return path

    def _prepare(self, waypoints: Floats) -> None:
        self.waypoints = waypoints
        """Shape (n, 3): x m, y m, yaw rad; read only."""
        waypoints.flags.writeable = False
        places = self.waypoints[:, :2]
        kept = _places_apart(places)
        knots = places[kept]
        steps = np.diff(knots, axis=0)
        lengths = _lengths(steps)
        self._along = np.concatenate(([0.0], np.cumsum(lengths)))
        ways = np.concatenate((steps / lengths[:, np.newaxis], [[0.0, 0.0]]))
        ways[-1] = _way_of_the_end(knots, self._along, ways)
        # Integral of the position over the distance: gives mean positions without a loop.
        middles = (knots[:-1] + knots[1:]) / 2 - knots[0]
        sums = np.concatenate(([[0.0, 0.0]], np.cumsum(middles * lengths[:, np.newaxis], axis=0)))
        self._knots = np.hstack((knots - knots[0], ways, sums))
        recorded = np.concatenate(([0.0], np.cumsum(_lengths(np.diff(places, axis=0)))))
        self._distances = np.interp(recorded, recorded[kept], self._along)
        self._origin = (float(knots[0, 0]), float(knots[0, 1]))
        self._scale = 1.0
        self._take_numbers()

    def for_vehicle(self, limits: VehicleLimits) -> "Path":
        """Return this path as a vehicle sees it.

        A vehicle with a wheelbase of less than `REFERENCE_WHEELBASE_M` drives tighter bends, and
        so headings and curvatures are smoothed, and the projection searches, over less.
        """
        scale = min(limits.scale, 1.0)
        if scale == self._scale:
            return self
        seen = Path.__new__(Path)
        seen.__dict__.update(self.__dict__ | {"_scale": scale})
        return seen

    def _take_numbers(self) -> None:
        """Copy the arrays into a form from which single numbers are read fastest."""
        self._s = _numbers(self._along)
        self._x, self._y, self._ux, self._uy, self._sum_x, self._sum_y = map(
            _numbers, self._knots.T
        )

    def __getstate__(self) -> _State:
        # Computed arrays are pickled as well: the receiving process has no time to compute them.
        return (
            self.waypoints,
            self._along,
            self._knots,
            self._distances,
            self._origin,
            self._scale,
        )

    def __setstate__(self, state: _State) -> None:
        (
            self.waypoints,
            self._along,
            self._knots,
            self._distances,
            self._origin,
            self._scale,
        ) = state
        self.waypoints.flags.writeable = False
        self._take_numbers()

    @property
    def count(self) -> int:
        """Return the number of waypoints."""
        return len(self.waypoints)

    @property
    def length_m(self) -> float:
        """Return the length; > 0."""
        return self._s[-1]

    def waypoint(self, index: int) -> Point:
        """Return the position of a waypoint."""
        x_m, y_m, _ = self.waypoints[index].tolist()
        return Point(x_m, y_m)

    def distance_of(self, index: int) -> float:
        """Return the distance of a waypoint along the path, m."""
        return float(self._distances[index])

    def index_after(self, distance_m: float) -> int:
        """Return the index of the first waypoint not passed at `distance_m`, or of the last one."""
        index = int(self._distances.searchsorted(distance_m, side="right"))
        return min(index, self.count - 1)

    def point_at(self, distance_m: float) -> Point:
        """Return the position at `distance_m`; the path is extended straight at both ends."""
        k = self._segment(distance_m)
        ahead = distance_m - self._s[k]
        x_m, y_m = self._origin
        return Point(x_m + self._x[k] + self._ux[k] * ahead, y_m + self._y[k] + self._uy[k] * ahead)

    def heading_at(self, distance_m: float) -> float:
        """Return the heading at `distance_m`, rad, smoothed over `SMOOTHING_M`."""
        over_m = SMOOTHING_M * self._scale
        x0, y0 = self._sums(distance_m - over_m)
        x1, y1 = self._sums(distance_m)
        x2, y2 = self._sums(distance_m + over_m)
        dx, dy = x2 - 2 * x1 + x0, y2 - 2 * y1 + y0
        if hypot(dx, dy) > _LEAST_EXTENT_M:
            return atan2(dy, dx)
        # Where a path turns back on itself, the mean direction is undefined.
        k = self._segment(distance_m)
        return atan2(self._uy[k], self._ux[k])

    def curvature_at(self, distance_m: float) -> float:
        """Return the curvature at `distance_m`, 1/m, left positive.

        It is the change of `heading_at` over `CURVATURE_OVER_M`; for a recording with centimetres
        of noise it is accurate to some 0.01 1/m.
        """
        half = CURVATURE_OVER_M * self._scale / 2
        turn = self.heading_at(distance_m + half) - self.heading_at(distance_m - half)
        return ((turn + pi) % (2 * pi) - pi) / (2 * half)

    def curvatures_at(self, distances_m: Floats) -> Floats:
        """Return `curvature_at` for many distances at once; shape (n,) each, 1/m."""
        half = CURVATURE_OVER_M * self._scale / 2
        turn = self._headings(distances_m + half) - self._headings(distances_m - half)
        return np.asarray((turn + pi) % (2 * pi) - pi) / (2 * half)

    def project(self, x_m: float, y_m: float, start_index: int) -> Projection:
        """Project a vehicle onto the path, as the nearest point ahead.

        The search begins at the last passed waypoint and goes forward; a stretch that leads away
        from the vehicle is skipped only at `SKIP_PRICE`, and never more than `WINDOW_M` of it.

        Args:
            x_m: Position of the vehicle; finite.
            y_m: Position of the vehicle; finite.
            start_index: First waypoint not yet passed.
        """
        start_index = min(max(start_index, 1), self.count - 1)
        passed = float(self._distances[start_index - 1])
        until = float(self._distances[start_index]) + WINDOW_M * self._scale
        distance, error = self._nearest(x_m - self._origin[0], y_m - self._origin[1], passed, until)
        return Projection(distance, error, self.heading_at(distance))

    def _nearest(self, x: float, y: float, passed: float, until: float) -> tuple[float, float]:
        """Return distance and cross-track error of the nearest point not before `passed`, m."""
        s, xs, ys, uxs, uys = self._s, self._x, self._y, self._ux, self._uy
        last, window = len(s) - 2, WINDOW_M * self._scale
        first = min(self._segment(passed), last)
        best, best_at, error = inf, passed, 0.0
        for k in range(first, last + 1):
            begin = s[k]
            gap = begin - best_at
            # Nothing behind such a gap can be nearer; for a vehicle on the path this ends soon.
            if begin > until or gap > window or gap * SKIP_PRICE >= best:
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
                # Outside of a corner, the error is the distance from the corner.
                at_corner = k < last if beyond > 0 else k > first and beyond < 0
                error = copysign(far, side) if at_corner else side
        return best_at, error

    def _segment(self, distance_m: float) -> int:
        """Return the index of the last position not after `distance_m`."""
        return max(bisect_right(self._s, distance_m) - 1, 0)

    def _sums(self, distance_m: float) -> tuple[float, float]:
        """Return the integral of the position from 0 to `distance_m`, m2."""
        k = self._segment(distance_m)
        ahead = distance_m - self._s[k]
        half = ahead * ahead / 2
        return (
            self._sum_x[k] + self._x[k] * ahead + self._ux[k] * half,
            self._sum_y[k] + self._y[k] * ahead + self._uy[k] * half,
        )

    def _headings(self, distances_m: Floats) -> Floats:
        """Return `heading_at` for many distances; shape (n,) each, rad."""
        at = distances_m[:, np.newaxis] + np.array([-1.0, 0.0, 1.0]) * (SMOOTHING_M * self._scale)
        k = np.maximum(self._along.searchsorted(at, side="right") - 1, 0)
        ahead = (at - self._along[k])[..., np.newaxis]
        near = self._knots[k]
        sums = near[..., 4:6] + near[..., 0:2] * ahead + near[..., 2:4] * ahead**2 / 2
        way = sums[:, 2] - 2 * sums[:, 1] + sums[:, 0]
        nowhere = _lengths(way) <= _LEAST_EXTENT_M
        way[nowhere] = near[nowhere, 1, 2:4]
        return np.asarray(np.arctan2(way[:, 1], way[:, 0]))


def _checked(waypoints: Floats) -> Floats:
    """Return a checked copy; shape (n, 3).

    Raises:
        InvalidValueError: See `Path`.
    """
    rows = np.array(waypoints, dtype=np.float64, order="C")
    if rows.ndim != 2 or rows.shape[1] != 3:
        message = f"waypoints must be rows of x, y, yaw, not an array of shape {rows.shape}"
        raise InvalidValueError(message, "waypoints")
    check_waypoints(rows)
    return rows


def _numbers(column: Floats) -> "array[float]":
    """Return an array whose single numbers are read several times faster than from numpy."""
    return array("d", column.tobytes())


def _lengths(vectors: Floats) -> Floats:
    """Return the lengths of vectors; shape (n,) of shape (n, 2). Faster than `numpy.hypot`."""
    return np.asarray(np.sqrt(vectors[:, 0] ** 2 + vectors[:, 1] ** 2))


def _places_apart(places: Floats) -> Integers:
    """Return which waypoints are kept as positions; the first and the last always are.

    Args:
        places: Shape (n, 2): x m, y m.

    Returns:
        Their indices, ascending; shape (k,), k >= 2.

    Raises:
        InvalidValueError: All waypoints are at the same position.
    """
    extent = float(_lengths(places - places[0]).max())
    if extent < _LEAST_EXTENT_M:
        raise InvalidValueError("all waypoints are at the same position", "waypoints")
    spacing = min(SPACING_M, extent / 100) * _SPACING_SLACK
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
    # The path ends at its last waypoint; positions too close to it are dropped.
    last = len(xs) - 1
    while len(kept) > 1 and hypot(xs[last] - xs[kept[-1]], ys[last] - ys[kept[-1]]) < spacing:
        kept.pop()
    return np.array([*kept, last])


def _way_of_the_end(knots: Floats, along: Floats, ways: Floats) -> Floats:
    """Return the unit vector in which a path continues beyond its end; shape (2,).

    Args:
        knots: Positions, shape (k, 2): x m, y m.
        along: Their distances, shape (k,), m.
        ways: Unit vectors from each position to the next, shape (k, 2); the last is not used.
    """
    before = max(float(along[-1]) - _END_M, 0.0)
    k = int(along.searchsorted(before, side="right")) - 1
    way = knots[-1] - (knots[k] + ways[k] * (before - along[k]))
    length = float(np.hypot(way[0], way[1]))
    return np.asarray(way / length if length > _LEAST_EXTENT_M else ways[-2])
