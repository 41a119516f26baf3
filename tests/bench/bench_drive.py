"""How soon a drive is stopped, and that what else the service works on disturbs no drive."""

import asyncio
import json
import random
from bisect import bisect
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path as FilePath

import httpx
import numpy as np
import pytest

from service.example_tracks import track_text
from tests.support.asker import asking
from tests.support.bench import Row, quantiles, report
from tests.support.drive_loads import as_posted, dense, example_loop, hour
from tests.support.posting import Posts, post
from tests.support.recorded_service import RecordedService, Watched, period_rows, recorded_service

pytestmark = pytest.mark.bench

ROUNDS = 200
ORIGINAL_P99_MS = 95.0
"""Of smart_polaris, by design: the result of a Monte Carlo study, not a measurement."""

IDLE_S, BUSY_S = 10.0, 30.0
UPLOADS = 10
UPLOAD_EVERY_S = 2.985
"""So that each of 10 meets another part of the 50 ms between two ticks, 5 ms apart."""
SIMULATIONS = 5
"""One after the other, in about as long as they are watched."""

ROBOT = "signals: {estop: {min_on_s: 0}}\n"
"""An error that ends at once, so that more of them fit into a minute."""

ASKED = "p99 of ticks and frames within 5 ms of their period, and an undisturbed drive."


@asynccontextmanager
async def driving(folder: FilePath) -> AsyncIterator[RecordedService]:
    """Serve a robot that drives the loop at 2.8 m/s, 5 minutes long."""
    robot = folder / "robot.yaml"
    robot.write_text(ROBOT)
    with recorded_service(folder, "--robot", str(robot)) as service:
        async with httpx.AsyncClient(headers={"Content-Type": "text/csv"}) as http:
            answer = await http.post(f"{service.process.url}/tasks", content=track_text("loop"))
        assert answer.status_code == httpx.codes.CREATED, answer.text
        await asyncio.sleep(4)
        yield service


async def test_a_bad_reading_stops_the_vehicle(tmp_path: FilePath) -> None:
    chance = random.Random(1)
    asked, answered, control = [], [], []
    async with driving(tmp_path) as robot:
        async with asking(robot.host) as asker:
            for _ in range(ROUNDS):
                # Anywhere between two ticks, and long enough after the release to drive again.
                await asyncio.sleep(0.15 + 0.05 * chance.random())
                control.append((await asker.ask("GET /livez"))[1])
                begin, took = await asker.ask("POST /signals/estop", '{"value": true}')
                asked.append(begin)
                answered.append(took)
                await asker.ask("POST /signals/estop", '{"value": false}')
        drives = robot.end().drives
    rows: dict[str, Row] = {
        "reading to speed 0 at the vehicle": quantiles(list(_until_zero(asked, drives))),
        "reading to answer": quantiles(answered),
        "GET /livez to answer (control)": quantiles(control),
        "smart_polaris, by design (constant)": {"p99_ms": ORIGINAL_P99_MS},
    }
    report(
        "drive_stop",
        "From a bad reading to the vehicle",
        f"{ROUNDS} e-stop readings over HTTP while the vehicle drives, at different times between "
        "two ticks.",
        rows,
        asked="p99 from the reading to speed 0 at the vehicle within 10 ms.",
    )
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
        idle = await robot.watch(IDLE_S)
        posting = await post(robot.host, Posts(UPLOADS, UPLOAD_EVERY_S, previews))
        busy = await robot.watch(BUSY_S)
        done = await posting.done()
        # It goes on where it is, or it would be refused.
        index = int(busy.tasks[-1]["progress"] * (len(points) - 1))
        kinds["application/json"].write_text(json.dumps(as_posted(points, index)))
        last = [("/tasks", "application/json", kinds["application/json"])]
        posting = await post(robot.host, Posts(1, 0, last))
        served = await robot.watch(5)
        (task,) = await posting.done()
        record = robot.end()
    uploads = f"{UPLOADS} uploads"
    rows = period_rows({"idle": idle, uploads: busy, "a task of 100,000": served}, record)
    for kind in kinds:
        rows[f"preview, {kind}"] = quantiles([e.took_s for e in done if e.content_type == kind])
    rows["task, application/json"] = quantiles([task.took_s])
    rows["cross-track error, idle"] = _errors_of(idle)
    rows[f"cross-track error, {uploads}"] = _errors_of(busy)
    report(
        "drive_uploads",
        "Uploads during a drive",
        "Deviation of periods from 50 ms while the vehicle drives and paths of 100,000 waypoints "
        "are uploaded, with an idle loop in a separate process as reference; duration of an "
        "upload; and cross-track error of the vehicle.",
        rows,
        asked=ASKED,
    )
    assert [each.status for each in done] == [httpx.codes.OK] * UPLOADS
    assert task.status == httpx.codes.CREATED
    for seen in (idle, busy):
        _assert_it_went_on(seen)
    assert served.tasks[-1]["waypoint_count"] == len(points)
    assert rows[f"{uploads}, tick at the server"]["p99_ms"] < 5
    assert rows[f"{uploads}, frame at a client"]["p99_ms"] < 5


@pytest.mark.timeout(200)
async def test_a_simulation_disturbs_neither_the_frames_nor_the_drive(tmp_path: FilePath) -> None:
    scenario = tmp_path / "hour.json"
    scenario.write_bytes(hour())
    async with driving(tmp_path) as robot:
        idle = await robot.watch(IDLE_S)
        simulations = [("/simulations", "application/json", scenario)]
        posting = await post(robot.host, Posts(SIMULATIONS, 0, simulations))
        busy = await robot.watch(IDLE_S)
        done = await posting.done()
        record = robot.end()
    rows = period_rows({"idle": idle, "simulations": busy}, record)
    rows["an hour, with the answer"] = {
        **quantiles([each.took_s for each in done]),
        "megabytes": round(done[0].answer_bytes / 1e6, 2),
    }
    report(
        "drive_simulations",
        "Simulations during a drive",
        "Deviation of periods from 50 ms while the vehicle drives and `POST /simulations` "
        "simulates one hour after another, with an idle loop in a separate process as reference.",
        rows,
        asked=ASKED,
    )
    assert [each.status for each in done] == [httpx.codes.OK] * SIMULATIONS
    _assert_it_went_on(idle)
    _assert_it_went_on(busy)
    assert rows["simulations, tick at the server"]["p99_ms"] < 5
    assert rows["simulations, frame at a client"]["p99_ms"] < 5


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
