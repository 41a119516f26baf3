"""Speed limit along a path: as its bends and its end allow.

Only braking is planned ahead, and only as far as the vehicle may need to brake: a goal on a long
path begins, and goes on, at the cost of a short one. A vehicle can also start in the middle of a
path, after a pause; therefore navigation limits the rise of the command by `acceleration_mps2`.
"""

from dataclasses import dataclass
from math import ceil, inf, sqrt

from domain.arrays import Floats, np
from domain.paths.path import Path
from domain.vehicle import VehicleLimits

STEP_M = 0.5
"""Distance between two samples of the curvature, which is smoothed over more."""
STRETCH_STEPS = 500
"""So many samples are planned at once, or as many as are needed to brake."""
CRAWL_MPS = 0.05
"""Lowest command before the end, which would otherwise never be reached; stops without a jerk."""
BRAKING_SHARE = 0.8
"""Planned share of the allowed braking: a vehicle that reacts late has to brake harder."""
LATERAL_SHARE = 0.95
"""Planned share of the lateral acceleration: a tracker also needs some to correct its error."""
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
        self,
        path: Path,
        cruise_mps: float,
        limits: SpeedLimits,
        vehicle: VehicleLimits,
        step_m: float | None = None,
    ) -> None:
        """Plan the speed.

        Args:
            path: The path to be driven.
            cruise_mps: Speed where nothing else limits it.
            limits: Limits of the acceleration; all > 0.
            vehicle: Limits of the vehicle. Where the path bends more than it can steer, as at the
                corner of a polygon, its tightest bend sets the speed. Where the bend changes faster
                than its front wheels turn, it drives slower.
            step_m: Distance between two samples, m; None: `STEP_M`, less for a small vehicle.
        """
        self._path = path.for_vehicle(vehicle)
        self._vehicle = vehicle
        self._lateral_mps2 = LATERAL_SHARE * limits.lateral_acceleration_mps2
        braking = BRAKING_SHARE * min(limits.braking_mps2, vehicle.braking_mps2 or inf)
        self._braking_mps2 = braking
        self._top_mps = min(cruise_mps, vehicle.max_speed_mps)
        self._length_m = path.length_m
        self._steps = ceil(path.length_m / (step_m or STEP_M * min(vehicle.scale, 1.0)))
        self._step_m = path.length_m / self._steps
        self._ahead = ceil(self._top_mps**2 / (2 * braking) / self._step_m)
        """So many steps ahead it may have to brake."""
        self._first = 0
        self._squares: list[float] = []
        """Squares of the limits of one stretch of samples, m2/s2; `_first` is its first one."""

    @property
    def slowest_mps(self) -> float:
        """Return the lowest limit because of bends, m/s; the end does not count."""
        return min(sqrt(float(self._bend_squares(0, self._steps).min())), self._top_mps)

    def speed_at(self, distance_m: float) -> float:
        """Return the speed limit at a distance from waypoint 0, m/s; 0 at the end and beyond."""
        left = self._length_m - distance_m
        if left <= 0:
            return 0.0
        place = max(distance_m, 0.0) / self._step_m
        index = min(int(place), self._steps - 1)
        if not 0 <= index - self._first < len(self._squares) - 1:
            self._plan(index)
        before, after = self._squares[index - self._first : index - self._first + 2]
        # Interpolated in v^2, which is linear while braking.
        bends = sqrt(before + (after - before) * (place - index))
        # Solves v^2 = 2 b (left - REACTION_S v).
        late = self._braking_mps2 * REACTION_S
        end = sqrt(late * late + 2 * self._braking_mps2 * left) - late
        return min(bends, max(end, CRAWL_MPS), self._top_mps)

    def _plan(self, index: int) -> None:
        """Plan the stretch that a sample belongs to."""
        count = max(STRETCH_STEPS, self._ahead)
        first = index - index % count
        last = min(first + count, self._steps)
        squares = self._bend_squares(first, min(last + self._ahead, self._steps))
        # v^2 falls by 2 b per metre of braking, so the minimum of v^2 + 2 b s over all positions
        # ahead limits the speed here.
        gained = 2 * self._braking_mps2 * self._step_m * np.arange(len(squares))
        ahead = np.minimum.accumulate((squares + gained)[::-1])[::-1] - gained
        self._first, self._squares = first, ahead[: last - first + 1].tolist()

    def _bend_squares(self, first: int, last: int) -> Floats:
        """Return the squares of the limits because of bends alone, from sample to sample, m2/s2."""
        margin = TURN_OVER_STEPS[-1]
        begin, end = max(first - margin, 0), min(last + margin, self._steps)
        at = np.linspace(begin * self._step_m, end * self._step_m, end - begin + 1)
        curvatures = self._path.curvatures_at(at)
        bends = np.minimum(np.abs(curvatures), 1 / self._vehicle.min_radius_m)
        # A bend as wide as this is driven at top speed; also avoids a division by zero.
        widest = self._lateral_mps2 / self._top_mps**2
        squares = self._lateral_mps2 / np.maximum(bends, widest)
        squares = np.minimum(squares, _turning_squares(curvatures, self._step_m, self._vehicle))
        return squares[first - begin : last - begin + 1]


def _turning_squares(curvatures: Floats, step_m: float, vehicle: VehicleLimits) -> Floats:
    """Return the squares of the speeds at which the front wheels turn in time, m2/s2.

    Args:
        curvatures: Of the path, evenly spaced, 1/m; shape (n,).
        step_m: Distance between two of them, m.
        vehicle: How fast, and how late, its front wheels turn.
    """
    squares = np.full(len(curvatures), inf)
    rate = vehicle.steering_rate_radps or inf
    if vehicle.steering_delay_s > 0:
        # Wheels that turn at a rate trail by rate times delay.
        rate = min(rate, TRAIL_RAD / vehicle.steering_delay_s)
    if rate == inf:
        return squares
    most = vehicle.max_steering_angle_rad
    wheels = np.clip(np.arctan(vehicle.wheelbase_m * curvatures), -most, most)
    for steps in TURN_OVER_STEPS:
        if steps >= len(curvatures):
            break
        turns = np.maximum(np.abs(wheels[steps:] - wheels[:-steps]) - FREE_TURN_RAD, 1e-9)
        speeds = np.maximum(rate * steps * step_m / turns, TURNING_MPS)
        for shift in range(steps + 1):
            within = squares[shift : shift + len(speeds)]
            np.minimum(within, speeds**2, out=within)
    return squares
