"""Fifty real lifecycle nodes in five processes: what their changes take and cost.

For `make bench-ros2`; needs ROS 2.
"""

import asyncio
import json
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import httpx
import pytest

from domain.state_and_mode import DEFAULT_MODE
from tests.ros2.support.isolation import isolate
from tests.support.bench import PROJECT, Row, report
from tests.support.big_model import FAST, PARAMETERS, SLOW, big_model, big_model_text
from tests.support.process_usage import ProcessUsage
from tests.support.recorded_service import RecordedService, period_rows, recorded_service

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(find_spec("rclpy") is None, reason="needs ROS 2: make bench-ros2"),
    pytest.mark.skipif(sys.platform != "linux", reason="reads /proc"),
]

NODES = 50
PROCESSES = 5
MODEL = big_model(NODES)
ROOT = MODEL.parts[0]
SCRIPT = PROJECT / "tests" / "ros2" / "support" / "lifecycle_nodes.py"
SECONDS = 30.0
SETTLE_S = 5.0
CHANGES = 20
CHANGE_EVERY_S = 1.0
THERE_WITHIN_S = 60.0

COMMAND = "make bench-ros2"
ASKED = (
    "all requests out within 100 ms, verified result within 1.5 s; p99 of the tick within 5 ms of "
    "its period, beside a reference; less than 10 % of a core when idle."
)


@pytest.fixture(scope="module", autouse=True)
def _isolated() -> None:
    isolate()


@pytest.mark.parametrize("heartbeat", [False, True], ids=["polled", "heartbeat"])
async def test_fifty_nodes(tmp_path: Path, *, heartbeat: bool) -> None:
    model = tmp_path / "model.yaml"
    model.write_text(big_model_text(NODES))
    label = "with heartbeat" if heartbeat else "polled"
    with (
        nodes(heartbeat=heartbeat),
        recorded_service(tmp_path, str(model), "--backend", "ros2", "--mock-signals") as robot,
    ):
        there_s = await until_all_are_there(robot)
        begun = [await change(robot, "mode", {"mode": FAST})]
        usage = ProcessUsage(robot.process.pid)
        await asyncio.sleep(SETTLE_S)
        cpu_s = usage.cpu_s()
        idle = await robot.watch(SECONDS)
        percent = 100 * (usage.cpu_s() - cpu_s) / SECONDS
        waited_s = waited_for_a_core_s(robot)
        watching = asyncio.create_task(robot.watch(CHANGES * CHANGE_EVERY_S))
        for number in range(CHANGES):
            at = time.perf_counter()
            begun.append(await change(robot, "mode", {"mode": SLOW if number % 2 else FAST}))
            await asyncio.sleep(max(0.0, at + CHANGE_EVERY_S - time.perf_counter()))
        busy = await watching
        waited_s = waited_for_a_core_s(robot) - waited_s
        begun.append(await change(robot, "state", {"transition": "deactivate"}))
        figures = usage.figures()
        record = robot.end()
    rows: dict[str, Row] = {
        "configure, activate, mode": times(begun[0], record.asks),
        **worst_of("mode", [times(each, record.asks) for each in begun[2:-1]]),
        "deactivate": times(begun[-1], record.asks),
    }
    report(
        f"ros2_changes_{label.replace(' ', '_')}",
        f"Changes of {NODES} ROS 2 nodes, {label}",
        f"A system over {NODES} lifecycle nodes in {PROCESSES} processes is changed through HTTP. "
        "`out` is the time from the HTTP request to the last node request of the first round of "
        "steps; `end` the time to the response with the verified result.",
        rows,
        asked=ASKED,
        command=COMMAND,
        notes=[f"All nodes were known {there_s:.1f} s after Pilothouse started to listen."],
    )
    report(
        f"ros2_tick_{label.replace(' ', '_')}",
        f"Tick beside {NODES} ROS 2 nodes, {label}",
        f"Deviation of periods from 50 ms: idle for {SECONDS:g} s, and while the mode of all nodes "
        f"changes every {CHANGE_EVERY_S:g} s, with an idle loop in a separate process as "
        "reference. All of them share the machine.",
        {
            **period_rows({"idle": idle, "changes": busy}, record),
            "Pilothouse at rest": {"CPU_percent": round(percent, 1), **figures},
        },
        asked=ASKED,
        command=COMMAND,
        notes=[
            "In each change, the event loop's thread was ready and waited for a core for "
            f"{1000 * waited_s / CHANGES:.0f} ms in total, while the nodes worked on the change."
        ],
    )


@contextmanager
def nodes(*, heartbeat: bool) -> Iterator[None]:
    """Run the nodes of the model, spread over several processes."""
    names, share = list(MODEL.nodes), NODES // PROCESSES
    running: list[subprocess.Popen[str]] = []
    try:
        for first in range(0, NODES, share):
            specs = [
                {"name": name, "parameters": dict(PARAMETERS[DEFAULT_MODE]), "heartbeat": heartbeat}
                for name in names[first : first + share]
            ]
            process = subprocess.Popen(
                [sys.executable, str(SCRIPT), json.dumps(specs)], stdout=subprocess.PIPE, text=True
            )
            running.append(process)
        for process in running:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
        yield
    finally:
        for process in running:
            process.kill()
            process.communicate()


async def until_all_are_there(robot: RecordedService) -> float:
    """Wait until every node is known, and return how long that took, s."""
    begin = time.perf_counter()
    async with httpx.AsyncClient(timeout=20) as http:
        while not (await http.get(f"{robot.process.url}/systems/{ROOT}")).json()["reachable"]:
            assert time.perf_counter() < begin + THERE_WITHIN_S
            await asyncio.sleep(0.05)
    return time.perf_counter() - begin


def waited_for_a_core_s(robot: RecordedService) -> float:
    """Return for how long the event loop's thread was ready to run and did not, s."""
    pid = robot.process.pid
    return int(Path(f"/proc/{pid}/task/{pid}/schedstat").read_text().split()[1]) / 1e9


async def change(robot: RecordedService, what: str, body: object) -> tuple[float, float]:
    """Change the system of all nodes; return when it was asked and when it was there."""
    async with httpx.AsyncClient(timeout=20) as http:
        await http.get(f"{robot.process.url}/livez")
        begin = time.perf_counter()
        url = f"{robot.process.url}/systems/{ROOT}/{what}?wait=15"
        answer = await http.post(url, json=body)
        end = time.perf_counter()
    assert answer.status_code == httpx.codes.OK, answer.text
    return begin, end


def times(change: tuple[float, float], asks: list[float]) -> dict[str, float]:
    """Return how long a change took: until all were asked for the first time, and in all."""
    begin, end = change
    asked = [at for at in asks if begin <= at <= end][:NODES]
    assert len(asked) == NODES
    return {
        "out_ms": round(1000 * (asked[-1] - begin), 1),
        "end_ms": round(1000 * (end - begin), 1),
    }


def worst_of(label: str, rows: list[dict[str, float]]) -> dict[str, Row]:
    """Return the median and the worst of several changes."""
    ordered = {column: sorted(row[column] for row in rows) for column in rows[0]}
    return {
        f"{label}, median of {len(rows)}": {c: v[len(v) // 2] for c, v in ordered.items()},
        f"{label}, worst": {c: v[-1] for c, v in ordered.items()},
    }
