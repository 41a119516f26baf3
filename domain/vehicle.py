"""Where a vehicle is, what it is told, and what it can do.

Positions are those of the middle of the rear axle, in metres; angles are in radians,
counter-clockwise from the x axis (REP 103).
"""

from dataclasses import dataclass

from domain.timebase import Duration, seconds

COMMAND_VALID_FOR: Duration = seconds(0.5)
"""So long a vehicle follows a command to drive; then it stands still unless there is a new one, so
that a dead supervisor stops it."""


@dataclass(frozen=True, slots=True)
class Point:
    """A place on the ground, m."""

    x_m: float
    y_m: float


@dataclass(frozen=True, slots=True)
class Pose:
    """Place and heading of the rear axle; m and rad."""

    x_m: float
    y_m: float
    yaw_rad: float


@dataclass(frozen=True, slots=True)
class VehicleState:
    """How a vehicle moves at one moment."""

    pose: Pose
    speed_mps: float
    """Along the heading; negative backwards."""
    steering_angle_rad: float
    """Angle of the front wheels, left positive."""


@dataclass(frozen=True, slots=True)
class DriveCommand:
    """What a vehicle is told to do."""

    speed_mps: float
    steering_angle_rad: float
    """Angle of the front wheels, left positive."""


@dataclass(frozen=True, slots=True)
class VehicleLimits:
    """What a vehicle can do; the usual values are those of the Polaris GEM e2.

    Source: smart_polaris, URDF of the GEM e2.
    """

    wheelbase_m: float = 1.75
    max_steering_angle_rad: float = 0.61
    max_speed_mps: float = 11.2
