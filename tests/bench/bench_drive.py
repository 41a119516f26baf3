"""What driving costs, and what else goes on meanwhile must not cost it.

Times of several processes are compared: `time.perf_counter` is one clock for all of a machine.
"""

import asyncio
import io
import json
import pickle
import random
import signal
import sys
import time
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path as FilePath
from typing import Any

import httpx
import numpy as np
import pytest
from numpy.typing import NDArray

from api.simulation.posted import simulate_posted
from domain.paths.path import Path
from domain.paths.speed_profile import SpeedLimits, SpeedProfile
from domain.tracking.trackers import TRACKERS
from domain.vehicle import Pose, VehicleState
from service.example_tracks import track_text
from tests.support.bench import Row, quantiles, report
from tests.support.good import GOOD
from tests.support.http_robot import ACTUATION
from tests.support.process import ServiceProcess, connect, service
from tests.support.track_study import LIMITS, track

pytestmark = pytest.mark.bench

ROUNDS = 300
ORIGINAL_P99_MS = 95.0
"""Of smart_polaris, by design: the result of a Monte Carlo study, not a measurement."""

POINTS = 100_000
PERIOD_S = 0.05
MINUTE_S = 60.0
UPLOADS = 20
HOUR_S = 3_600

ROBOT = "signals: {estop: {min_on_s: 0}}\n"
"""An error that ends at once, so that more of them fit into a minute."""

RECORDING = """\
import json, sys, time
from api import command_line, serving
from domain.messages import Drive
from service.backends.simulated import SimulatedBackend

path, found = sys.argv.pop(1), {"drives": [], "ticks": []}

class Recording(SimulatedBackend):
    def send(self, command):
        super().send(command)
        if isinstance(command, Drive):
            found["drives"].append((time.perf_counter(), command.command.speed_mps))

compose = serving.compose

def compose_recording(options, clock):
    supervisor = compose(options, clock)
    supervisor.on_tick.append(lambda _: found["ticks"].append(time.perf_counter()))
    return supervisor

serving.SimulatedBackend, serving.compose = Recording, compose_recording
code = command_line.main()
json.dump(found, open(path, "w"))
raise SystemExit(code)
"""

BARE = """\
import asyncio, json, sys, time
import uvloop

async def tick(count):
    times, start = [], time.perf_counter()
    for number in range(count):
        while (left := start + number * 0.05 - time.perf_counter()) > 0:
            await asyncio.sleep(max(left, 0.001))
        times.append(time.perf_counter())
    return times

with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
    json.dump(runner.run(tick(int(sys.argv[1]))), sys.stdout)
"""

POSTING = """\
import http.client, json, sys, time

host, every_s, count, *posts = sys.argv[1:]
done, begin = [], time.perf_counter()
for number in range(int(count)):
    path, kind, file = posts[number % (len(posts) // 3) * 3 :][:3]
    body = open(file, "rb").read()
    time.sleep(max(0.0, begin + number * float(every_s) - time.perf_counter()))
    start = time.perf_counter()
    connection = http.client.HTTPConnection(host)
    connection.request("POST", path, body, {"Content-Type": kind})
    answer = connection.getresponse()
    size = len(answer.read())
    done.append((kind, answer.status, size, time.perf_counter() - start))
    connection.close()
json.dump(done, sys.stdout)
"""
"""In a process of its own, so that who measures frames only reads."""


@dataclass(frozen=True, slots=True)
class Watched:
    """What a client saw while it followed the stream."""

    window: tuple[float, float]
    arrivals: list[float] = field(default_factory=list)
    tasks: list[dict[str, Any]] = field(default_factory=list)
    bare: list[float] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Posts:
    """What is posted meanwhile: path, content type and file, in turn."""

    items: Sequence[tuple[str, str, FilePath]]
    every_s: float
    count: int


