"""What driving costs: a path of 100,000 waypoints, and an hour in virtual time."""

import json
import pickle
import time
from collections.abc import Callable

import pytest

from api.simulation.simulation_job import simulate_posted
from domain.paths.path import Path
from domain.paths.speed_profile import SpeedLimits, SpeedProfile
from tests.support.bench import Row, quantiles, report
from tests.support.drive_loads import dense, hour
from tests.support.http_robot import ACTUATION
from tests.support.track_study import LIMITS, track

pytestmark = pytest.mark.bench

LOOP = "tracks/gem_e2_loop.csv"
ROUNDS = 11


def test_what_a_long_path_costs() -> None:
    waypoints = dense(track(LOOP))
    path = Path(waypoints)
    pickled = pickle.dumps(path)
    work: dict[str, Callable[[], object]] = {
        "making a Path": lambda: Path(waypoints),
        "pickling it": lambda: pickle.dumps(path),
        "unpickling it": lambda: pickle.loads(pickled),
        "its SpeedProfile": lambda: SpeedProfile(path, 2.8, SpeedLimits(), LIMITS),
    }
    report(
        "drive_long_path",
        "A path of 100,000 waypoints",
        f"Time to build a path and to hand it to another process, {ROUNDS} times each.",
        {name: quantiles(_seconds(each, ROUNDS)) for name, each in work.items()},
    )


def test_an_hour_in_virtual_time() -> None:
    raw = hour()
    answers: list[bytes] = []
    took = _seconds(lambda: answers.append(simulate_posted(raw, ACTUATION, None)), 2)
    samples = json.loads(answers[0])["samples"]
    driven = sum(sample["task"] is not None for sample in samples)
    rows: dict[str, Row] = {
        "an hour": {
            "best_s": round(min(took), 2),
            "worst_s": round(max(took), 2),
            "driven_s": driven,
            "megabytes": round(len(answers[0]) / 1e6, 2),
            "identical": float(answers[0] == answers[1]),
        }
    }
    report(
        "drive_hour",
        "An hour in virtual time",
        "Time that `POST /simulations` takes for an hour of the example robot with a drive of 5 "
        "minutes, and whether two runs give identical bytes.",
        rows,
        asked="less than 5 s.",
    )
    assert answers[0] == answers[1]
    assert 280 < driven < 320
    assert min(took) < 5


def _seconds(work: Callable[[], object], rounds: int) -> list[float]:
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return times
