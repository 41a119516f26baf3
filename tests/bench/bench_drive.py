"""How soon a drive is stopped, and that what else the service works on disturbs no drive.

Times of several processes are compared: `time.perf_counter` is one clock for all of a machine.
"""

import asyncio
import json
import random
import signal
import sys
import time
from bisect import bisect
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path as FilePath
from typing import Any
from urllib.parse import urlsplit

import httpx
import numpy as np
import pytest

from service.example_tracks import track_text
from tests.support.bench import Row, quantiles, report
from tests.support.drive_loads import as_posted, dense, example_loop, hour
from tests.support.process import ServiceProcess, connect, service

pytestmark = pytest.mark.bench

ROUNDS = 300
ORIGINAL_P99_MS = 95.0
"""Of smart_polaris, by design: the result of a Monte Carlo study, not a measurement."""

PERIOD_S = 0.05
MINUTE_S = 60.0
UPLOADS = 20
UPLOAD_EVERY_S = 2.9825
"""So that each of 20 meets another part of the 50 ms between two ticks, 2.5 ms apart."""
SIMULATIONS = 14
"""In half a minute, one after the other."""

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
    """What is posted meanwhile: so many of path, content type and file, in turn."""

    count: int
    every_s: float
    items: Sequence[tuple[str, str, FilePath]]


class DrivingService:
    """A service whose vehicle drives the loop, and what it did."""

    def __init__(self, process: ServiceProcess, record: FilePath) -> None:
        self.process = process
        self._record = record

    async def watch(self, seconds: float, posts: Posts | None = None) -> tuple[Watched, list[Any]]:
        """Follow the stream, with a bare loop beside it, and return what was posted as well."""
        bare = await _python(BARE, str(round(seconds / PERIOD_S)))
        posting = None if posts is None else await self._posting(posts)
        async with connect(f"{self.process.stream_url}?topics=task") as client:
            # The greeting, and a frame at once: only those after them come with the ticks.
            await client.recv()
            await client.recv()
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

    async def _posting(self, posts: Posts) -> asyncio.subprocess.Process:
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
        async with httpx.AsyncClient(headers={"Content-Type": "text/csv"}) as http:
            answer = await http.post(f"{process.url}/tasks", content=track_text("loop"))
        assert answer.status_code == httpx.codes.CREATED, answer.text
        await asyncio.sleep(4)
        yield DrivingService(process, record)