class DrivingService:
    """A service whose vehicle drives the loop, and what it did."""

    def __init__(self, process: ServiceProcess, http: httpx.AsyncClient, record: FilePath) -> None:
        self.process = process
        self.http = http
        self._record = record

    async def watch(self, seconds: float, posts: Posts | None = None) -> tuple[Watched, list[Any]]:
        """Follow the stream, with a bare loop beside it, and return what was posted as well."""
        async with connect(f"{self.process.stream_url}?topics=task") as client:
            await client.recv()
            bare = await _python(BARE, str(round(seconds / PERIOD_S)))
            posting = None if posts is None else await self._post(posts)
            begin = time.perf_counter()
            seen = Watched((begin, begin + seconds))
            while time.perf_counter() < begin + seconds:
                frame = json.loads(await client.recv())
                if frame["type"] == "state":
                    seen.arrivals.append(time.perf_counter())
                    if frame.get("task"):
                        seen.tasks.append(frame["task"])
            seen.bare.extend(json.loads((await bare.communicate())[0]))
            done = [] if posting is None else json.loads((await posting.communicate())[0])
        return seen, done

    async def _post(self, posts: Posts) -> asyncio.subprocess.Process:
        words = [str(word) for item in posts.items for word in item]
        host = self.process.url.removeprefix("http://")
        return await _python(POSTING, host, str(posts.every_s), str(posts.count), *words)

    def end(self) -> dict[str, list[Any]]:
        """End it, and return when it ticked and what it told the vehicle."""
        self.process.send_signal(signal.SIGTERM)
        self.process.ended()
        found: dict[str, list[Any]] = json.loads(self._record.read_text())
        return found


@asynccontextmanager
async def driving(folder: FilePath) -> AsyncIterator[DrivingService]:
    """Serve a robot that drives the loop at 2.8 m/s, 5 minutes long."""
    script, record, robot = folder / "recording.py", folder / "record.json", folder / "robot.yaml"
    script.write_text(RECORDING)
    robot.write_text(ROBOT)
    command = (sys.executable, str(script), str(record))
    with service("--robot", str(robot), command=command) as process:
        async with httpx.AsyncClient(base_url=process.url, timeout=20) as http:
            kind = {"Content-Type": "text/csv"}
            answer = await http.post("/tasks", content=track_text("loop"), headers=kind)
            assert answer.status_code == httpx.codes.CREATED, answer.text
            await asyncio.sleep(2)
            yield DrivingService(process, http, record)


async def test_a_bad_reading_stops_the_vehicle(tmp_path: FilePath) -> None:
    chance = random.Random(1)
    asked, answered, control = [], [], []
    async with driving(tmp_path) as robot:

        async def timed(method: str, path: str, body: object = None) -> tuple[float, float]:
            begin = time.perf_counter()
            answer = await robot.http.request(method, path, json=body)
            took = time.perf_counter() - begin
            assert answer.status_code == httpx.codes.OK, answer.text
            return begin, took

        for _ in range(ROUNDS):
            # Anywhere between two ticks, and long enough after the release to drive again.
            await asyncio.sleep(0.15 + 0.05 * chance.random())
            control.append((await timed("GET", "/livez"))[1])
            begin, took = await timed("POST", "/signals/estop", {"value": True})
            asked.append(begin)
            answered.append(took)
            await timed("POST", "/signals/estop", {"value": False})
        drives = robot.end()["drives"]
    times = [at for at, _ in drives]
    zeros = [at for at, speed in drives if speed == 0]
    taken = []
    for begin in asked:
        before = int(np.searchsorted(times, begin)) - 1
        assert drives[before][1] > 0, "it did not drive"
        taken.append(zeros[int(np.searchsorted(zeros, begin))] - begin)
    rows: dict[str, Row] = {
        "reading to speed 0 at the vehicle": quantiles(taken),
        "reading to answer": quantiles(answered),
        "GET /livez to answer (control)": quantiles(control),
        "smart_polaris, by design (constant)": {"p99_ms": ORIGINAL_P99_MS},
    }
    report("drive_stop", rows)
    assert rows["reading to speed 0 at the vehicle"]["p99_ms"] <= 10


def test_what_a_control_step_costs() -> None:
    rows: dict[str, Row] = {}
    for label, path in {"3,822 points": _loop(), "100,000 points": Path(_dense())}.items():
        for controller in TRACKERS:
            rows[f"{controller}, {label}"] = _microseconds(_steps(path, controller))
    report("drive_control_step", rows)
    for row in rows.values():
        assert row["p99_us"] < 100


