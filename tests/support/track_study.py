"""Drives paths with the product's navigation and simulated vehicle, and says how well.

Errors are measured here anew: from the real rear axle, without noise, to the line through all
waypoints as they were recorded; not as the trackers themselves see them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import cos, degrees, hypot, pi, radians, sin

import numpy as np
from numpy.typing import NDArray

from domain.commands import Drive, SendGoal
from domain.identifiers import GoalId
from domain.inputs import GoalFeedback, GoalResult
from domain.navigation import Navigation, NavigationSettings
from domain.outbox import Outbox
from domain.paths.path import Path
from domain.simulation.vehicle import SimulatedVehicle
from domain.simulation.vehicle_settings import Noise, Plant, VehicleSettings
from domain.tasks.settings import TaskSettings
from domain.tasks.vehicle_watch import VehicleWatch
from domain.timebase import seconds, to_seconds
from domain.vehicle import DriveCommand, Pose, VehicleLimits, VehicleState
from tests.support.shared import shared_folder

LIMITS = VehicleLimits()

PLANTS: Mapping[str, Plant] = {
    "ideal": Plant(),
    "gazebo-like": Plant(2.0, 2.0, 0.5, 0.15),
    "car-like": Plant(1.0, 1.0, 0.11, 0.2),
}
"""The plants of docs/tracking.md."""

CAPTURED_M = 0.1
"""Nearer than this a vehicle is on its path."""

_WINDOW_M = 6.0
_STANDING_M = 1e-3
"""Segments shorter than this were recorded at standstill and lead nowhere."""


@dataclass(frozen=True, slots=True)
class Record:
    """One drive, a row per report of the vehicle."""

    path: Path
    time_s: NDArray[np.float64]
    pose: NDArray[np.float64]
    """Shape (n, 3): x m, y m, yaw rad, as they really are."""
    steering_rad: NDArray[np.float64]
    driven_m: NDArray[np.float64]
    distance_m: NDArray[np.float64]
    """Along the path, as the tracker sees it."""
    target_index: NDArray[np.int64]
    commanded_rad: NDArray[np.float64]
    result: GoalResult | None
    """None: it was still on its way when the time was up."""


@dataclass(frozen=True, slots=True)
class Errors:
    """How far off a vehicle was, a number per row of a record."""

    cross_track_m: NDArray[np.float64]
    heading_rad: NDArray[np.float64]


def track(name: str) -> Path:
    """Return a file of the shared tracks or fixtures as a path.

    Args:
        name: Below the shared folder, as in `tracks/gem_e2_loop.csv`.
    """
    folder, _, file = name.rpartition("/")
    rows = np.loadtxt(shared_folder(folder) / file, delimiter=",", usecols=(0, 1, 2))
    return Path(rows)


def disturbed(plant: Plant, seed: int) -> Plant:
    """Return a plant that hears 100 ms late, with 20 mm and 0.5 degrees of noise in its pose."""
    return replace(plant, delay=seconds(0.1), noise=Noise(0.02, radians(0.5), seed=seed))


def limits_of(plant: Plant, limits: VehicleLimits = LIMITS) -> VehicleLimits:
    """Return limits with what is known of a plant, as a robot file tells it."""
    return replace(
        limits,
        braking_mps2=plant.braking_mps2,
        steering_rate_radps=plant.steering_rate_radps,
        steering_delay_s=plant.steering_lag_s + to_seconds(plant.delay),
    )


def beside_start(path: Path, left_m: float) -> Pose:
    """Return the pose beside the start of a path, along it."""
    place, heading = path.point_at(0.0), path.heading_at(0.0)
    return Pose(place.x_m - left_m * sin(heading), place.y_m + left_m * cos(heading), heading)


def drive(
    path: Path,
    controller: str,
    plant: Plant,
    start: Pose | None = None,
    speed_mps: float = 2.8,
    time_limit_s: float = 400.0,
) -> Record:
    """Follow a path from a standstill until the vehicle stands again.

    Args:
        path: What is followed.
        controller: Name of a tracker.
        plant: How the vehicle responds.
        start: Where it begins; None: on the path.
        speed_mps: Speed where nothing else limits it.
        time_limit_s: When to give up.
    """
    vehicle = SimulatedVehicle(VehicleSettings(start or beside_start(path, 0.0), plant, LIMITS), 0)
    watch = VehicleWatch(TaskSettings(), Outbox())
    navigation = Navigation(limits_of(plant), NavigationSettings(), watch)
    rows: list[tuple[float, ...]] = []
    result, feedback, driven, before = None, None, 0.0, vehicle.state
    while to_seconds(now := vehicle.wake_at()) <= time_limit_s:
        for report in vehicle.advance(now):
            watch.take(report, now)
        state = vehicle.state
        driven += hypot(state.pose.x_m - before.pose.x_m, state.pose.y_m - before.pose.y_m)
        before = state
        if not rows:
            navigation.handle(SendGoal(GoalId(1), path, 0, 0, controller, speed_mps), now)
        for message in navigation.advance(now):
            match message:
                case Drive():
                    vehicle.drive(message.command, now)
                case GoalFeedback():
                    feedback = message
                case GoalResult():
                    result = message
                    vehicle.drive(DriveCommand(0.0, state.steering_angle_rad), now)
        if feedback is not None:
            rows.append(_row(to_seconds(now), state, driven, feedback))
        if result is not None and state.speed_mps == 0.0:
            break
    return _record(path, rows, result)


def _row(
    now_s: float, state: VehicleState, driven_m: float, feedback: GoalFeedback
) -> tuple[float, ...]:
    pose = state.pose
    return (
        now_s,
        pose.x_m,
        pose.y_m,
        pose.yaw_rad,
        state.steering_angle_rad,
        driven_m,
        feedback.distance_m,
        feedback.target_index,
        0.0 if feedback.command is None else feedback.command.steering_angle_rad,
    )


def _record(path: Path, rows: list[tuple[float, ...]], result: GoalResult | None) -> Record:
    columns = np.array(rows).T
    return Record(
        path,
        time_s=columns[0],
        pose=columns[1:4].T,
        steering_rad=columns[4],
        driven_m=columns[5],
        distance_m=columns[6],
        target_index=columns[7].astype(np.int64),
        commanded_rad=columns[8],
        result=result,
    )


def errors(record: Record) -> Errors:
    """Measure a drive against the recorded waypoints, near where the tracker was along them."""
    places = record.path.waypoints[:, :2]
    steps = np.diff(places, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    along = np.concatenate(([0.0], np.cumsum(lengths)))
    moved = np.flatnonzero(lengths > min(_STANDING_M, lengths.max() / 2))
    begins, ways = places[moved], steps[moved] / lengths[moved, np.newaxis]
    near = along[record.target_index]
    first = np.searchsorted(along[moved + 1], near - _WINDOW_M)
    last = np.searchsorted(along[moved], near + _WINDOW_M)
    measured = np.array(
        [
            _error(pose, begins[a:b], ways[a:b], lengths[moved[a:b]])
            for pose, a, b in zip(record.pose, first, last, strict=True)
        ]
    )
    return Errors(measured[:, 0], measured[:, 1])


def _error(
    pose: NDArray[np.float64],
    begins: NDArray[np.float64],
    ways: NDArray[np.float64],
    lengths: NDArray[np.float64],
) -> tuple[float, float]:
    """Return the distance from the nearest segment, left positive, m, and the heading error."""
    to = pose[:2] - begins
    inside = np.clip((to * ways).sum(axis=1), 0, lengths)
    gaps = to - ways * inside[:, np.newaxis]
    far = np.hypot(gaps[:, 0], gaps[:, 1])
    k = int(far.argmin())
    side = ways[k, 0] * to[k, 1] - ways[k, 1] * to[k, 0]
    heading = float(np.arctan2(ways[k, 1], ways[k, 0]))
    return float(np.copysign(far[k], side)), (pose[2] - heading + pi) % (2 * pi) - pi


def accelerations(record: Record) -> tuple[float, float]:
    """Return the largest lateral and the largest longitudinal acceleration, m/s2."""
    periods = np.diff(record.time_s)
    speed = np.diff(record.driven_m) / periods
    lateral = speed**2 * np.tan(record.steering_rad[1:]) / LIMITS.wheelbase_m
    longitudinal = np.diff(speed) / periods[1:]
    return round(float(np.abs(lateral).max()), 3), round(float(np.abs(longitudinal).max()), 3)


def figures(record: Record) -> dict[str, float]:
    """Return what counts of one drive.

    Of one that begins off its path, capture is how far the vehicle drove until it was within 0.1 m
    for good, all of its way if it never was; the errors are those from 10 m after that; overshoot
    is how far it came to the other side. Of one that begins on it, all errors count.
    """
    found = errors(record)
    size, last = np.abs(found.cross_track_m), len(record.driven_m) - 1
    capture, first, overshoot = 0.0, 0, 0.0
    if size[0] >= CAPTURED_M:
        capture = record.driven_m[min(np.flatnonzero(size >= CAPTURED_M)[-1] + 1, last)]
        first = min(int(np.searchsorted(record.driven_m, capture + 10)), last)
        other_side = -found.cross_track_m * np.sign(found.cross_track_m[0])
        overshoot = max(float(other_side.max()), 0.0)
    end = record.path.waypoint(record.path.count - 1)
    rest = record.pose[-1]
    return {
        "rms_m": _rms(found.cross_track_m[first:]),
        "max_m": round(float(size[first:].max()), 4),
        "heading_deg": round(degrees(_rms(found.heading_rad[first:])), 2),
        "capture_m": round(float(capture), 1),
        "overshoot_m": round(overshoot, 3),
        "time_s": round(float(record.time_s[-1]), 2),
        "covered": round(float(record.distance_m[-1]) / record.path.length_m, 3),
        "end_m": round(hypot(rest[0] - end.x_m, rest[1] - end.y_m), 3),
        "done": float(record.result is not None and record.result.succeeded),
    }


def _rms(values: NDArray[np.float64]) -> float:
    return round(float(np.sqrt((values**2).mean())), 5)
