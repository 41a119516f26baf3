"""Properties of a path and warnings, before it is driven."""

import math
from dataclasses import dataclass

from domain.arrays import Floats, np
from domain.paths.approach import MAY_MISS_SHARE, Approach, ApproachLimits, plan_approach
from domain.paths.path import Path
from domain.paths.speed_profile import SpeedProfile
from domain.vehicle import Pose

_STEP_M = 0.5
_MAX_STEPS = 200_000
_SPARSE_M = 5.0
_STANDING_M = 1e-3
_MANY_STANDING = 10
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
    approach: Approach | None
    """None: the vehicle is on the path, too far from it, or its pose is unknown."""
    duration_s: float
    """Estimated driving time from standstill to standstill, with the approach."""
    warnings: tuple[PathWarning, ...]


def preview(
    path: Path,
    cruise_mps: float,
    pose: Pose | None,
    limits: ApproachLimits,
    start_index: int = 0,
) -> PathPreview:
    """Return the properties of a path and warnings about it.

    Args:
        path: The path to be driven.
        cruise_mps: Speed where nothing else limits it; > 0.
        pose: Pose of the vehicle; None: unknown.
        limits: What the vehicle can do, and from how far it approaches a path.
        start_index: Waypoint at which the task begins.
    """
    vehicle = limits.vehicle
    path = path.for_vehicle(vehicle)
    step_m = _STEP_M * min(vehicle.scale, 1.0)
    steps = min(max(math.ceil(path.length_m / step_m), 1), _MAX_STEPS)
    at = np.linspace(0.0, path.length_m, steps + 1)
    bends = np.abs(path.curvatures_at(at))
    tightest = int(bends.argmax())
    curvature = float(bends[tightest])
    radius = 1 / curvature if curvature > 1e-6 else None
    start = None if pose is None else _start(path, pose, start_index)
    approach = None if pose is None else _approach(path, pose, cruise_mps, limits, start_index)
    distances = np.hypot(*np.diff(path.waypoints[:, :2], axis=0).T)
    spacing = Spacing(float(distances.min()), float(np.median(distances)), float(distances.max()))
    warnings = [*_spacing_warnings(distances), *_start_warnings(start, limits, start_index)]
    if radius is not None and radius < vehicle.min_radius_m:
        index = path.index_after(float(at[tightest]))
        warnings.insert(0, _too_tight(radius, vehicle.min_radius_m, index))
    begun_m = path.distance_of(start_index) if approach is None else approach.meets_m
    duration_s = _duration(path, cruise_mps, limits, at) * (1 - begun_m / path.length_m)
    if approach is not None:
        duration_s += approach.length_m / approach.speed_mps
    return PathPreview(
        path.count,
        path.length_m,
        spacing,
        radius,
        vehicle.min_radius_m,
        radius is None or radius >= vehicle.min_radius_m,
        start,
        approach,
        duration_s,
        tuple(warnings),
    )


def _start(path: Path, pose: Pose, index: int) -> StartDistance:
    first = path.waypoint(index)
    distance = math.hypot(first.x_m - pose.x_m, first.y_m - pose.y_m)
    turned = math.remainder(pose.yaw_rad - path.heading_at(path.distance_of(index)), math.tau)
    return StartDistance(distance, turned)


def _approach(
    path: Path, pose: Pose, cruise_mps: float, limits: ApproachLimits, index: int
) -> Approach | None:
    if _start(path, pose, index).distance_m > limits.from_m:
        return None
    begin_m = path.distance_of(index)
    may_miss_m = MAY_MISS_SHARE * (path.length_m - begin_m)
    return plan_approach(path, pose, index, begin_m, cruise_mps, may_miss_m, limits)


def _too_tight(radius_m: float, least_m: float, index: int) -> PathWarning:
    message = (
        f"a bend of {radius_m:.1f} m radius; the vehicle needs {least_m:.1f} m "
        "and will leave the path there"
    )
    return PathWarning("TOO_TIGHT", message, index)


def _spacing_warnings(distances: Floats) -> list[PathWarning]:
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


def _start_warnings(
    start: StartDistance | None, limits: ApproachLimits, index: int
) -> list[PathWarning]:
    warnings = []
    if start is not None and start.distance_m > limits.from_m:
        message = (
            f"the path begins {start.distance_m:.1f} m from the vehicle, and is approached "
            f"from at most {limits.from_m:g} m"
        )
        warnings.append(PathWarning("FAR_START", message, index))
    if start is not None and abs(start.heading_error_rad) > _TURNED_RAD:
        message = "the vehicle faces away from the direction of the path"
        warnings.append(PathWarning("TURNED_AWAY", message, index))
    return warnings


def _duration(
    path: Path,
    cruise_mps: float,
    limits: ApproachLimits,
    at: Floats,
) -> float:
    """Estimate the driving time from standstill to standstill, s."""
    profile = SpeedProfile(path, cruise_mps, limits.speed, limits.vehicle, float(at[1]))
    allowed = np.array([profile.speed_at(distance) for distance in at.tolist()])
    # From standstill, v^2 rises by at most 2 a per metre from the slowest position before.
    gained = 2 * limits.speed.acceleration_mps2 * at
    squares = np.minimum.accumulate(np.concatenate(([0.0], (allowed**2 - gained)[1:]))) + gained
    speeds = np.maximum(np.sqrt(np.maximum(squares, 0.0)), _LEAST_SPEED_MPS)
    return float((np.diff(at) * 2 / (speeds[1:] + speeds[:-1])).sum())
