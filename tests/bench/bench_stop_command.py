"""How soon the vehicle is told to stand still after `pilothouse stop`, beside a large model."""

import asyncio
import http.client
import json
import subprocess
import sys
import time
from pathlib import Path

import pytest
import websockets

from tests.support.bench import Row, quantiles, report
from tests.support.big_model import big_model_text
from tests.support.measured_service import PILOTHOUSE, MeasuredService, measured_service
from tests.support.process import COMMAND
from tests.support.shared import PROJECT
from tests.support.ssh_session import HAS_SSH, ssh_session

pytestmark = [
    pytest.mark.bench,
    pytest.mark.timeout(600),
    pytest.mark.skipif(sys.platform != "linux", reason="reads /proc"),
]

NODES = (2, 10_000)
STOPS = 20
SETTLE_S = 5.0
TRACK = PROJECT / "examples" / "tracks" / "loop.csv"
_PATIENCE_S = 60.0


def test_a_stop_from_the_command_line(tmp_path: Path) -> None:
    rows: dict[str, Row] = {}
    for nodes in NODES:
        model = tmp_path / f"{nodes}.yaml"
        model.write_text(big_model_text(nodes))
        command = (*PILOTHOUSE, str(model), "--mock-signals", "--data", str(tmp_path / str(nodes)))
        with measured_service(command) as service:
            time.sleep(SETTLE_S)
            _ask(service.host, "POST", "/tasks", TRACK.read_text(), "text/csv")
            taken = [_stop(service) for _ in range(STOPS)]
            typed = asyncio.run(_typed_stops(service, tmp_path)) if HAS_SSH else []
        rows[f"{nodes:,} nodes: speed 0 commanded"] = quantiles([told for told, _ in taken])
        rows[f"{nodes:,} nodes: the command says so"] = quantiles([said for _, said in taken])
        if typed:
            rows[f"{nodes:,} nodes, over ssh: speed 0 commanded"] = quantiles(typed)
    report(
        "stop_command",
        "A stop from the command line",
        f"From the start of the process `pilothouse stop` to the first frame of the stream with a "
        f"commanded speed of 0, {STOPS} times, while the vehicle drives; and until the command "
        "prints that the stop is engaged. The start of Python is in it. Over ssh: from Enter in a "
        "session that is open, on this machine. Everything is stored.",
        rows,
        asked="at most 700 ms until speed 0 is commanded, with a model of 10,000 nodes.",
    )


def _stop(service: MeasuredService) -> tuple[float, float]:
    """Return the seconds from the start of the command to speed 0, and to its first line."""
    _release(service)
    return asyncio.run(_time_stop(service))


def _release(service: MeasuredService) -> None:
    _ask(service.host, "PUT", "/emergency_stop", json.dumps({"engaged": False}), "application/json")


async def _time_stop(service: MeasuredService) -> tuple[float, float]:
    url = f"ws://{service.host}/ws?topics=vehicle"
    async with websockets.connect(url, max_size=None) as stream, asyncio.timeout(_PATIENCE_S):
        await _until(stream, drives=True)
        begin = time.perf_counter()
        command = await asyncio.create_subprocess_exec(
            *COMMAND, "stop", "--url", service.process.url, stdout=subprocess.PIPE
        )
        stopped, said = await asyncio.gather(_until(stream, drives=False), _first_line(command))
        assert await command.wait() == 0
        return stopped - begin, said - begin


async def _typed_stops(service: MeasuredService, folder: Path) -> list[float]:
    """Return the seconds from Enter in an ssh session to speed 0, of each stop."""
    keys = folder / f"keys_{service.host.rpartition(':')[2]}"
    keys.mkdir()
    url = f"ws://{service.host}/ws?topics=vehicle"
    taken = []
    async with ssh_session(keys) as session:
        for _ in range(STOPS):
            await asyncio.to_thread(_release, service)
            async with websockets.connect(url, max_size=None) as stream:
                async with asyncio.timeout(_PATIENCE_S):
                    await _until(stream, drives=True)
                    begin = time.perf_counter()
                    await session.enter([*COMMAND, "stop", "--url", service.process.url])
                    taken.append(await _until(stream, drives=False) - begin)
                    await session.until("stop engaged")
    return taken


async def _until(stream: websockets.ClientConnection, *, drives: bool) -> float:
    """Return when a frame said that the vehicle is told to drive, or not to drive."""
    while True:
        frame = json.loads(await stream.recv())
        vehicle = frame.get("vehicle")
        if vehicle is not None and (vehicle["command"]["speed_mps"] != 0) is drives:
            return time.perf_counter()


async def _first_line(command: asyncio.subprocess.Process) -> float:
    assert command.stdout is not None
    assert b"stop engaged" in await command.stdout.readline()
    now = time.perf_counter()
    await command.stdout.read()
    return now


def _ask(host: str, method: str, path: str, body: str, kind: str) -> None:
    connection = http.client.HTTPConnection(host, timeout=_PATIENCE_S)
    try:
        connection.request(method, path, body, {"Content-Type": kind})
        answer = connection.getresponse()
        assert answer.status < http.client.BAD_REQUEST, answer.read()
    finally:
        connection.close()
