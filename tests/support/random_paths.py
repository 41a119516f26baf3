"""Paths as nobody would drive them: bends of any tightness, corners, crossings, the way back."""

from dataclasses import dataclass
from math import ceil, pi

import hypothesis.strategies as st
import numpy as np
from numpy.typing import NDArray

MAX_POINTS_PER_PIECE = 2_000
_TIGHTEST = 0.6
"""1/m; the vehicle itself turns at 0.4."""


@dataclass(frozen=True, slots=True)
class Piece:
    """One stretch: straight, an arc, or a spiral where the curvature changes."""

    corner_rad: float
    """Turned at once before it, left positive; pi: back where it came from."""
    length_m: float
    curvatures: tuple[float, float]
    """At its begin and its end, 1/m, left positive."""
    spacing_m: float
    """Between its waypoints, or more where there would be too many of them."""
    repeats: int
    """How often its last waypoint is recorded once more."""


@dataclass(frozen=True, slots=True)
class Walk:
    """Pieces in a row, from the origin along the x axis."""

    pieces: tuple[Piece, ...]
    returns: bool
    """Whether the whole way is driven back on the same points."""

    def waypoints(self, most_m: float) -> NDArray[np.float64]:
        """Return it as waypoints, shape (n, 3): x m, y m, yaw rad.

        Args:
            most_m: Its pieces are scaled down together to this length if they are longer, so that
                a bend may become tighter still.
        """
        length = sum(piece.length_m for piece in self.pieces) * (1 + self.returns)
        scale = min(1.0, most_m / length)
        rows = np.zeros((1, 3))
        for piece in self.pieces:
            rows = np.concatenate((rows, _stretch(piece, scale, rows[-1])))
        if self.returns:
            rows = np.concatenate((rows, rows[-2::-1] + np.array([0.0, 0.0, pi])))
        return rows


def walks() -> st.SearchStrategy[Walk]:
    """Generate walks; the simplest is one short straight."""
    bend = st.one_of(st.just(0.0), st.floats(-0.35, 0.35), st.floats(-_TIGHTEST, _TIGHTEST))
    curvatures = st.one_of(bend.map(lambda k: (k, k)), st.tuples(bend, bend))
    corner = st.one_of(
        st.just(0.0), st.just(0.0), st.floats(-0.3, 0.3), st.sampled_from([pi, pi / 2, -pi / 2])
    )
    pieces = st.builds(
        Piece,
        corner_rad=st.one_of(corner, st.floats(-pi, pi)),
        length_m=st.one_of(st.floats(3.0, 30.0), st.floats(0.001, 8.0)),
        curvatures=curvatures,
        spacing_m=st.sampled_from([1.0, 0.001, 0.01, 0.05, 0.2, 0.5, 2.0, 5.0, 20.0]),
        repeats=st.sampled_from([0, 0, 0, 1, 30]),
    )
    row = st.lists(pieces, min_size=1, max_size=6).map(tuple)
    return st.builds(Walk, row, st.sampled_from([False, False, False, True]))


def evenly(waypoints: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return places along the line through waypoints, both its ends among them.

    Args:
        waypoints: Shape (n, 3): x m, y m, yaw rad.
        count: How many places.

    Returns:
        Shape (count, 2), m.
    """
    steps = np.diff(waypoints[:, :2], axis=0)
    along = np.concatenate(([0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))))
    at = np.linspace(0.0, along[-1], count)
    return np.column_stack([np.interp(at, along, waypoints[:, k]) for k in (0, 1)])


def passed_share(
    places: NDArray[np.float64], driven: NDArray[np.float64], within_m: float
) -> float:
    """Return which share of places was passed by what was driven, in the order of the places.

    It is the most that any assignment of times to places, none before that of the place before,
    can explain.

    Args:
        places: Shape (n, 2), m.
        driven: Shape (m, 2), m, in order of time.
        within_m: So near is passed.
    """
    # most[t]: of the places so far, how many were passed up to t.
    most = np.zeros(len(driven))
    for place in places:
        near = np.hypot(driven[:, 0] - place[0], driven[:, 1] - place[1]) <= within_m
        most = np.maximum.accumulate(most + near)
    return float(most[-1]) / len(places)


def _stretch(piece: Piece, scale: float, begin: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the waypoints of a piece behind the one that it begins with; shape (n, 3)."""
    count = min(max(round(piece.length_m / piece.spacing_m), 1), MAX_POINTS_PER_PIECE)
    # Integrated in steps that are short also where waypoints are far apart.
    finer = max(1, ceil(piece.length_m / count / 0.1))
    steps = count * finer
    middle = (np.arange(steps) + 0.5) / steps
    first, last = piece.curvatures
    turned = (first * middle + (last - first) * middle**2 / 2) * piece.length_m
    yaw = begin[2] + piece.corner_rad + turned
    step = piece.length_m * scale / steps
    x = begin[0] + np.cumsum(step * np.cos(yaw))
    y = begin[1] + np.cumsum(step * np.sin(yaw))
    rows = np.column_stack((x, y, yaw))[finer - 1 :: finer]
    return np.concatenate((rows, np.repeat(rows[-1:], piece.repeats, axis=0)))
