"""Pose, motion, commands and limits of a vehicle.

Positions are those of the centre of the rear axle, in metres; angles are in radians,
counter-clockwise from the x axis (REP 103).
"""

from dataclasses import dataclass

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


@dataclass(frozen=True, slots=True)
class VehicleLimits:
    """Limits of a vehicle; the defaults are those of the Polaris GEM e2.

    Source: smart_polaris, URDF of the GEM e2.
    """

    wheelbase_m: float = 1.75
    max_steering_angle_rad: float = 0.61
    max_speed_mps: float = 11.2
