"""Which part of a path a vehicle came near: the rest was left out."""

from math import hypot

import numpy as np

from domain.paths.path import Path
from domain.vehicle import Pose

STEP_M = 0.25
"""The path is judged in pieces of this length."""
MAX_TRAIL = 4_000
"""Bound on remembered positions; a longer trail is thinned."""


class Coverage:
    """Sorts the path behind a vehicle into what it passed and what it left out.

    A vehicle that cannot steer a hairpin is projected onto the path behind it: it left the hairpin
    out. One that turns beside the path before it gets onto it does not: its trail counts.
    """

    def __init__(self, path: Path, reached_m: float, left_out_m: float, near_m: float) -> None:
        """Go on from what is known.

        Args:
            path: The path.
            reached_m: Distance along the path up to which it is judged, m.
            left_out_m: Length that was left out up to there, m.
            near_m: What the vehicle came no nearer than this is left out, m.
        """
        self.path = path
        self.reached_m = reached_m
        self.left_out_m = left_out_m
        self._near_m = near_m
        self._step_m = min(STEP_M, near_m / 4)
        self._trail: list[tuple[float, float]] = []
        """Where the vehicle was since the path was judged last."""

    def note(self, pose: Pose, distance_m: float | None) -> None:
        """Judge the path up to where the vehicle is.

        Args:
            pose: Of the vehicle.
            distance_m: Its distance along the path, m; None: it is not driving along it.
        """
        here = (pose.x_m, pose.y_m)
        moved = not self._trail or _apart(self._trail[-1], here) >= self._step_m
        is_ahead = distance_m is not None and distance_m > self.reached_m
        if moved or is_ahead:
            self._trail.append(here)
        if distance_m is not None and is_ahead:
            self._judge(distance_m)
            self._trail.clear()
        elif len(self._trail) > MAX_TRAIL:
            del self._trail[::2]

    def _judge(self, distance_m: float) -> None:
        trail = np.array(self._trail) if len(self._trail) > 1 else None
        x_m, y_m = self._trail[-1]
        while self.reached_m < distance_m:
            until_m = min(self.reached_m + self._step_m, distance_m)
            middle = self.path.point_at((self.reached_m + until_m) / 2)
            away_m = hypot(middle.x_m - x_m, middle.y_m - y_m)
            if away_m > self._near_m and trail is not None:
                away_m = float(np.hypot(*(trail - (middle.x_m, middle.y_m)).T).min())
            if away_m > self._near_m:
                self.left_out_m += until_m - self.reached_m
            self.reached_m = until_m


def _apart(one: tuple[float, float], other: tuple[float, float]) -> float:
    return hypot(one[0] - other[0], one[1] - other[1])
