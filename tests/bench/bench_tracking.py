"""How well both trackers follow the recorded loop, with the vehicle as it is simulated.

The plants and the bounds are those of docs/tracking.md.
"""

import time
from collections.abc import Iterable, Iterator, Mapping

import numpy as np
import pytest

from domain.paths.path import Path
from domain.tracking.trackers import TRACKERS
from domain.vehicle import Pose, VehicleState
from tests.support.bench import Row, quantiles, report
from tests.support.track_study import (
    LIMITS,
    PLANTS,
    accelerations,
    beside_start,
    disturbed,
    drive,
    figures,
    track,
)

pytestmark = pytest.mark.bench

LOOP = "tracks/gem_e2_loop.csv"
LAUNCH = Pose(0.0, 0.0, 0.0)
"""Of the original: 2 m left of the start of the loop."""
FIXTURES = (
    "short_5m",
    "line_21",
    "line_21_offset",
    "line_21_5col",
    "line_21_crlf",
    "line_90deg",
    "line_180deg",
    "overlap_loop",
)
CAPTURE_WITHIN_M = {"ideal": 15, "gazebo-like": 15, "car-like": 20}
SEEDS = (1, 2, 3)


def test_on_the_path() -> None:
    loop = track(LOOP)
    rows = {
        f"{controller}, {plant}": figures(drive(loop, controller, PLANTS[plant]))
        for controller, plant in _pairs()
    }
    report(
        "tracking_on_path",
        "Tracking: on the path",
        "Both trackers on the recorded loop of 835 m at 2.8 m/s, with three vehicles that "
        "respond at once, late, and slowly; errors are those of the middle of the rear axle.",
        rows,
        asked="RMS at most 0.010 m and 0.3°, never more than 0.03 m off.",
    )
    for row in rows.values():
        assert row["done"]
        assert row["rms_m"] <= 0.010
        assert row["max_m"] <= 0.03
        assert row["heading_deg"] <= 0.3


def test_from_two_metres_beside() -> None:
    loop = track(LOOP)
    rows = {}
    for controller, plant in _pairs():
        row = figures(drive(loop, controller, PLANTS[plant], LAUNCH))
        rows[f"{controller}, {plant}"] = row
        assert 0 < row["capture_m"] <= CAPTURE_WITHIN_M[plant]
    report(
        "tracking_from_beside",
        "Tracking: from 2 m beside the path",
        "The same from 2 m beside the path; `capture` is the distance driven until the error is "
        "within 0.1 m, and RMS is taken after that.",
        rows,
        asked=(
            "capture within 15 m, 20 m with the slow vehicle; overshoot at most 0.1 m; then RMS "
            "at most 0.010 m."
        ),
    )
    for row in rows.values():
        assert row["done"]
        assert row["overshoot_m"] <= 0.1
        # After the capture it does not swing.
        assert row["rms_m"] <= 0.010


@pytest.mark.parametrize("start", [None, LAUNCH], ids=["on_path", "beside"])
def test_with_noise_and_delay(start: Pose | None) -> None:
    loop = track(LOOP)
    rows = {
        f"{controller}, {plant}": _worst(
            figures(drive(loop, controller, disturbed(PLANTS[plant], seed), start))
            for seed in SEEDS
        )
        for controller, plant in _pairs()
    }
    report(
        f"tracking_noise_{'beside' if start else 'on_path'}",
        f"Tracking: with noise and delay, {'2 m beside' if start else 'on'} the path",
        "The same with 20 mm and 0.5° of pose noise and 100 ms of delay; the worst of "
        f"{len(SEEDS)} runs.",
        rows,
        asked="RMS at most 0.015 m, never more than 0.06 m off.",
    )
    for row in rows.values():
        assert row["done"]
        assert row["rms_m"] <= 0.015
        assert row["max_m"] <= 0.06