def test_what_a_long_path_costs() -> None:
    dense = _dense()
    path = Path(dense)
    pickled = pickle.dumps(path)
    rows: dict[str, Row] = {
        "making a Path": _cost(lambda: Path(dense)),
        "pickling it": _cost(lambda: pickle.dumps(path)),
        "unpickling it": _cost(lambda: pickle.loads(pickled)),
        "its SpeedProfile": _cost(lambda: SpeedProfile(path, 2.8, SpeedLimits(), LIMITS)),
    }
    report("drive_long_path", rows)


@pytest.mark.timeout(200)
async def test_uploads_disturb_neither_the_frames_nor_the_drive(tmp_path: FilePath) -> None:
    as_csv, as_json = _uploads(tmp_path)
    previews = [
        ("/tasks/preview", "application/json", as_json),
        ("/tasks/preview", "text/csv", as_csv),
    ]
    async with driving(tmp_path) as robot:
        idle, _ = await robot.watch(MINUTE_S / 2)
        busy, done = await robot.watch(MINUTE_S, Posts(previews, MINUTE_S / UPLOADS, UPLOADS))
        last = Posts([("/tasks", "application/json", as_json)], 0, 1)
        served, (task,) = await robot.watch(5, last)
        found = robot.end()
    rows = _periods({"idle": idle, "20 uploads": busy, "a task of 100,000": served}, found)
    for kind in ("application/json", "text/csv"):
        rows[f"preview, {kind}"] = quantiles([took for k, _, _, took in done if k == kind])
    rows["task, application/json"] = quantiles([task[3]])
    rows["cross-track error, idle"] = _errors_of(idle)
    rows["cross-track error, 20 uploads"] = _errors_of(busy)
    report("drive_uploads", rows)
    assert [status for _, status, _, _ in done] == [httpx.codes.OK] * UPLOADS
    assert task[1] == httpx.codes.CREATED
    for seen in (idle, busy):
        _assert_it_went_on(seen)
    assert served.tasks[-1]["waypoint_count"] == POINTS
    assert rows["20 uploads, tick at the server"]["p99_ms"] < 5
    assert rows["20 uploads, frame at a client"]["p99_ms"] < 5


@pytest.mark.timeout(200)
async def test_a_simulation_disturbs_neither_the_frames_nor_the_drive(tmp_path: FilePath) -> None:
    scenario = tmp_path / "hour.json"
    scenario.write_bytes(_hour())
    async with driving(tmp_path) as robot:
        idle, _ = await robot.watch(MINUTE_S / 2)
        posts = Posts([("/simulations", "application/json", scenario)], 0, 4)
        busy, done = await robot.watch(MINUTE_S / 2, posts)
        found = robot.end()
    rows = _periods({"idle": idle, "simulations": busy}, found)
    rows["an hour, with the answer"] = {
        **quantiles([took for _, _, _, took in done]),
        "megabytes": round(done[0][2] / 1e6, 2),
    }
    report("drive_simulations", rows)
    assert [status for _, status, _, _ in done] == [httpx.codes.OK] * 4
    _assert_it_went_on(idle)
    _assert_it_went_on(busy)
    assert rows["simulations, tick at the server"]["p99_ms"] < 5
    assert rows["simulations, frame at a client"]["p99_ms"] < 5


def test_an_hour_in_virtual_time() -> None:
    raw = _hour()
    answers, took = [], []
    for _ in range(2):
        begin = time.perf_counter()
        answers.append(simulate_posted(raw, ACTUATION, None))
        took.append(time.perf_counter() - begin)
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
    report("drive_hour", rows)
    assert answers[0] == answers[1]
    assert 280 < driven < 320
    assert min(took) < 5


def _loop() -> Path:
    return track("tracks/gem_e2_loop.csv")


def _dense() -> NDArray[np.float64]:
    """Return the loop with 100,000 waypoints, shape (100,000, 3)."""
    loop = _loop()
    along = np.linspace(0, loop.length_m, POINTS).tolist()
    places = [loop.point_at(distance) for distance in along]
    yaws = [loop.heading_at(distance) for distance in along]
    return np.array([(p.x_m, p.y_m, yaw) for p, yaw in zip(places, yaws, strict=True)])


