"""Shortest curve between two poses for a vehicle that only drives forward.

Sources: L. E. Dubins, "On Curves of Minimal Length with a Constraint on Average Curvature, and with
Prescribed Initial and Terminal Positions and Tangents", American Journal of Mathematics 79, 1957;
the six formulas are those of A. M. Shkel, V. Lumelsky, "Classification of the Dubins Set",
Robotics and Autonomous Systems 34, 2001.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import acos, atan2, ceil, cos, hypot, pi, sin, sqrt

from domain.arrays import Floats, np
from domain.vehicle import Pose

_Word = tuple[tuple[int, int, int], tuple[float, float, float]]
"""Turns (1 left, 0 straight, -1 right) and their lengths, in radii."""


@dataclass(frozen=True, slots=True)
class DubinsCurve:
    """Three pieces, each an arc or a straight."""

    start: Pose
    radius_m: float
    turns: tuple[int, int, int]
    """1: left, 0: straight, -1: right."""
    lengths_m: tuple[float, float, float]

    @property
    def length_m(self) -> float:
        """Return the length of the curve, m."""
        return sum(self.lengths_m)

    @property
    def turned_rad(self) -> float:
        """Return by how much it turns, to either side together, rad."""
        pieces = zip(self.turns, self.lengths_m, strict=True)
        return sum(length for turn, length in pieces if turn) / self.radius_m

    def places(self, spacing_m: float) -> Floats:
        """Return positions along the curve, from its start to its end.

        Args:
            spacing_m: Largest distance between two of them, m.

        Returns:
            Shape (n, 3): x m, y m, yaw rad.
        """
        rows = [np.array([[self.start.x_m, self.start.y_m, self.start.yaw_rad]])]
        for turn, length in zip(self.turns, self.lengths_m, strict=True):
            if length > 0:
                rows.append(self._piece(rows[-1][-1], turn, length, spacing_m))
        return np.concatenate(rows)

    def _piece(self, begin: Floats, turn: int, length_m: float, spacing_m: float) -> Floats:
        count = ceil(length_m / spacing_m)
        along = np.linspace(0.0, length_m, count + 1)[1:]
        x, y, yaw = begin
        if turn == 0:
            straight = (x + along * cos(yaw), y + along * sin(yaw), np.full(count, yaw))
            return np.column_stack(straight)
        side = self.radius_m * turn
        yaws = yaw + along / side
        arc = (x + side * (np.sin(yaws) - sin(yaw)), y - side * (np.cos(yaws) - cos(yaw)), yaws)
        return np.column_stack(arc)


def shortest_curve(start: Pose, end: Pose, radius_m: float) -> DubinsCurve:
    """Return the shortest curve from one pose to another.

    Args:
        start: Where it begins.
        end: Where it ends, with the heading there.
        radius_m: Of its arcs, m; > 0.
    """
    dx, dy = end.x_m - start.x_m, end.y_m - start.y_m
    bearing = atan2(dy, dx)
    a, b = start.yaw_rad - bearing, end.yaw_rad - bearing
    turns, lengths = min(_words(hypot(dx, dy) / radius_m, a, b), key=lambda word: sum(word[1]))
    first, middle, last = (length * radius_m for length in lengths)
    return DubinsCurve(start, radius_m, turns, (first, middle, last))


def _words(d: float, a: float, b: float) -> Iterator[_Word]:
    """Yield the curves that exist.

    Args:
        d: Distance of the two poses, in radii.
        a: Heading of the first one relative to the line that joins them, rad.
        b: Heading of the last one, likewise.
    """
    for side in (1, -1):  # A curve that begins to the right is the mirror image of one to the left.
        for turns, lengths in _words_to_the_left(d, side * a, side * b):
            first, middle, last = turns
            yield (side * first, side * middle, side * last), lengths


def _words_to_the_left(d: float, a: float, b: float) -> Iterator[_Word]:
    """Yield the curves that begin to the left; arguments as for `_words`."""
    sa, sb, ca, cb, cab = sin(a), sin(b), cos(a), cos(b), cos(a - b)
    way = atan2(cb - ca, d + sa - sb)
    square = max(2 + d * d - 2 * cab + 2 * d * (sa - sb), 0.0)
    yield (1, 0, 1), (_around(way - a), sqrt(square), _around(b - way))
    square = d * d - 2 + 2 * cab + 2 * d * (sa + sb)
    if square >= 0:
        p = sqrt(square)
        way = atan2(-ca - cb, d + sa + sb) - atan2(-2.0, p)
        yield (1, 0, -1), (_around(way - a), p, _around(way - b))
    third = (6 - d * d + 2 * cab + 2 * d * (sb - sa)) / 8
    if abs(third) <= 1:
        p = 2 * pi - acos(third)
        t = _around(-a - atan2(ca - cb, d + sa - sb) + p / 2)
        yield (1, -1, 1), (t, p, _around(b - a - t + p))


def _around(angle: float) -> float:
    """Return an angle as a turn of 0 to 2 pi, rad; one of almost a full turn counts as none."""
    turned = angle % (2 * pi)
    return 0.0 if 2 * pi - turned < 1e-9 else turned
