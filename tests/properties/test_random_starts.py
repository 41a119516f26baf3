"""Any start near any path that can be driven, held at any time: nothing taken is given up."""

import os
from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

from domain.paths.path import Path
from domain.simulation.vehicle_settings import Plant
from domain.snapshot import TaskPhase
from domain.timebase import seconds
from domain.tracking.trackers import TRACKERS
from domain.vehicle import Pose, VehicleLimits
from tests.support.drives import Trip
from tests.support.random_paths import Walk, walks
from tests.support.track_study import PLANTS

SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
EXAMPLES = 2_000 if SOAK else 25

MOST_MPS2 = 2.0 + 1e-6
controllers = st.sampled_from(sorted(TRACKERS))
bends = st.lists(st.tuples(st.floats(-0.12, 0.12), st.floats(4.0, 20.0)), min_size=1, max_size=5)
angles = st.one_of(st.just(0.0), st.just(pi), st.floats(-pi, pi))
timeout = pytest.mark.timeout(0 if SOAK else 120)


SMALL = Plant(3.0, 3.0, 3.2, 0.05)
VEHICLES = st.sampled_from(
    [
        *((VehicleLimits(), plant) for plant in PLANTS.values()),
        *((VehicleLimits(wheelbase_m=0.33), plant) for plant in (Plant(), SMALL)),
        (VehicleLimits(wheelbase_m=1.0, max_steering_angle_rad=0.45), PLANTS["gazebo-like"]),
        (VehicleLimits(wheelbase_m=3.0, max_steering_angle_rad=0.7), PLANTS["gazebo-like"]),
    ]
)


def winding(pieces: list[tuple[float, float]], scale: float = 1.0) -> Path:
    """Return a path of arcs that begins eastwards at the origin.

    Args:
        pieces: Curvature, 1/m, and length, m, of each arc.
        scale: By which all is larger.
    """
    rows = np.zeros((1, 3))
    for curvature, length in pieces:
        count = round(length / 0.25)
        yaw = rows[-1, 2] + curvature * 0.25 * (np.arange(count) + 0.5)
        steps = 0.25 * scale * np.column_stack((np.cos(yaw), np.sin(yaw)))
        places = rows[-1, :2] + np.cumsum(steps, axis=0)
        rows = np.concatenate((rows, np.column_stack((places, yaw))))
    return Path(rows)


@settings(max_examples=EXAMPLES)
@timeout
@given(
    bends,
    controllers,
    VEHICLES,
    st.floats(0, 5),
    angles,
    angles,
    st.floats(0.5, 8.0),
)
def test_every_start_within_5_m_and_any_turn_leads_onto_the_path_and_to_its_end(
    pieces: list[tuple[float, float]],
    controller: str,
    vehicle: tuple[VehicleLimits, Plant],
    away_m: float,
    bearing_rad: float,
    yaw_rad: float,
    speed_mps: float,
) -> None:
    start = Pose(away_m * cos(bearing_rad), away_m * sin(bearing_rad), yaw_rad)
    limits, plant = vehicle
    trip = Trip(winding(pieces, limits.scale), controller, speed_mps, plant, start, limits)
    trip.drive(3_000.0)

    event(str(trip.robot.task.status))
    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason
    assert trip.lateral_mps2() <= MOST_MPS2


@settings(max_examples=EXAMPLES)
@timeout
@given(
    bends,
    controllers,
    st.sampled_from(sorted(PLANTS)),
    st.sampled_from([0.05, 0.2, 0.5, 1.0, 3.0]),
    st.floats(0.5, 8.0),
    st.lists(st.tuples(st.floats(0.0, 12.0), st.sampled_from([0.0, 1.0, 600.0])), max_size=5),
)
def test_no_number_of_holds_adds_up_to_an_abort(
    pieces: list[tuple[float, float]],
    controller: str,
    kind: str,
    braking_mps2: float,
    speed_mps: float,
    holds: list[tuple[float, float]],
) -> None:
    known = PLANTS[kind]
    plant = Plant(
        known.acceleration_mps2, braking_mps2, known.steering_rate_radps, known.steering_lag_s
    )
    trip = Trip(winding(pieces), controller, speed_mps, plant)
    for after_s, for_s in holds:
        trip.drive(after_s)
        trip.hold(for_s)
    trip.drive()

    assert trip.robot.task.status is TaskPhase.SUCCEEDED, trip.robot.task.reason


@settings(max_examples=EXAMPLES)
@timeout
@given(
    walks(),
    controllers,
    st.sampled_from([0.33, 1.0, 1.75, 3.0]),
    st.sampled_from([None, 0.05, 0.2, 0.5, 1.5]),
    st.sampled_from([0.0, 0.1, 0.3]),
    st.sampled_from([0.0, 0.05, 0.2]),
    st.floats(0.5, 11.0),
)
def test_nothing_commanded_exceeds_the_lateral_acceleration_on_any_path(
    walk: Walk,
    controller: str,
    wheelbase_m: float,
    rate_radps: float | None,
    lag_s: float,
    delay_s: float,
    speed_mps: float,
) -> None:
    plant = Plant(2.0, 3.0, rate_radps, lag_s, delay=seconds(delay_s))
    path = Path(walk.waypoints(60.0))
    limits = VehicleLimits(wheelbase_m=wheelbase_m)
    trip = Trip(path, controller, speed_mps, plant, limits=limits)
    trip.drive(60.0)

    if trip.looks:
        assert trip.lateral_mps2() <= MOST_MPS2
