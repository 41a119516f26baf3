"""How fast a vehicle may be where along a path: no faster than its bends and its end allow.

Only braking is planned ahead. How fast the command rises is a matter of the moment, since a vehicle
also starts in the middle of a path, after a pause; whoever commands keeps to `acceleration_mps2`.
"""

from dataclasses import dataclass
from math import ceil, sqrt, tan

import numpy as np

from domain.paths.path import Path
from domain.vehicle import VehicleLimits

STEP_M = 0.5
"""Distance between two places where the curvature is looked at; it is smoothed over more."""
MAX_STEPS = 200_000
"""On paths longer than 100 km such places are further apart."""
CRAWL_MPS = 0.05
"""Slowest command before the end, or it would never be reached; to stop from it is no jerk."""
BRAKING_SHARE = 0.8
"""Planned of the braking that is allowed: a vehicle that is told late has to brake harder then."""
REACTION_S = 0.15
"""Between what is commanded and what the wheels do; without it the end would be run over."""


@dataclass(frozen=True, slots=True)
class SpeedLimits:
    """How hard a vehicle may be accelerated."""

    lateral_acceleration_mps2: float = 2.0
    acceleration_mps2: float = 1.0
    braking_mps2: float = 1.0


class SpeedProfile:
    """The greatest speed by distance along one path."""

    def __init__(
        self, path: Path, cruise_mps: float, limits: SpeedLimits, vehicle: VehicleLimits
    ) -> None:
        """Plan the speed.

        Args:
            path: What is driven.
            cruise_mps: Speed where nothing else limits it.
            limits: All > 0.
            vehicle: Its greatest speed, and its tightest bend: a path that bends more, as at the
                corner of a polygon, is driven as fast as that one.
        """
        self._length_m = path.length_m
        braking = BRAKING_SHARE * limits.braking_mps2
        self._braking_mps2 = braking
        self._top_mps = min(cruise_mps, vehicle.max_speed_mps)
        self._steps = min(ceil(path.length_m / STEP_M), MAX_STEPS)
        at = np.linspace(0.0, path.length_m, self._steps + 1)
        tightest = tan(vehicle.max_steering_angle_rad) / vehicle.wheelbase_m
        bends = np.minimum(np.abs(path.curvatures_at(at)), tightest)
        # A bend so wide is driven at the greatest speed, and nothing is divided by zero.
        widest = limits.lateral_acceleration_mps2 / self._top_mps**2
        squares = limits.lateral_acceleration_mps2 / np.maximum(bends, widest)
        # v^2 falls by 2 b per metre of braking, so what is left of v^2 + 2 b s of every place ahead
        # is what can still be braked for.
        braked = squares + 2 * braking * at
        ahead = np.minimum.accumulate(braked[::-1])[::-1] - 2 * braking * at
        self._squares: list[float] = ahead.tolist()

    def speed_at(self, distance_m: float) -> float:
        """Return the greatest speed at a distance from waypoint 0, m/s; 0 at the end and beyond."""
        left = self._length_m - distance_m
        if left <= 0:
            return 0.0
        place = max(distance_m, 0.0) / self._length_m * self._steps
        index = min(int(place), self._steps - 1)
        before, after = self._squares[index : index + 2]
        # Straight in v^2, as braking is.
        bends = sqrt(before + (after - before) * (place - index))
        # Solves v^2 = 2 b (left - REACTION_S v).
        late = self._braking_mps2 * REACTION_S
        end = sqrt(late * late + 2 * self._braking_mps2 * left) - late
        return min(bends, max(end, CRAWL_MPS), self._top_mps)
