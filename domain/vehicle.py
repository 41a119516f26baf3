"""Pose, motion, commands and limits of a vehicle.

Positions are those of the centre of the rear axle, in metres; angles are in radians,
counter-clockwise from the x axis (REP 103).
"""

from dataclasses import dataclass
from math import tan

from domain.timebase import Duration, seconds

COMMAND_VALID_FOR: Duration = seconds(0.5)
"""How long a drive command is valid. Without a new one the vehicle then stops, so that a dead
supervisor stops it."""


@dataclass(frozen=True, slots=True)
class Point:
    """A position on the ground, in m."""

    x_m: float
    y_m: float


@dataclass(frozen=True, slots=True)
class Pose:
    """Position and heading of the rear axle, in m and rad."""

    x_m: float
    y_m: float
    yaw_rad: float


@dataclass(frozen=True, slots=True)
class VehicleState:
    """Pose and motion of a vehicle at one moment."""

    pose: Pose
    speed_mps: float
    """Along the heading; negative backwards."""
    steering_angle_rad: float
    """Angle of the front wheels, left positive."""


@dataclass(frozen=True, slots=True)
class DriveCommand:
    """Commanded speed and steering of a vehicle."""

    speed_mps: float
    steering_angle_rad: float
    """Angle of the front wheels, left positive."""


DEFAULT_FRAME = "map"
"""Coordinate frame of poses and waypoints. Source: REP 105."""

REFERENCE_WHEELBASE_M = 1.75
"""Wheelbase of the vehicle for which the constants of trackers and limits of error are given."""


@dataclass(frozen=True, slots=True)
class VehicleLimits:
    """Limits of a vehicle; the defaults are those of the Polaris GEM e2.

    Source: smart_polaris, URDF of the GEM e2.
    """

    wheelbase_m: float = REFERENCE_WHEELBASE_M
    """Distance between the axles, m."""
    max_steering_angle_rad: float = 0.61
    """Largest angle of the front wheels to either side, rad."""
    max_speed_mps: float = 11.2
    """Top speed, m/s."""
    braking_mps2: float | None = None
    """Largest deceleration, m/s2; None: it brakes as hard as it is told to."""
    steering_rate_radps: float | None = None
    """How fast the front wheels turn, rad/s; None: as fast as they are told to."""
    steering_delay_s: float = 0.0
    """How late the front wheels follow a command, s: delay and lag together."""

    @property
    def scale(self) -> float:
        """Return the size of the vehicle compared to the one of `REFERENCE_WHEELBASE_M`."""
        return self.wheelbase_m / REFERENCE_WHEELBASE_M

    @property
    def min_radius_m(self) -> float:
        """Return the radius of the tightest bend that the rear axle can drive, m."""
        return self.wheelbase_m / tan(self.max_steering_angle_rad)