def _uploads(folder: FilePath) -> tuple[FilePath, FilePath]:
    """Write the loop with 100,000 waypoints as CSV and as JSON."""
    as_csv, as_json = folder / "dense.csv", folder / "dense.json"
    rows, text = _dense(), io.StringIO()
    np.savetxt(text, rows, "%.9g", ",")
    as_csv.write_text(text.getvalue())
    items = [{"x_m": x, "y_m": y, "yaw_rad": yaw} for x, y, yaw in rows.tolist()]
    as_json.write_text(json.dumps({"waypoints": items}))
    return as_csv, as_json


def _hour() -> bytes:
    """Return a scenario: an hour, in which a drive of 5 minutes begins at once."""
    loop = [
        {"x_m": x, "y_m": y, "yaw_rad": yaw}
        for x, y, yaw in np.loadtxt(io.StringIO(track_text("loop")), delimiter=",")[:, :3].tolist()
    ]
    steps = [{"t_s": 0, "reading": dict(GOOD)}, {"t_s": 0.5, "task": {"waypoints": loop}}]
    robot = {"signals": {"stale_after_s": 0}}
    body = {"robot": robot, "until_s": HOUR_S, "sample_period_s": 1, "steps": steps}
    return json.dumps(body).encode()


def _steps(path: Path, controller: str) -> list[float]:
    """Return how long control steps take all along a path, 50 mm beside it, s."""
    tracker = TRACKERS[controller](LIMITS)
    took = []
    for distance in np.linspace(0, path.length_m, 10_000).tolist():
        place, index = path.point_at(distance), path.index_after(distance)
        state = VehicleState(Pose(place.x_m, place.y_m + 0.05, path.heading_at(distance)), 2.8, 0.0)
        begin = time.perf_counter()
        tracker.control_step(state, path, index)
        took.append(time.perf_counter() - begin)
    return took


def _microseconds(times: Sequence[float]) -> dict[str, float]:
    found = quantiles([1000 * each for each in times])
    return {name.replace("_ms", "_us"): value for name, value in found.items()}


def _cost(work: Callable[[], object]) -> dict[str, float]:
    times = []
    for _ in range(11):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return quantiles(times)


def _periods(watched: dict[str, Watched], found: dict[str, list[Any]]) -> dict[str, Row]:
    """Return how far periods were from 50 ms: of a bare loop, at the server, and at the client."""
    rows: dict[str, Row] = {}
    for label, seen in watched.items():
        begin, end = seen.window
        ticks = [at for at in found["ticks"] if begin <= at <= end]
        rows[f"{label}, bare loop"] = _errors(seen.bare)
        rows[f"{label}, tick at the server"] = {**_errors(ticks), "ticks": len(ticks)}
        rows[f"{label}, frame at a client"] = _errors(seen.arrivals)
    return rows


def _errors(times: Sequence[float]) -> dict[str, float]:
    return quantiles([abs(after - before - PERIOD_S) for before, after in pairwise(times)])


def _errors_of(seen: Watched) -> Row:
    """Return the largest cross-track error, and how far the vehicle came, m."""
    size = [abs(task["cross_track_error_m"]) for task in seen.tasks]
    driven = seen.tasks[-1]["distance_m"] - seen.tasks[0]["distance_m"]
    return {"max_m": round(max(size), 4), "driven_m": round(driven, 1)}


def _assert_it_went_on(seen: Watched) -> None:
    """Assert that the same task ran, on its path and at its speed."""
    first, last = seen.tasks[0], seen.tasks[-1]
    assert {(task["id"], task["status"]) for task in seen.tasks} == {(first["id"], "RUNNING")}
    indexes = [task["target_index"] for task in seen.tasks]
    assert indexes == sorted(indexes)
    lasted_s = seen.arrivals[-1] - seen.arrivals[0]
    assert (last["distance_m"] - first["distance_m"]) / lasted_s == pytest.approx(2.8, abs=0.3)
    assert max(abs(task["cross_track_error_m"]) for task in seen.tasks) < 0.1


async def _python(script: str, *arguments: str) -> asyncio.subprocess.Process:
    """Run a script in a process of its own, whose output is read once it has ended."""
    return await asyncio.create_subprocess_exec(
        sys.executable, "-c", script, *arguments, stdout=asyncio.subprocess.PIPE
    )
