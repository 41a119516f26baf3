"""Properties of a path and warnings, before it is driven."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from domain.paths.path import Path
from domain.paths.speed_profile import SpeedLimits, SpeedProfile
from domain.vehicle import Pose, VehicleLimits

_STEP_M = 0.5
_MAX_STEPS = 200_000
_SPARSE_M = 5.0
_STANDING_M = 1e-3
_MANY_STANDING = 10
_FAR_START_M = 5.0
_TURNED_RAD = math.pi / 2
_LEAST_SPEED_MPS = 0.1


@dataclass(frozen=True, slots=True)
class PathWarning:
    """A property of a path that a person should check."""

    code: str
    """Stable, UPPER_SNAKE."""
    message: str
    index: int | None = None
    """Index of the waypoint concerned; None: none in particular."""
    hint: str | None = None
    """What to do."""


@dataclass(frozen=True, slots=True)
class Spacing:
    """Distances between waypoints, m."""

    min_m: float
    median_m: float
    max_m: float


@dataclass(frozen=True, slots=True)
class StartDistance:
    """Distance and heading error of the vehicle at the start of a path."""

    distance_m: float
    heading_error_rad: float
    """Heading of the vehicle minus heading of the path; 0: it faces along the path."""


@dataclass(frozen=True, slots=True)
class PathPreview:
    """Properties of a path for the vehicle that would drive it."""

    waypoint_count: int
    length_m: float
    spacing: Spacing
    min_radius_m: float | None
    """Radius of the tightest bend; None: the path is straight."""
    vehicle_min_radius_m: float
    steerable: bool
    """Whether the vehicle can steer the tightest bend."""
    start: StartDistance | None
    """None: the pose of the vehicle is unknown."""
    duration_s: float
    """Estimated driving time from standstill to standstill."""
    warnings: tuple[PathWarning, ...]


def preview(
    path: Path,
    cruise_mps: float,
    pose: Pose | None,
    vehicle: VehicleLimits,
    limits: SpeedLimits,
) -> PathPreview:
    """Return the properties of a path and warnings about it.

    Args:
        path: The path to be driven.
        cruise_mps: Speed where nothing else limits it; > 0.
        pose: Pose of the vehicle; None: unknown.
        vehicle: Limits of the vehicle.
        limits: Limits of its acceleration.
    """
    steps = min(max(math.ceil(path.length_m / _STEP_M), 1), _MAX_STEPS)
    at = np.linspace(0.0, path.length_m, steps + 1)
    bends = np.abs(path.curvatures_at(at))
    tightest = int(bends.argmax())
    curvature = float(bends[tightest])
    radius = 1 / curvature if curvature > 1e-6 else None
    vehicle_radius = vehicle.wheelbase_m / math.tan(vehicle.max_steering_angle_rad)
    steerable = radius is None or radius >= vehicle_radius
    start = None if pose is None else _start(path, pose)
    distances = np.hypot(*np.diff(path.waypoints[:, :2], axis=0).T)
    spacing = Spacing(float(distances.min()), float(np.median(distances)), float(distances.max()))
    warnings = [*_spacing_warnings(distances), *_start_warnings(start)]
    if not steerable and radius is not None:
        message = (
            f"a bend of {radius:.1f} m radius; the vehicle needs {vehicle_radius:.1f} m "
            "and will leave the path there"
        )
        index = path.index_after(float(at[tightest]))
        warnings.insert(0, PathWarning("TOO_TIGHT", message, index))
    return PathPreview(
        path.count,
        path.length_m,
        spacing,
        radius,
        vehicle_radius,
        steerable,
        start,
        _duration(path, cruise_mps, vehicle, limits, at),
        tuple(warnings),
    )


def _start(path: Path, pose: Pose) -> StartDistance:
    first = path.waypoint(0)
    distance = math.hypot(first.x_m - pose.x_m, first.y_m - pose.y_m)
    turned = math.remainder(pose.yaw_rad - path.heading_at(0.0), math.tau)
    return StartDistance(distance, turned)


def _spacing_warnings(distances: NDArray[np.float64]) -> list[PathWarning]:
    """Warn about waypoints that are far apart or coincide; distances in m, shape (n,)."""
    warnings = []
    widest = float(distances.max())
    if widest > _SPARSE_M:
        message = f"{widest:.1f} m between two waypoints; the path is straight in between"
        warnings.append(PathWarning("SPARSE", message, int(distances.argmax())))
    standing = int((distances < _STANDING_M).sum())
    if standing > _MANY_STANDING:
        message = f"{standing} waypoints are at the position of the one before"
        warnings.append(PathWarning("STANDS_STILL", message))
    return warnings


def _start_warnings(start: StartDistance | None) -> list[PathWarning]:
    warnings = []
    if start is not None and start.distance_m > _FAR_START_M:
        message = f"the path begins {start.distance_m:.1f} m from the vehicle"
        warnings.append(PathWarning("FAR_START", message, 0))
    if start is not None and abs(start.heading_error_rad) > _TURNED_RAD:
        message = "the vehicle faces away from the direction of the path"
        warnings.append(PathWarning("TURNED_AWAY", message, 0))
    return warnings


def _duration(
    path: Path,
    cruise_mps: float,
    vehicle: VehicleLimits,
    limits: SpeedLimits,
    at: NDArray[np.float64],
) -> float:
    """Estimate the driving time from standstill to standstill, s."""
    profile = SpeedProfile(path, cruise_mps, limits, vehicle)
    allowed = np.array([profile.speed_at(distance) for distance in at.tolist()])
    # From standstill, v^2 rises by at most 2 a per metre from the slowest position before.
    gained = 2 * limits.acceleration_mps2 * at
    squares = np.minimum.accumulate(np.concatenate(([0.0], (allowed**2 - gained)[1:]))) + gained
    speeds = np.maximum(np.sqrt(np.maximum(squares, 0.0)), _LEAST_SPEED_MPS)
    return float((np.diff(at) * 2 / (speeds[1:] + speeds[:-1])).sum())