def test_a_fast_lap() -> None:
    loop = track(LOOP)
    rows = {}
    for controller, plant in _pairs():
        record = drive(loop, controller, PLANTS[plant], speed_mps=7.0)
        lateral, longitudinal = accelerations(record)
        rows[f"{controller}, {plant}"] = {
            **figures(record),
            "driven": round(float(record.driven_m[-1]) / loop.length_m, 5),
            "lat_mps2": lateral,
            "lon_mps2": longitudinal,
        }
    report(
        "tracking_fast_lap",
        "Tracking: a fast lap",
        "One lap at up to 7 m/s; the fastest possible lap takes 126.2 s.",
        rows,
        asked=(
            "128 s, RMS at most 0.03 m, at most 2 m/s² lateral and 1 m/s² longitudinal "
            "acceleration, no cut corner."
        ),
    )
    for row in rows.values():
        assert row["done"]
        assert row["time_s"] <= 128
        assert row["rms_m"] <= 0.03
        assert row["lat_mps2"] <= 2
        assert row["lon_mps2"] <= 1
        # No corner is cut.
        assert row["driven"] >= 0.9995


def test_all_fixtures_are_driven_to_their_end() -> None:
    rows = {}
    for name in FIXTURES:
        path = track(f"conformance/polaris/fixtures/{name}.csv")
        for controller in TRACKERS:
            worst = _worst(
                figures(drive(path, controller, plant, beside_start(path, left_m)))
                for plant in PLANTS.values()
                for left_m in (0.0, 0.5, -0.5)
            )
            # How well it was followed says little of paths that end before a vehicle is on them.
            rows[f"{name}, {controller}"] = {
                column: worst[column] for column in ("time_s", "covered", "end_m", "done")
            }
    report(
        "tracking_fixtures",
        "Tracking: other paths",
        "All drivable paths of smart_polaris, from the start and from 0.5 m on either side of it, "
        "with all three vehicles; the worst of each.",
        rows,
        asked="all completed, within 0.3 m.",
    )
    for row in rows.values():
        assert row["done"]
        assert row["covered"] >= 0.95
        assert row["end_m"] <= 0.3


def test_what_a_path_and_a_control_step_cost() -> None:
    loop = track(LOOP)
    along = np.linspace(0, loop.length_m, 100_000)
    places = [loop.point_at(distance) for distance in along.tolist()]
    many = Path(np.array([(place.x_m, place.y_m, 0.0) for place in places]))
    apart = Path(np.column_stack((np.arange(100_000.0), np.zeros(100_000), np.zeros(100_000))))
    rows: dict[str, Row] = {}
    for label, path in {
        "loop, 3,822 points": loop,
        "loop, 100,000 points": many,
        "line, 100,000 points 1 m apart": apart,
    }.items():
        rows[f"path, {label}"] = quantiles([_building(path) for _ in range(11)])
        for controller in TRACKERS:
            rows[f"{controller}, {label}"] = quantiles(list(_steps(path, controller)))
    report(
        "tracking_cost",
        "Tracking: what a path and a control step cost",
        "A path is built 11 times; 5,000 control steps, including projection, run along it, 50 mm "
        "beside it.",
        rows,
        asked="a median of 60 ms for a path and of 0.1 ms for a step.",
    )
    for label, row in rows.items():
        assert row["p50_ms"] < (60 if label.startswith("path") else 0.1)


def _pairs() -> Iterator[tuple[str, str]]:
    """Yield each tracker with each plant."""
    for controller in TRACKERS:
        for plant in PLANTS:
            yield controller, plant


def _worst(rows: Iterable[Mapping[str, float]]) -> Row:
    """Return the largest of each figure; of what should be large, the smallest."""
    all_rows = list(rows)
    return {
        name: (min if name in {"done", "covered"} else max)(row[name] for row in all_rows)
        for name in all_rows[0]
    }


def _building(path: Path) -> float:
    begin = time.perf_counter()
    Path(path.waypoints)
    return time.perf_counter() - begin


def _steps(path: Path, controller: str) -> Iterator[float]:
    """Yield how long control steps take all along a path, 50 mm beside it, s."""
    tracker = TRACKERS[controller](LIMITS)
    for distance in np.linspace(0, path.length_m, 5000).tolist():
        place, index = path.point_at(distance), path.index_after(distance)
        pose = Pose(place.x_m, place.y_m + 0.05, path.heading_at(distance))
        state = VehicleState(pose, 2.8, 0.0)
        begin = time.perf_counter()
        tracker.control_step(state, path, index)
        yield time.perf_counter() - begin
