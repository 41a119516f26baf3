"""The way from a vehicle beside a path, or turned, onto it: forward only, as short as possible.

The way is a curve of arcs and straights that meets the path in its direction. Where it meets the
path is chosen such that the path is still covered: a stretch that the vehicle never comes near
would be missing in the end.
"""

from dataclasses import dataclass
from math import inf, remainder, sqrt, tau

import numpy as np

from domain.paths.dubins import DubinsCurve, shortest_curve
from domain.paths.path import Path, Projection
from domain.paths.speed_profile import SpeedLimits, SpeedProfile
from domain.vehicle import Pose, VehicleLimits

ON_PATH_M = 0.5
"""With a larger cross-track error the path is approached; for `REFERENCE_WHEELBASE_M`."""
NEAR_PATH_M = 3.0
"""With a larger cross-track error the path is not passed; for `REFERENCE_WHEELBASE_M`."""
MAY_MISS_SHARE = 0.03
"""Planned share of the path that the vehicle never comes near; 5 % are too much."""
TURNED_RAD = 0.5
"""With a larger heading error the path is approached."""
ALIGNED_RAD = 0.2
"""An approach ends with no larger heading error."""
APPROACH_MPS = 1.0
"""Speed of an approach, for `REFERENCE_WHEELBASE_M`."""
RADIUS_SHARE = 1.5
"""Radius of the arcs, in tightest radii of the vehicle: leaves room for corrections."""

_MEETS_EVERY = 0.5
"""Distance between places where the path could be met, in radii."""
_MEETS_WITHIN = 4.0
"""How far ahead of the vehicle the path is met at most, in radii."""
_TURN_RADII = 2.0
"""What a radian of turning costs, in radii: wheels need time to turn."""
_EARLY = 0.5
"""What a metre further along the path is worth, in metres of way: the way is driven slowly."""
_NEAR_SHARE = 0.95
"""The vehicle does not follow its way exactly: what is planned to be near is nearer."""
_BARELY_SHARE = 0.85
_BARELY = 5.0
"""What a metre of the path that is passed just near enough costs, in metres of way."""
_BEYOND_M = 9.0
"""The way goes on along the path, at least as far as a tracker looks ahead."""
_SPACING_M = 0.1


@dataclass(frozen=True, slots=True)
class Approach:
    """A way onto a path."""

    way: Path
    """From the vehicle to the path, and on along it."""
    length_m: float
    """Distance that is driven until the path is met."""
    meets_m: float
    """Distance along the path where it is met."""
    distance_m: float
    """Distance of the vehicle from the path."""
    turn_rad: float
    """Heading of the path minus heading of the vehicle, -pi to pi: how far it has to turn."""
    speed_mps: float
    """Speed of the approach."""


def on_path_m(limits: VehicleLimits) -> float:
    """Return the largest cross-track error of a vehicle that is on its path, m."""
    return ON_PATH_M * min(limits.scale, 1.0)


def near_path_m(limits: VehicleLimits) -> float:
    """Return the largest cross-track error at which a vehicle passes the path, m."""
    return NEAR_PATH_M * min(limits.scale, 1.0)


def approach_mps(limits: VehicleLimits) -> float:
    """Return the speed of a vehicle that is not on its path, m/s."""
    return APPROACH_MPS * sqrt(limits.scale)


def is_on_path(here: Projection, pose: Pose, limits: VehicleLimits, turned_rad: float) -> bool:
    """Tell whether a vehicle is on a path and drives along it.

    Args:
        here: Projection of the vehicle onto the path.
        pose: Of the vehicle.
        limits: Of the vehicle.
        turned_rad: Largest heading error, rad.
    """
    turned = abs(remainder(here.heading_rad - pose.yaw_rad, tau))
    return abs(here.cross_track_error_m) <= on_path_m(limits) and turned <= turned_rad


