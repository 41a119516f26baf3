"""Stanley: steer the front wheels along the path of the front axle, and towards it by its offset.

Source: G. M. Hoffmann, C. J. Tomlin, M. Montemerlo, S. Thrun, "Autonomous Automobile Trajectory
Tracking for Off-Road Driving", American Control Conference 2007, including damping and softening.

The constants are those of a vehicle with `REFERENCE_WHEELBASE_M`. Lengths grow with the wheelbase,
times and speeds with its square root, as those of a scale model with the same accelerations.
"""

from math import atan, cos, pi, sin, sqrt

from domain.paths.path import Path
from domain.tracking.tracker import ControlStep
from domain.vehicle import Point, VehicleLimits, VehicleState

GAIN_PER_S = 0.9
SOFTENING_MPS = 0.3
"""Limits the approach angle at standstill, and the effect of noise at low speed."""
MAX_APPROACH_RAD = 0.25
"""After a steeper approach, slow steering would turn in too late and cross the path."""
CALM_NEAR_PER_M = 2.0
"""The gain falls with the cross-track error; otherwise slow steering overshoots and oscillates."""
CALM_OFF = 0.5
CALM_OFF_PER_M = 0.5
"""Further off it falls less; otherwise the return to the path takes long."""
TURN_PER_S = 2.0
"""Upper limit of the heading correction; otherwise delayed steering oscillates at high speed."""
DAMPING_S = 0.2
"""The heading is predicted by this time, with the current steering angle."""
PREVIEW_S = 0.1
"""Bends are steered this time ahead: a compromise between fast and slow steering."""


class Stanley:
    """Steers the front axle such that the rear axle stays on the path.

    The original law steers the front axle onto the path, so that the rear axle cuts every bend.
    Here the front axle follows the line that it takes while the rear axle is on the path: one
    wheelbase ahead along the heading, turned by the steering angle that the bend needs.
    """

    def __init__(self, limits: VehicleLimits) -> None:
        self._limits = limits
        self._slower = sqrt(limits.scale)
        """By which times and speeds are scaled."""

    def control_step(self, state: VehicleState, path: Path, start_index: int) -> ControlStep:
        """Do one control step; see `PathTracker`."""
        pose, speed, wheelbase = state.pose, abs(state.speed_mps), self._limits.wheelbase_m
        slower, scale = self._slower, self._limits.scale
        here = path.project(pose.x_m, pose.y_m, start_index)
        foot, heading = path.point_at(here.distance_m), here.heading_rad
        aim = Point(foot.x_m + wheelbase * cos(heading), foot.y_m + wheelbase * sin(heading))
        bend = atan(wheelbase * path.curvature_at(here.distance_m + PREVIEW_S * slower * speed))
        dx = pose.x_m + wheelbase * cos(pose.yaw_rad) - aim.x_m
        dy = pose.y_m + wheelbase * sin(pose.yaw_rad) - aim.y_m
        off = cos(heading + bend) * dy - sin(heading + bend) * dx
        approach = atan(GAIN_PER_S / slower * off / (speed + SOFTENING_MPS * slower))
        approach = min(max(approach, -MAX_APPROACH_RAD), MAX_APPROACH_RAD)
        turn = (heading - pose.yaw_rad + pi) % (2 * pi) - pi - approach
        turn -= DAMPING_S * slower * speed / wheelbase * (state.steering_angle_rad - bend)
        gain = min(1.0, TURN_PER_S / slower * wheelbase / max(speed, SOFTENING_MPS * slower))
        far = abs(here.cross_track_error_m) / scale
        gain /= 1 + min(CALM_NEAR_PER_M * far, CALM_OFF + CALM_OFF_PER_M * far)
        most = self._limits.max_steering_angle_rad
        return ControlStep(
            steering_angle_rad=min(max(bend + gain * turn, -most), most),
            target_index=path.index_after(here.distance_m),
            distance_m=here.distance_m,
            cross_track_error_m=here.cross_track_error_m,
            lookahead=aim,
        )
