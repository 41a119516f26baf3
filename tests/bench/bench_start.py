"""What the logs of a month cost: the start of the service, and its rest."""

import asyncio
import http.client
import json
import os
import shutil
import sys
import time
from pathlib import Path

import pytest

from domain.inputs import Reading, Readings
from domain.outbox import NOTHING
from service.storage.journal import Step
from service.storage.sqlite.folder import Retention
from service.storage.sqlite.journal import SqliteJournal
from service.storage.sqlite.opening import StoreSettings
from service.storage.sqlite.places import Places
from tests.support.bench import Row, quantiles, report
from tests.support.manual_clock import ManualClock
from tests.support.measured_service import PILOTHOUSE, measured_service
from tests.support.noted_robot import NotedRobot, boot

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(sys.platform != "linux", reason="reads /proc"),
]

FILES, FILE_BYTES = 30, 60 * 2**20
"""As many files as days, and as much as the usual limits let be kept."""
STARTS = 7
READY_WITHIN_S = 20.0
SETTLE_S = 5.0
REST_S = 20.0
RSS_MB = 95.0
MORE = "The RSS is more than required: Python with FastAPI and uvicorn alone takes 45 MB."
ROBOT = "actuation"
"""Name of the example robot."""


def test_a_start_with_the_logs_of_a_month(tmp_path: Path) -> None:
    folders = {"a new folder": tmp_path / "new", "the logs of 30 days": tmp_path / "month"}
    asyncio.run(_fill(folders["the logs of 30 days"]))
    size_mb = _size_mb(folders["the logs of 30 days"])
    taken: dict[str, list[float]] = {name: [] for name in folders}
    for _ in range(STARTS):
        for name, folder in folders.items():
            if name == "a new folder":
                shutil.rmtree(folder, ignore_errors=True)
            taken[name].append(_start(folder))
    report(
        "start_with_logs",
        "Start with the logs of a month",
        f"From the start of the process to the first 200 of /readyz, {STARTS} times in turn: in a "
        f"new folder, and in one with {FILES} files of the log. The first of these was written by "
        "a journal in virtual time, and the others are copies of it; between two starts the "
        "service is killed with SIGKILL.",
        {
            name: {**quantiles(times), "logs_mb": size_mb if name != "a new folder" else 0.0}
            for name, times in taken.items()
        },
        asked="at most 0.5 s more with the logs of 30 days.",
    )


def test_what_a_service_costs_that_writes_everything_down(tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    with measured_service((*PILOTHOUSE, "--data", str(folder))) as service:
        time.sleep(SETTLE_S)
        logged, begin, before = _logged(service.host), time.perf_counter(), service.usage.cpu_s()
        time.sleep(REST_S)
        elapsed_s = time.perf_counter() - begin
        percent = 100 * (service.usage.cpu_s() - before) / elapsed_s
        grown_mb = (_logged(service.host) - logged) / 1e6
        row: Row = {
            "CPU_percent": round(percent, 1),
            **service.usage.figures(),
            "per_day_mb": round(grown_mb * 86_400 / elapsed_s, 1),
        }
    report(
        "rest_with_logs",
        "At rest, with everything written down",
        f"CPU over {REST_S:g} s, as the share of a core, and memory of `pilothouse serve` with the "
        "example robot and a folder, without a client; and how fast its logs grow.",
        {"nobody looks": row},
        asked=f"at most {RSS_MB:g} MB RSS and 5 % of a core.",
        notes=[MORE] if row["RSS_mb"] > RSS_MB else [],
    )


async def _fill(folder: Path) -> None:
    """Let a folder hold as many full files of the log as there are days in a month."""
    clock = ManualClock()
    journal = await SqliteJournal.open(
        StoreSettings(folder, ROBOT, Retention(file_bytes=2 * FILE_BYTES)), boot(1), clock
    )
    robot = NotedRobot(journal)
    first = Places(folder).log(1)
    while first.stat().st_size < FILE_BYTES:
        for _ in range(20):
            robot.holds("operator", "lunch")
            robot.releases("operator")
            for _ in range(20):
                # As long as twenty inputs, which would only take longer to make.
                source = os.urandom(1_000).hex()
                reading = Readings((Reading("battery_level", 0.8),), source)
                robot.now += robot.PERIOD
                journal.note(Step(robot.now, reading, False, NOTHING))
        assert await journal.commit(10.0)
    await journal.close()
    for number in range(2, FILES + 1):
        shutil.copy(first, Places(folder).log(number))
    # It names the file that was the last one; it is made anew from the log.
    Places(folder).state.unlink()


def _start(folder: Path) -> float:
    """Return how long it took from the start of a process until it is ready, s."""
    begin = time.perf_counter()
    with measured_service((*PILOTHOUSE, "--data", str(folder))) as service:
        while _get(service.host, "/readyz")[0] != http.client.OK:
            assert time.perf_counter() < begin + READY_WITHIN_S, "it never was ready"
        return time.perf_counter() - begin


def _logged(host: str) -> int:
    """Return how much a service has in its logs, in bytes."""
    _, text = _get(host, "/storage")
    return sum(int(log["bytes"]) for log in json.loads(text)["logs"].values())


def _get(host: str, path: str) -> tuple[int, bytes]:
    """Return status and body of an answer."""
    connection = http.client.HTTPConnection(host, timeout=READY_WITHIN_S)
    try:
        connection.request("GET", path)
        answer = connection.getresponse()
        return answer.status, answer.read()
    finally:
        connection.close()


def _size_mb(folder: Path) -> float:
    sizes = (path.stat().st_size for path in folder.rglob("*") if path.is_file())
    return round(sum(sizes) / 1e6, 2)
