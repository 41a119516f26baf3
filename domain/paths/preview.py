"""Properties of a path and warnings, before it is driven."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from domain.paths.approach import plan_approach
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
class ApproachPreview:
    """How a vehicle beside a path, or turned, gets onto it."""

    distance_m: float
    """Distance of the vehicle from the path."""
    turn_rad: float
    """Heading of the path minus heading of the vehicle, -pi to pi."""
    speed_mps: float
    """Speed until it is on the path."""
    length_m: float
    """Distance that it drives until it is on the path; loops need room."""
    meets_m: float
    """Distance along the path where it gets onto it."""


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
    approach: ApproachPreview | None
    """None: the vehicle is on the path, too far from it, or its pose is unknown."""
    duration_s: float
    """Estimated driving time from standstill to standstill, with the approach."""
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
    path = path.for_vehicle(vehicle)
    step_m = _STEP_M * min(vehicle.scale, 1.0)
    steps = min(max(math.ceil(path.length_m / step_m), 1), _MAX_STEPS)
    at = np.linspace(0.0, path.length_m, steps + 1)
    bends = np.abs(path.curvatures_at(at))
    tightest = int(bends.argmax())
    curvature = float(bends[tightest])
    radius = 1 / curvature if curvature > 1e-6 else None
    vehicle_radius = vehicle.min_radius_m
    steerable = radius is None or radius >= vehicle_radius
    start = None if pose is None else _start(path, pose)
    approach = None if pose is None else _approach(path, pose, cruise_mps, vehicle, limits)
    duration_s = _duration(path, cruise_mps, vehicle, limits, at)
    if approach is not None:
        left = 1 - approach.meets_m / path.length_m
        duration_s = approach.length_m / approach.speed_mps + left * duration_s
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
        approach,
        duration_s,
        tuple(warnings),
    )


def _start(path: Path, pose: Pose) -> StartDistance:
    first = path.waypoint(0)
    distance = math.hypot(first.x_m - pose.x_m, first.y_m - pose.y_m)
    turned = math.remainder(pose.yaw_rad - path.heading_at(0.0), math.tau)
    return StartDistance(distance, turned)


def _approach(
    path: Path, pose: Pose, cruise_mps: float, vehicle: VehicleLimits, limits: SpeedLimits
) -> ApproachPreview | None:
    if _start(path, pose).distance_m > _FAR_START_M:
        return None
    way = plan_approach(path, pose, 0, 0.0, cruise_mps, vehicle, limits)
    if way is None:
        return None
    return ApproachPreview(way.distance_m, way.turn_rad, way.speed_mps, way.length_m, way.meets_m)


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
