"""Pure pursuit: steer along the arc that leads from the rear axle to a point ahead on the path.

Source: R. C. Coulter, "Implementation of the Pure Pursuit Path Tracking Algorithm",
CMU-RI-TR-92-01, 1992.

Lengths are those of a vehicle with `REFERENCE_WHEELBASE_M`, and grow with the wheelbase; times grow
with its square root, as those of a scale model in which accelerations are the same.
"""

from math import atan2, copysign, cos, hypot, sin, sqrt

from domain.paths.path import Path
from domain.tracking.tracker import ControlStep
from domain.vehicle import VehicleLimits, VehicleState

LOOKAHEAD_S = 0.75
"""The look-ahead grows with the speed; otherwise delays of the vehicle cause oscillation."""
LATE_LOOKAHEAD_S = 0.25
LATE_LOOKAHEAD = 2.5
"""A late vehicle needs this time, plus this multiple of its delay, however small it is."""
LOOKAHEAD_NEAR = 7.0
"""It grows with a small cross-track error by this factor; otherwise slow steering overshoots."""
LOOKAHEAD_OFF_M = 2.5
LOOKAHEAD_OFF = 1.25
"""Beyond that it grows by this smaller factor; otherwise the return to the path takes long."""
MIN_LOOKAHEAD_M = 2.2
MAX_LOOKAHEAD_M = 9.0


class PurePursuit:
    """Aims at the interpolated point of the path that is one look-ahead away."""

    def __init__(self, limits: VehicleLimits) -> None:
        self._limits = limits
        self._lookahead_s = _lookahead_s(limits)

    def control_step(self, state: VehicleState, path: Path, start_index: int) -> ControlStep:
        """Do one control step; see `PathTracker`."""
        pose, scale = state.pose, self._limits.scale
        here = path.project(pose.x_m, pose.y_m, start_index)
        off = abs(here.cross_track_error_m)
        more = min(LOOKAHEAD_NEAR * off, LOOKAHEAD_OFF_M * scale + LOOKAHEAD_OFF * off)
        wanted = self._lookahead_s * state.speed_mps + more
        reach = min(max(wanted, MIN_LOOKAHEAD_M * scale), MAX_LOOKAHEAD_M * scale)
        aim = path.point_at(here.distance_m + reach)
        dx, dy = aim.x_m - pose.x_m, aim.y_m - pose.y_m
        bearing = atan2(dy, dx) - pose.yaw_rad
        # A point behind is steered to as hard as one abeam; the sine alone would steer straight.
        side = sin(bearing) if cos(bearing) >= 0 else copysign(1.0, sin(bearing))
        wheels = atan2(2 * self._limits.wheelbase_m * side, hypot(dx, dy))
        most = self._limits.max_steering_angle_rad
        return ControlStep(
            steering_angle_rad=min(max(wheels, -most), most),
            target_index=path.index_after(here.distance_m),
            distance_m=here.distance_m,
            cross_track_error_m=here.cross_track_error_m,
            lookahead=aim,
        )


def _lookahead_s(limits: VehicleLimits) -> float:
    """Return how long the vehicle drives to the look-ahead point, s."""
    scaled = LOOKAHEAD_S * sqrt(limits.scale)
    late = LATE_LOOKAHEAD_S + LATE_LOOKAHEAD * limits.steering_delay_s
    return max(scaled, min(late, LOOKAHEAD_S))
