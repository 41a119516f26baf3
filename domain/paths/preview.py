"""What there is to know of a path before it is driven."""

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
    """Something about a path that a person should look at."""

    code: str
    """Stable, UPPER_SNAKE."""
    message: str
    index: int | None = None
    """The waypoint that it is about."""


@dataclass(frozen=True, slots=True)
class Spacing:
    """Distances between waypoints, m."""

    min_m: float
    median_m: float
    max_m: float


@dataclass(frozen=True, slots=True)
class StartDistance:
    """How far the vehicle is from where a path begins."""

    distance_m: float
    heading_error_rad: float
    """Of the vehicle against the path; 0: it looks along it."""


@dataclass(frozen=True, slots=True)
class PathPreview:
    """A path against the vehicle that would drive it."""

    waypoint_count: int
    length_m: float
    spacing: Spacing
    min_radius_m: float | None
    """Of its tightest bend; None: it is straight."""
    vehicle_min_radius_m: float
    steerable: bool
    """Whether the vehicle can steer its tightest bend."""
    start: StartDistance | None
    """None: it is not known where the vehicle is."""
    duration_s: float
    """Estimate, from rest to rest."""
    warnings: tuple[PathWarning, ...]


def preview(
    path: Path,
    cruise_mps: float,
    pose: Pose | None,
    vehicle: VehicleLimits,
    limits: SpeedLimits,
) -> PathPreview:
    """Describe a path.

    Args:
        path: What would be driven.
        cruise_mps: Speed where nothing else limits it; > 0.
        pose: Of the vehicle; None: it is not known.
        vehicle: What it can do.
        limits: How hard it may be accelerated.
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
            f"a bend of {radius:.1f} m radius; the vehicle needs {vehicle_radius:.1f} m, "
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
    """Tell of waypoints that are far from each other, or not at all; distances in m, shape (n,)."""
    warnings = []
    widest = float(distances.max())
    if widest > _SPARSE_M:
        message = f"{widest:.1f} m from one waypoint to the next: straight in between"
        warnings.append(PathWarning("SPARSE", message, int(distances.argmax())))
    standing = int((distances < _STANDING_M).sum())
    if standing > _MANY_STANDING:
        message = f"{standing} waypoints stand where the one before them does"
        warnings.append(PathWarning("STANDS_STILL", message))
    return warnings


def _start_warnings(start: StartDistance | None) -> list[PathWarning]:
    warnings = []
    if start is not None and start.distance_m > _FAR_START_M:
        message = f"it begins {start.distance_m:.1f} m from the vehicle"
        warnings.append(PathWarning("FAR_START", message, 0))
    if start is not None and abs(start.heading_error_rad) > _TURNED_RAD:
        message = "the vehicle looks away from where the path leads"
        warnings.append(PathWarning("TURNED_AWAY", message, 0))
    return warnings


def _duration(
    path: Path,
    cruise_mps: float,
    vehicle: VehicleLimits,
    limits: SpeedLimits,
    at: NDArray[np.float64],
) -> float:
    """Estimate how long the path takes from rest to rest, s."""
    profile = SpeedProfile(path, cruise_mps, limits, vehicle)
    allowed = np.array([profile.speed_at(distance) for distance in at.tolist()])
    # From rest, v^2 rises by 2 a per metre at most, from whichever place is the slowest before.
    gained = 2 * limits.acceleration_mps2 * at
    squares = np.minimum.accumulate(np.concatenate(([0.0], (allowed**2 - gained)[1:]))) + gained
    speeds = np.maximum(np.sqrt(np.maximum(squares, 0.0)), _LEAST_SPEED_MPS)
    return float((np.diff(at) * 2 / (speeds[1:] + speeds[:-1])).sum())
