"""Braking before a way onto a path: a vehicle that rolls too fast would be carried off it."""

from math import hypot, remainder, tau

from domain.timebase import Duration, Instant, to_seconds
from domain.tracking.leg import Leg
from domain.tracking.line_watch import GivenUpError
from domain.tracking.tracker import ControlStep
from domain.vehicle import VehicleState

AHEAD_RAD = 0.5
"""A vehicle turned by more rolls straight on; the path would swing it round at speed."""
_FASTER = 1.2
_FASTER_MPS = 0.1
_LEAST_MPS = 0.05
"""A smaller loss of speed is none."""


class SlowDown:
    """A vehicle that brakes until it is slow enough for its way onto the path."""

    def __init__(self, leg: Leg, speed_mps: float, state: VehicleState, now: Instant) -> None:
        """Begin to brake.

        Args:
            leg: The path, which is followed meanwhile if the vehicle heads along it.
            speed_mps: Speed of the way.
            state: Of the vehicle.
            now: The current time.
        """
        self.speed_mps = speed_mps
        self._leg = leg
        self._begun = state.pose
        self._slowest_mps = abs(state.speed_mps)
        self._slowed_at = now

    def is_over(self, state: VehicleState) -> bool:
        """Tell whether the vehicle is slow enough."""
        return is_slow(state, self.speed_mps)

    def rolled_m(self, state: VehicleState) -> float:
        """Return how far the vehicle is from where it began to brake, m."""
        return hypot(state.pose.x_m - self._begun.x_m, state.pose.y_m - self._begun.y_m)

    def follow(self, state: VehicleState) -> tuple[ControlStep, float]:
        """Do one control step; return it with the steering angle to brake with, rad.

        Raises:
            GivenUpError: The tracker fails, or commands what is not a number.
        """
        step = self._leg.follow(state)
        heading = self._leg.path.heading_at(step.distance_m)
        is_ahead = abs(remainder(heading - state.pose.yaw_rad, tau)) <= AHEAD_RAD
        return step, step.steering_angle_rad if is_ahead else 0.0

    def judge(self, state: VehicleState, patience: Duration, now: Instant) -> None:
        """Give up a vehicle that does not brake.

        Raises:
            GivenUpError: It has not become slower for this long.
        """
        speed = abs(state.speed_mps)
        if speed <= self._slowest_mps - _LEAST_MPS:
            self._slowest_mps, self._slowed_at = speed, now
        elif now - self._slowed_at >= patience:
            long_s = to_seconds(patience)
            raise GivenUpError(f"{speed:.1f} m/s, and no slower for {long_s:g} s")


def is_slow(state: VehicleState, speed_mps: float) -> bool:
    """Tell whether a vehicle is slow enough for a way that is driven at a speed."""
    return abs(state.speed_mps) <= _FASTER * speed_mps + _FASTER_MPS
