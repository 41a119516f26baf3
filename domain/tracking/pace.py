"""Speed and steering that are commanded together, so that no bend is driven too fast.

Trackers only steer; the speed profile knows only the path. What a vehicle off its path steers is
tighter than the path, therefore speed and steering are limited once more, by what is commanded.
"""

from collections import deque
from math import atan, inf, sqrt, tan

from domain.paths.speed_profile import SpeedLimits
from domain.timebase import Duration, Instant, seconds, to_seconds
from domain.vehicle import DriveCommand, VehicleLimits, VehicleState

PERIOD: Duration = seconds(0.05)
"""Period of the control loop."""
GROWING_M = 0.3
"""While a larger cross-track error grows the speed does not; for `REFERENCE_WHEELBASE_M`."""
TRAILING_RAD = 0.15
"""While slow front wheels are further from their command the speed does not grow either."""
CREEP_MPS = 0.3
"""Up to this speed it may: a vehicle that stands can only leave the wrong direction by driving."""


class Pace:
    """The commands of one goal, each limited by the one before.

    The lateral acceleration of the commanded speed stays within its limit both with the commanded
    steering angle and with all angles that the front wheels have until the next command.
    """

    def __init__(self, limits: SpeedLimits, vehicle: VehicleLimits, speed_mps: float) -> None:
        """Begin at a speed.

        Args:
            limits: Limits of the acceleration.
            vehicle: Limits of the vehicle.
            speed_mps: Speed at the beginning, m/s.
        """
        self._vehicle = vehicle
        self._lateral_mps2 = limits.lateral_acceleration_mps2
        self._gain_mps = limits.acceleration_mps2 * to_seconds(PERIOD)
        self._loss_mps = limits.braking_mps2 * to_seconds(PERIOD)
        self._growing_m = GROWING_M * min(vehicle.scale, 1.0)
        self._speed_mps = speed_mps
        self._error_m = inf
        """Cross-track error of the step before, m."""
        self._under_way: deque[tuple[Instant, float]] = deque()
        """Steering angles that were commanded and may not have been reached yet, rad."""

    def braked_mps(self, slow_mps: float) -> float:
        """Return the next speed on the way down to a slower one, m/s."""
        return max(self._speed_mps - self._loss_mps, slow_mps)

    def command(
        self,
        limit_mps: float,
        steering_rad: float,
        error_m: float,
        state: VehicleState,
        now: Instant,
    ) -> DriveCommand:
        """Return the next command.

        Args:
            limit_mps: Speed limit here, m/s.
            steering_rad: Steering angle that the tracker wants, rad.
            error_m: Cross-track error, m.
            state: Of the vehicle.
            now: The current time.
        """
        before = self._speed_mps
        most = before + self._gain_mps
        steering = self._possible(steering_rad)
        if self._grows(abs(error_m)) or self._trails(steering, state):
            most = max(before, min(most, CREEP_MPS))
        # Braking for a bend that is steered already; what is too tight meanwhile is steered later.
        bend_mps = max(self._fastest_mps(steering), before - self._loss_mps)
        speed = max(min(limit_mps, most, bend_mps), 0.0)
        steering = self._slow_enough(steering, max(speed, abs(state.speed_mps)))
        there = self._widest(state.steering_angle_rad, steering, now)
        self._speed_mps = min(speed, self._fastest_mps(there))
        return DriveCommand(self._speed_mps, steering)

    def stop(self, steering_rad: float, state: VehicleState) -> DriveCommand:
        """Return a command to stop while steering as the tracker wants, rad."""
        steering = self._slow_enough(self._possible(steering_rad), abs(state.speed_mps))
        return DriveCommand(0.0, steering)

    def _grows(self, error_m: float) -> bool:
        grows = error_m > self._growing_m and error_m > self._error_m
        self._error_m = error_m
        return grows

    def _trails(self, steering_rad: float, state: VehicleState) -> bool:
        """Tell whether slow front wheels have not yet followed."""
        if self._vehicle.steering_rate_radps is None:
            return False
        return abs(steering_rad - state.steering_angle_rad) > TRAILING_RAD

    def _possible(self, steering_rad: float) -> float:
        most = self._vehicle.max_steering_angle_rad
        return min(max(steering_rad, -most), most)

    def _fastest_mps(self, steering_rad: float) -> float:
        """Return the speed at which an angle leads to the largest lateral acceleration, m/s."""
        bend = tan(min(abs(steering_rad), 1.5))
        return sqrt(self._lateral_mps2 * self._vehicle.wheelbase_m / bend) if bend else inf

    def _slow_enough(self, steering_rad: float, speed_mps: float) -> float:
        """Return an angle cut to what is possible at a speed, rad."""
        square = speed_mps * speed_mps
        if square == 0.0:
            return steering_rad
        most = atan(self._lateral_mps2 * self._vehicle.wheelbase_m / square)
        return min(max(steering_rad, -most), most)

    def _widest(self, actual_rad: float, steering_rad: float, now: Instant) -> float:
        """Return the largest angle that the front wheels have until the next command, rad."""
        under_way = self._under_way
        under_way.append((now, steering_rad))
        oldest = now - seconds(self._vehicle.steering_delay_s) - 2 * PERIOD
        while under_way[0][0] < oldest:
            under_way.popleft()
        return max(abs(actual_rad), *(abs(angle) for _, angle in under_way))
