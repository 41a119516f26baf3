import importlib.util
from functools import cache
from math import hypot
from pathlib import Path as FilePath
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from pydantic_core import from_json

from api.http.schemas.simulation import SimulationBody
from api.simulation.simulation import Simulation
from api.simulation.simulation_job import robot_for
from domain.paths.path import Path
from domain.vehicle import VehicleLimits
from service.example_tracks import track_text
from service.files.waypoint_file import read_waypoints_csv
from tests.support.shared import PROJECT

FOLDER = PROJECT / "examples" / "tracks"
NAMES = ("loop", "overlap", "short_5m", "right_angle", "out_and_back")
GOOD = {
    "battery_level": 1.0,
    "estop": False,
    "gps_accuracy": 100,
    "signal_strength": "CONNECTED",
    "temperature": 40,
}


@cache
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_tracks", FOLDER / "make_tracks.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@cache
def track(name: str) -> Path:
    return Path(read_waypoints_csv((FOLDER / f"{name}.csv").read_text(encoding="utf-8")))


def tightest_radius(path: Path) -> float:
    curvatures = path.curvatures_at(np.arange(0.0, path.length_m, 0.1))
    return float(1 / max(np.abs(curvatures).max(), 1e-9))


def drive(path: Path, controller: str) -> Any:  # noqa: ANN401
    """Return the task at the end of a simulated drive."""
    waypoints = [{"x_m": x, "y_m": y, "yaw_rad": yaw} for x, y, yaw in path.waypoints.tolist()]
    until_s = path.length_m / 2 + 20
    body = SimulationBody.model_validate(
        {
            "robot": {"signals": {"stale_after_s": 0}},
            "until_s": until_s,
            "sample_period_s": until_s,
            "steps": [
                {"t_s": 0, "reading": GOOD},
                {"t_s": 0, "task": {"waypoints": waypoints, "controller": controller}},
                {"t_s": until_s, "expect": {"last_task": {"status": "SUCCEEDED"}}},
            ],
        }
    )
    simulation = Simulation(body, robot_for(body, "", None))
    simulation.run()
    return from_json(simulation.as_json())


def test_the_script_gives_exactly_the_files_that_are_here() -> None:
    made: dict[FilePath, str] = dict(script().files())

    assert sorted(made) == sorted([*FOLDER.glob("*.csv"), script().BUILT_IN])
    assert {path: path.read_text(encoding="utf-8") for path in made} == made


def test_the_built_in_loop_is_that_of_the_folder_and_small() -> None:
    text = (FOLDER / "loop.csv").read_text(encoding="utf-8")

    assert track_text("loop") == text
    assert len(text) < 120_000


@pytest.mark.parametrize("name", NAMES)
def test_a_track_begins_where_the_example_vehicle_stands_and_looks(name: str) -> None:
    path = track(name)

    assert path.waypoints[0].tolist() == [0.0, 0.0, 0.0]
    assert path.heading_at(0.5) == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("name", [name for name in NAMES if name != "right_angle"])
def test_the_example_vehicle_can_steer_a_track(name: str) -> None:
    limits = VehicleLimits()
    least_m = limits.wheelbase_m / np.tan(limits.max_steering_angle_rad)

    assert tightest_radius(track(name)) > max(4.0, least_m)


@pytest.mark.parametrize("name", NAMES)
def test_the_spacing_is_that_of_a_recording(name: str) -> None:
    steps = np.hypot(*np.diff(track(name).waypoints[:, :2], axis=0).T)

    assert steps.min() > 0.2
    assert steps.max() < 0.51


@pytest.mark.parametrize("name", NAMES)
def test_the_headings_are_those_of_the_way(name: str) -> None:
    path = track(name)
    steps = np.diff(path.waypoints[:, :2], axis=0)
    off = np.arctan2(steps[:, 1], steps[:, 0]) - path.waypoints[:-1, 2]

    assert np.abs((off + np.pi) % (2 * np.pi) - np.pi).max() < 0.05


def test_the_loop_is_a_lap_of_800_m_without_tight_curves_or_jumps_of_curvature() -> None:
    path = track("loop")
    end = path.waypoints[-1].tolist()
    bends = path.curvatures_at(np.arange(0.0, path.length_m, 1.0))

    assert path.length_m == pytest.approx(799.5, abs=0.1)
    assert hypot(end[0] + 0.5, end[1]) < 0.01
    assert tightest_radius(path) > 37
    assert np.abs(np.diff(bends)).max() < 0.005


def test_the_overlap_ends_3_m_behind_its_own_start() -> None:
    path = track("overlap")
    x_m, y_m, _ = path.waypoints[-1].tolist()

    assert (x_m, y_m) == (pytest.approx(3.0, abs=0.5), pytest.approx(0.0, abs=0.01))
    assert path.length_m > 100


def test_the_right_angle_turns_at_one_place() -> None:
    assert set(track("right_angle").waypoints[:, 2].tolist()) == {0.0, 1.5708}


def test_out_and_back_comes_back_beside_the_way_out() -> None:
    x_m, y_m, yaw_rad = track("out_and_back").waypoints[-1].tolist()

    assert abs(yaw_rad) == pytest.approx(np.pi, abs=0.01)
    assert hypot(x_m, y_m) < 5


@pytest.mark.parametrize("controller", ["pure_pursuit", "stanley"])
@pytest.mark.parametrize("name", NAMES)
def test_both_trackers_drive_a_track_to_its_end(name: str, controller: str) -> None:
    answer = drive(track(name), controller)

    assert answer["refusals"] == []
    assert answer["expectations"][0]["differences"] == []