def plan_approach(
    path: Path,
    pose: Pose,
    start_index: int,
    begin_m: float,
    cruise_mps: float,
    vehicle: VehicleLimits,
    speed: SpeedLimits,
    near_m: float | None = None,
    may_miss_m: float | None = None,
) -> Approach | None:
    """Return the way of a vehicle onto a path; None: it is on it.

    Args:
        path: As the vehicle sees it (`Path.for_vehicle`).
        pose: Of the vehicle.
        start_index: First waypoint not yet passed.
        begin_m: Distance along the path up to which it is passed, m.
        cruise_mps: Speed of the task, m/s.
        vehicle: Limits of the vehicle.
        speed: Limits of its acceleration.
        near_m: What is no further from the way is not missing, m; None: `near_path_m`.
        may_miss_m: Length of the path that may be missing, m; None: `MAY_MISS_SHARE` of it.
    """
    near_m = near_path_m(vehicle) if near_m is None else near_m
    may_miss_m = MAY_MISS_SHARE * path.length_m if may_miss_m is None else may_miss_m
    here = path.project(pose.x_m, pose.y_m, start_index)
    begin_m = min(begin_m, here.distance_m)
    if is_on_path(here, pose, vehicle, TURNED_RAD):
        # Who stands too far ahead of the start drives back to it.
        skipped_m = here.distance_m - begin_m - near_m
        if skipped_m <= may_miss_m:
            return None
    radius_m = RADIUS_SHARE * vehicle.min_radius_m
    curve, met_m = _best(path, pose, begin_m, here.distance_m, radius_m, near_m, may_miss_m)
    way = _joined(curve, path, met_m, vehicle)
    slow = min(cruise_mps, approach_mps(vehicle), vehicle.max_speed_mps)
    return Approach(
        way,
        curve.length_m,
        met_m,
        abs(here.cross_track_error_m),
        remainder(here.heading_rad - pose.yaw_rad, tau),
        SpeedProfile(way, slow, speed, vehicle).slowest_mps,
    )


def _best(
    path: Path,
    pose: Pose,
    begin_m: float,
    here_m: float,
    radius_m: float,
    near_m: float,
    may_miss_m: float,
) -> tuple[DubinsCurve, float]:
    """Return the curve that meets the path soonest, as far as it still covers it, and where."""
    until_m = min(here_m + _MEETS_WITHIN * radius_m, path.length_m)
    count = 2 + int((until_m - begin_m) / (_MEETS_EVERY * radius_m))
    found: tuple[DubinsCurve, float] | None = None
    best = (inf, inf)
    for met_m in np.linspace(begin_m, until_m, count).tolist():
        place = path.point_at(met_m)
        end = Pose(place.x_m, place.y_m, path.heading_at(met_m))
        curve = shortest_curve(pose, end, radius_m)
        missed_m, barely_m = _missed_m(path, curve, begin_m, met_m, near_m)
        length_m = curve.length_m + _BARELY * barely_m + _TURN_RADII * radius_m * curve.turned_rad
        cost = (max(missed_m - may_miss_m, 0.0), length_m - _EARLY * met_m)
        if found is None or cost < best:
            found, best = (curve, met_m), cost
    assert found is not None
    return found


def _missed_m(
    path: Path, curve: DubinsCurve, begin_m: float, met_m: float, near_m: float
) -> tuple[float, float]:
    """Return what a curve never comes near of the path between two distances, m.

    Returns:
        Its length, and the length of what it comes near enough or not quite.
    """
    count = int((met_m - begin_m) / (near_m / 8))
    if count == 0:
        return 0.0, 0.0
    piece_m = (met_m - begin_m) / count
    driven = curve.places(near_m / 8)[:, :2]
    missed = barely = 0
    for number in range(count):
        place = path.point_at(begin_m + (number + 0.5) * piece_m)
        away_m = np.hypot(driven[:, 0] - place.x_m, driven[:, 1] - place.y_m).min()
        missed += bool(away_m > _NEAR_SHARE * near_m)
        barely += bool(away_m > _BARELY_SHARE * near_m)
    return missed * piece_m, barely * piece_m


def _joined(curve: DubinsCurve, path: Path, met_m: float, vehicle: VehicleLimits) -> Path:
    """Return a curve continued along the path that it meets, as the vehicle sees it."""
    spacing_m = _SPACING_M * min(vehicle.scale, 1.0)
    rows = curve.places(spacing_m)
    beyond_m = met_m + _BEYOND_M * max(vehicle.scale, 1.0)
    along = np.arange(met_m + spacing_m, beyond_m, spacing_m)
    onwards = [(place.x_m, place.y_m, 0.0) for place in map(path.point_at, along.tolist())]
    return Path(np.concatenate((rows, np.array(onwards)))).for_vehicle(vehicle)
