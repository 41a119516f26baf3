"""The way from a vehicle beside a path, or turned, onto it: forward only, as short as possible.

The way is a curve of arcs and straights that meets the path in its direction. Where it meets the
path is chosen such that the path is still covered: a stretch that the vehicle never comes near
would be missing in the end.
"""

from dataclasses import dataclass
from math import ceil, hypot, remainder, sqrt, tau

from domain.arrays import np
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
RADIUS_WHEELBASES = 2.1
"""Radius of the arcs, in wheelbases, at least: trackers look ahead as far as the wheelbase asks."""

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
_MAX_PLACES = 64
"""Bound on the places where the path could be met, whatever the start distance is set to."""
_MAX_SAMPLES = 128
"""Bound on the pieces of the path, and of a curve, that are compared."""
_MAX_SPACINGS = 4_000
"""Bound on the waypoints of the way."""


class FarFromPathError(Exception):
    """The vehicle is too far from its path to approach it."""

    def __init__(self, away_m: float) -> None:
        """Say how far.

        Args:
            away_m: Distance from where the path goes on, m.
        """
        super().__init__(f"{away_m:.1f} m from where the path goes on")
        self.away_m = away_m


@dataclass(frozen=True, slots=True)
class ApproachLimits:
    """What a vehicle can do, and from how far it approaches a path."""

    vehicle: VehicleLimits
    speed: SpeedLimits
    near_m: float
    """What is no further from the way is not missing, m."""
    from_m: float
    """Largest distance from where the path begins, or goes on, m."""


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


def approach_radius_m(limits: VehicleLimits) -> float:
    """Return the radius of the arcs that a vehicle drives onto its path, m."""
    return max(RADIUS_SHARE * limits.min_radius_m, RADIUS_WHEELBASES * limits.wheelbase_m)


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
    may_miss_m: float,
    limits: ApproachLimits,
) -> Approach | None:
    """Return the way of a vehicle onto a path; None: it is on it.

    Args:
        path: As the vehicle sees it (`Path.for_vehicle`).
        pose: Of the vehicle.
        start_index: First waypoint not yet passed.
        begin_m: Distance along the path up to which it is passed, m.
        cruise_mps: Speed of the task, m/s.
        may_miss_m: Length of the path that may be missing, m.
        limits: What the vehicle can do, and from how far.

    Raises:
        FarFromPathError: It is too far from where the path goes on.
    """
    vehicle = limits.vehicle
    here = path.project(pose.x_m, pose.y_m, start_index)
    begun = path.point_at(begin_m)
    begin_m = min(begin_m, here.distance_m)
    # Who stands too far ahead of the start drives back to it.
    skipped_m = here.distance_m - begin_m - limits.near_m
    if is_on_path(here, pose, vehicle, TURNED_RAD) and skipped_m <= may_miss_m:
        return None
    away_m = hypot(begun.x_m - pose.x_m, begun.y_m - pose.y_m)
    if away_m > limits.from_m:
        raise FarFromPathError(away_m)
    curve, met_m = _best(path, pose, begin_m, here.distance_m, may_miss_m, limits)
    way = _joined(curve, path, met_m, vehicle)
    slow = min(cruise_mps, approach_mps(vehicle), vehicle.max_speed_mps)
    return Approach(
        way,
        curve.length_m,
        met_m,
        abs(here.cross_track_error_m),
        remainder(here.heading_rad - pose.yaw_rad, tau),
        SpeedProfile(way, slow, limits.speed, vehicle).slowest_mps,
    )


def _best(
    path: Path,
    pose: Pose,
    begin_m: float,
    here_m: float,
    may_miss_m: float,
    limits: ApproachLimits,
) -> tuple[DubinsCurve, float]:
    """Return the curve that meets the path soonest, as far as it still covers it, and where."""
    radius_m = approach_radius_m(limits.vehicle)
    until_m = min(here_m + _MEETS_WITHIN * radius_m, path.length_m)
    stretch = _Stretch(path, begin_m, until_m, limits.near_m)
    count = min(2 + int((until_m - begin_m) / (_MEETS_EVERY * radius_m)), _MAX_PLACES)
    found: list[tuple[float, float, DubinsCurve, float]] = []
    for met_m in np.linspace(begin_m, until_m, count).tolist():
        place = path.point_at(met_m)
        end = Pose(place.x_m, place.y_m, path.heading_at(met_m))
        curve = shortest_curve(pose, end, radius_m)
        missed_m, barely_m = stretch.missed_m(curve, met_m)
        length_m = curve.length_m + _BARELY * barely_m + _TURN_RADII * radius_m * curve.turned_rad
        found.append((max(missed_m - may_miss_m, 0.0), length_m - _EARLY * met_m, curve, met_m))
    _, _, curve, met_m = min(found, key=lambda candidate: candidate[:2])
    return curve, met_m


class _Stretch:
    """The part of a path that an approach may pass over, in short pieces."""

    def __init__(self, path: Path, begin_m: float, end_m: float, near_m: float) -> None:
        length_m = end_m - begin_m
        count = min(max(ceil(length_m / (near_m / 8)), 1), _MAX_SAMPLES)
        self._near_m = near_m
        self._piece_m = length_m / count
        self._middles_m = begin_m + (np.arange(count) + 0.5) * self._piece_m
        places = map(path.point_at, self._middles_m.tolist())
        self._places = np.array([(place.x_m, place.y_m) for place in places])

    def missed_m(self, curve: DubinsCurve, met_m: float) -> tuple[float, float]:
        """Return what a curve never comes near of the path before it meets it, m.

        Returns:
            Its length, and the length of what it comes near enough or not quite.
        """
        places = self._places[self._middles_m < met_m]
        driven = curve.places(max(self._near_m / 8, curve.length_m / _MAX_SAMPLES))
        away = places[:, np.newaxis] - driven[:, :2]
        away_m = np.hypot(away[..., 0], away[..., 1]).min(axis=1)
        missed = np.count_nonzero(away_m > _NEAR_SHARE * self._near_m)
        barely = np.count_nonzero(away_m > _BARELY_SHARE * self._near_m)
        return missed * self._piece_m, barely * self._piece_m


def _joined(curve: DubinsCurve, path: Path, met_m: float, vehicle: VehicleLimits) -> Path:
    """Return a curve continued along the path that it meets, as the vehicle sees it."""
    beyond_m = _BEYOND_M * max(vehicle.scale, 1.0)
    spacing_m = _SPACING_M * min(vehicle.scale, 1.0)
    spacing_m = max(spacing_m, (curve.length_m + beyond_m) / _MAX_SPACINGS)
    rows = curve.places(spacing_m)
    along = np.arange(met_m + spacing_m, met_m + beyond_m, spacing_m)
    onwards = [(place.x_m, place.y_m, 0.0) for place in map(path.point_at, along.tolist())]
    return Path.of_computed(np.concatenate((rows, np.array(onwards)))).for_vehicle(vehicle)
