"""What signals, closed terminals and broken outputs do to the real process: the vehicle first."""

import asyncio
import json
import random
import signal
import socket
import subprocess
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.asyncio.client import ClientConnection
from websockets.exceptions import ConnectionClosed

from tests.support.process import COMMAND, ServiceProcess, connect, service
from tests.support.waiting import until

LINE = "".join(f"{x},0,0\n" for x in range(100))
PATIENCE_S = 10.0


@asynccontextmanager
async def driving() -> AsyncIterator[tuple[ServiceProcess, ClientConnection]]:
    with service() as running:
        async with connect(running.stream_url) as client:
            async with httpx.AsyncClient(base_url=running.url) as http:
                taken = await http.post(
                    "/tasks", content=LINE, headers={"Content-Type": "text/csv"}
                )
                assert taken.status_code == httpx.codes.CREATED, taken.text
            while _commanded(json.loads(await client.recv())) < 0.2:
                pass
            yield running, client


async def _told(client: ClientConnection) -> list[dict[str, Any]]:
    """Return what a client was told until the connection was closed."""
    told = []
    try:
        while True:
            told.append(json.loads(await client.recv()))
    except ConnectionClosed:
        return told


def _commanded(frame: dict[str, Any]) -> float:
    vehicle = frame.get("vehicle")
    return -1.0 if vehicle is None else float(vehicle["command"]["speed_mps"])


@pytest.mark.parametrize(
    "name", ["SIGHUP", "SIGQUIT", "SIGTERM", "SIGINT", "SIGUSR1", "SIGALRM", "SIGXCPU"]
)
async def test_a_signal_while_it_drives_stops_the_vehicle_first(name: str) -> None:
    async with driving() as (running, client):
        running.send_signal(signal.Signals[name])
        told = await _told(client)
        code, _, errors = await asyncio.to_thread(running.ended)

    assert [frame["data"]["owner"] for frame in told if frame.get("kind") == "hold.set"] == [
        "service"
    ]
    assert code == 0
    assert "Traceback" not in errors


async def test_signals_in_any_order_stop_the_vehicle_and_then_end_the_process() -> None:
    dice = random.Random(7)
    names = ["SIGHUP", "SIGINT", "SIGTERM", "SIGQUIT", "SIGUSR1"]
    for _ in range(3):
        async with driving() as (running, client):
            for name in dice.choices(names, k=4):
                if running.runs:
                    running.send_signal(signal.Signals[name])
            told = await _told(client)
            code, _, errors = await asyncio.to_thread(running.ended)
        assert any(frame.get("kind") == "hold.set" for frame in told)
        assert code in (0, 130)
        assert "Traceback" not in errors


def test_under_nohup_a_hangup_changes_nothing() -> None:
    with service(command=("nohup", *COMMAND)) as running:
        running.send_signal(signal.SIGHUP)

        assert httpx.get(f"{running.url}/livez").status_code == httpx.codes.OK
        running.send_signal(signal.SIGTERM)
        code, _, _ = running.ended()
    assert code == 0


@pytest.mark.parametrize(
    "outputs",
    [">/dev/full", ">&-", "2>/dev/full", "2>&-", "<&- >&- 2>&-", "| true", "2>&1 | true"],
)
def test_supervision_does_not_depend_on_its_outputs(outputs: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        unused_port = taken.getsockname()[1]
    command = f"exec {' '.join(COMMAND)} serve --port {unused_port} {outputs}"
    with subprocess.Popen(["bash", "-c", command], start_new_session=True) as shell:
        try:
            asyncio.run(_until_it_works(f"http://127.0.0.1:{unused_port}"))
        finally:
            subprocess.run(["kill", "--", f"-{shell.pid}"], check=False)
        shell.wait(PATIENCE_S)


async def _until_it_works(url: str) -> None:
    async with httpx.AsyncClient(base_url=url) as http:

        async def supervises() -> bool:
            try:
                answer = await http.get("/readyz")
            except httpx.ConnectError:
                return False
            return answer.status_code == httpx.codes.OK

        await until(supervises, pause_s=0.05)
        # The worker gets its standard files from ours.
        check = await http.post("/model/check", content="a: 1")
        assert check.json()["valid"] is False


async def test_a_greeting_that_nobody_reads_does_not_hold_up_the_tick(tmp_path: Path) -> None:
    model = tmp_path / "robot.yaml"
    # Each part that nobody uses is a warning, and each warning a line of the greeting.
    parts = "".join(
        f"node_{number:05}: {{ros__parameters: {{type: node}}}}\n" for number in range(3_000)
    )
    model.write_text(parts, encoding="utf-8")
    with service(str(model)) as running:
        async with httpx.AsyncClient(base_url=running.url) as http:
            assert (await http.get("/readyz")).status_code == httpx.codes.OK