class Asker:
    """Asks over one connection, without a library, whose time would be measured as well."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader, self._writer = reader, writer

    async def ask(self, request: str, body: str = "") -> tuple[float, float]:
        """Return when a request was sent, and how many seconds the answer took."""
        head = f"{request} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: {len(body)}\r\n\r\n"
        begin = time.perf_counter()
        self._writer.write((head + body).encode())
        answer = (await self._reader.readuntil(b"\r\n\r\n")).decode().lower()
        took = time.perf_counter() - begin
        assert answer.startswith("http/1.1 200"), answer
        length = answer.partition("content-length:")[2].partition("\r\n")[0]
        await self._reader.readexactly(int(length))
        return begin, took

    async def close(self) -> None:
        """Close the connection."""
        self._writer.close()
        await self._writer.wait_closed()


async def test_a_bad_reading_stops_the_vehicle(tmp_path: FilePath) -> None:
    chance = random.Random(1)
    asked, answered, control = [], [], []
    async with driving(tmp_path) as robot:
        address = urlsplit(robot.process.url)
        asker = Asker(*await asyncio.open_connection(address.hostname, address.port))
        for _ in range(ROUNDS):
            # Anywhere between two ticks, and long enough after the release to drive again.
            await asyncio.sleep(0.15 + 0.05 * chance.random())
            control.append((await asker.ask("GET /livez"))[1])
            begin, took = await asker.ask("POST /signals/estop", '{"value": true}')
            asked.append(begin)
            answered.append(took)
            await asker.ask("POST /signals/estop", '{"value": false}')
        await asker.close()
        drives = robot.end()["drives"]
    rows: dict[str, Row] = {
        "reading to speed 0 at the vehicle": quantiles(list(_until_zero(asked, drives))),
        "reading to answer": quantiles(answered),
        "GET /livez to answer (control)": quantiles(control),
        "smart_polaris, by design (constant)": {"p99_ms": ORIGINAL_P99_MS},
    }
    report("drive_stop", rows)
    assert rows["reading to speed 0 at the vehicle"]["p99_ms"] <= 10


def _until_zero(asked: list[float], drives: list[tuple[float, float]]) -> Iterator[float]:
    """Yield the seconds from each reading to the next command of speed 0."""
    times = [at for at, _ in drives]
    zeros = [at for at, speed in drives if speed == 0]
    for begin in asked:
        assert drives[bisect(times, begin) - 1][1] > 0, "it did not drive"
        yield zeros[bisect(zeros, begin)] - begin


@pytest.mark.timeout(200)
async def test_uploads_disturb_neither_the_frames_nor_the_drive(tmp_path: FilePath) -> None:
    points = dense(example_loop())
    kinds = {"application/json": tmp_path / "dense.json", "text/csv": tmp_path / "dense.csv"}
    kinds["application/json"].write_text(json.dumps(as_posted(points)))
    np.savetxt(kinds["text/csv"], points, "%.9g", ",")
    previews = [("/tasks/preview", kind, file) for kind, file in kinds.items()]
    async with driving(tmp_path) as robot:
        idle, _ = await robot.watch(MINUTE_S / 2)
        busy, done = await robot.watch(MINUTE_S, Posts(UPLOADS, UPLOAD_EVERY_S, previews))
        # It goes on where it is, or it would be refused.
        index = int(busy.tasks[-1]["progress"] * (len(points) - 1))
        kinds["application/json"].write_text(json.dumps(as_posted(points, index)))
        last = Posts(1, 0, [("/tasks", "application/json", kinds["application/json"])])
        served, (task,) = await robot.watch(5, last)
        found = robot.end()
    rows = _periods({"idle": idle, "20 uploads": busy, "a task of 100,000": served}, found)
    for kind in kinds:
        rows[f"preview, {kind}"] = quantiles([took for k, _, _, took in done if k == kind])
    rows["task, application/json"] = quantiles([task[3]])
    rows["cross-track error, idle"] = _errors_of(idle)
    rows["cross-track error, 20 uploads"] = _errors_of(busy)
    report("drive_uploads", rows)
    assert [status for _, status, _, _ in done] == [httpx.codes.OK] * UPLOADS
    assert task[1] == httpx.codes.CREATED
    for seen in (idle, busy):
        _assert_it_went_on(seen)
    assert served.tasks[-1]["waypoint_count"] == len(points)
    assert rows["20 uploads, tick at the server"]["p99_ms"] < 5
    assert rows["20 uploads, frame at a client"]["p99_ms"] < 5


@pytest.mark.timeout(200)
async def test_a_simulation_disturbs_neither_the_frames_nor_the_drive(tmp_path: FilePath) -> None:
    scenario = tmp_path / "hour.json"
    scenario.write_bytes(hour())
    async with driving(tmp_path) as robot:
        idle, _ = await robot.watch(MINUTE_S / 2)
        posts = Posts(SIMULATIONS, 0, [("/simulations", "application/json", scenario)])
        busy, done = await robot.watch(MINUTE_S / 2, posts)
        found = robot.end()
    rows = _periods({"idle": idle, "simulations": busy}, found)
    rows["an hour, with the answer"] = {
        **quantiles([took for _, _, _, took in done]),
        "megabytes": round(done[0][2] / 1e6, 2),
    }
    report("drive_simulations", rows)
    assert [status for _, status, _, _ in done] == [httpx.codes.OK] * SIMULATIONS
    _assert_it_went_on(idle)
    _assert_it_went_on(busy)
    assert rows["simulations, tick at the server"]["p99_ms"] < 5
    assert rows["simulations, frame at a client"]["p99_ms"] < 5


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
