"""Speed limit along a path: as its bends and its end allow.

Only braking is planned ahead. A vehicle can also start in the middle of a path, after a pause;
therefore navigation limits the rise of the command by `acceleration_mps2`.
"""

from dataclasses import dataclass
from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from domain.paths.path import Path
from domain.vehicle import VehicleLimits

STEP_M = 0.5
"""Distance between two samples of the curvature, which is smoothed over more."""
MAX_STEPS = 200_000
"""On paths longer than 100 km the samples are further apart."""
CRAWL_MPS = 0.05
"""Lowest command before the end, which would otherwise never be reached; stops without a jerk."""
BRAKING_SHARE = 0.8
"""Planned share of the allowed braking: a vehicle that reacts late has to brake harder."""
REACTION_S = 0.15
"""Delay from a command to the wheels; without it the vehicle would overrun the end."""
TURN_OVER_STEPS = (1, 2, 4, 8)
"""Number of steps over which the turn of the front wheels is limited to what they can."""
FREE_TURN_RAD = 0.06
"""The front wheels need not follow a smaller turn: most are noise of the recording."""
TRAIL_RAD = 0.1
"""How far late front wheels may trail what the path asks of them."""
TURNING_MPS = 0.1
"""Lowest limit because of slow front wheels: a slower task would be aborted."""


@dataclass(frozen=True, slots=True)
class SpeedLimits:
    """Limits of the acceleration of a vehicle."""

    lateral_acceleration_mps2: float = 2.0
    acceleration_mps2: float = 1.0
    braking_mps2: float = 1.0


class SpeedProfile:
    """The speed limit by distance along one path."""

    def __init__(
        self, path: Path, cruise_mps: float, limits: SpeedLimits, vehicle: VehicleLimits
    ) -> None:
        """Plan the speed.

        Args:
            path: The path to be driven.
            cruise_mps: Speed where nothing else limits it.
            limits: Limits of the acceleration; all > 0.
            vehicle: Limits of the vehicle. Where the path bends more than it can steer, as at the
                corner of a polygon, its tightest bend sets the speed. Where the bend changes faster
                than its front wheels turn, it drives slower.
        """
        path = path.for_vehicle(vehicle)
        self._length_m = path.length_m
        braking = BRAKING_SHARE * min(limits.braking_mps2, vehicle.braking_mps2 or inf)
        self._braking_mps2 = braking
        self._top_mps = min(cruise_mps, vehicle.max_speed_mps)
        step_m = STEP_M * min(vehicle.scale, 1.0)
        self._steps = min(ceil(path.length_m / step_m), MAX_STEPS)
        at = np.linspace(0.0, path.length_m, self._steps + 1)
        curvatures = path.curvatures_at(at)
        bends = np.minimum(np.abs(curvatures), 1 / vehicle.min_radius_m)
        # A bend as wide as this is driven at top speed; also avoids a division by zero.
        widest = limits.lateral_acceleration_mps2 / self._top_mps**2
        squares = limits.lateral_acceleration_mps2 / np.maximum(bends, widest)
        squares = np.minimum(squares, _turning_squares(curvatures, at, vehicle))
        # v^2 falls by 2 b per metre of braking, so the minimum of v^2 + 2 b s over all positions
        # ahead limits the speed here.
        braked = squares + 2 * braking * at
        ahead = np.minimum.accumulate(braked[::-1])[::-1] - 2 * braking * at
        self._squares: list[float] = ahead.tolist()

    @property
    def slowest_mps(self) -> float:
        """Return the lowest limit because of bends, m/s; the end does not count."""
        return min(sqrt(min(self._squares)), self._top_mps)

    def speed_at(self, distance_m: float) -> float:
        """Return the speed limit at a distance from waypoint 0, m/s; 0 at the end and beyond."""
        left = self._length_m - distance_m
        if left <= 0:
            return 0.0
        place = max(distance_m, 0.0) / self._length_m * self._steps
        index = min(int(place), self._steps - 1)
        before, after = self._squares[index : index + 2]
        # Interpolated in v^2, which is linear while braking.
        bends = sqrt(before + (after - before) * (place - index))
        # Solves v^2 = 2 b (left - REACTION_S v).
        late = self._braking_mps2 * REACTION_S
        end = sqrt(late * late + 2 * self._braking_mps2 * left) - late
        return min(bends, max(end, CRAWL_MPS), self._top_mps)


def _turning_squares(
    curvatures: NDArray[np.float64], at: NDArray[np.float64], vehicle: VehicleLimits
) -> NDArray[np.float64]:
    """Return the squares of the speeds at which the front wheels turn in time, m2/s2.

    Args:
        curvatures: Of the path, 1/m; shape (n,).
        at: Their distances along the path, evenly spaced, m; shape (n,).
        vehicle: How fast, and how late, its front wheels turn.
    """
    squares = np.full(len(at), inf)
    rate = vehicle.steering_rate_radps or inf
    if vehicle.steering_delay_s > 0:
        # Wheels that turn at a rate trail by rate times delay.
        rate = min(rate, TRAIL_RAD / vehicle.steering_delay_s)
    if rate == inf:
        return squares
    most = vehicle.max_steering_angle_rad
    wheels = np.clip(np.arctan(vehicle.wheelbase_m * curvatures), -most, most)
    for steps in TURN_OVER_STEPS:
        if steps >= len(at):
            break
        turns = np.maximum(np.abs(wheels[steps:] - wheels[:-steps]) - FREE_TURN_RAD, 1e-9)
        speeds = np.maximum(rate * (at[steps] - at[0]) / turns, TURNING_MPS)
        for shift in range(steps + 1):
            within = squares[shift : shift + len(speeds)]
            np.minimum(within, speeds**2, out=within)
    return squares
