"""How the real process begins and ends."""

import asyncio
import json
import shlex
import signal
import socket
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx
import pytest
import websockets
from websockets.asyncio.client import ClientConnection

from tests.support.process import connect, read_on, run, service
from tests.support.waiting import until


async def test_sigterm_ends_it_in_time_and_clients_are_told_that_it_goes() -> None:
    with service() as running:
        async with connect(running.stream_url) as client:
            await client.recv()

            running.send_signal(signal.SIGTERM)
            code, seconds, errors = await asyncio.to_thread(running.ended)

            with pytest.raises(websockets.ConnectionClosed) as closed:
                await read_on(client)
    assert code == 0
    assert "Traceback" not in errors
    assert seconds < 2
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1012


async def test_sigterm_while_it_drives_stops_the_vehicle_first() -> None:
    line = "".join(f"{x},0,0\n" for x in range(100))
    with service() as running:
        http = httpx.AsyncClient(base_url=running.url)
        async with http, connect(running.stream_url) as client:
            await http.post("/tasks", content=line, headers={"Content-Type": "text/csv"})
            moving = await _frame_where(client, lambda frame: _commanded(frame) > 0.2)
            assert moving["task"]["status"] == "RUNNING"

            running.send_signal(signal.SIGTERM)
            held = await _frame_where(client, lambda frame: frame.get("kind") == "hold.set")
            stopped = await _frame_where(client, lambda frame: _commanded(frame) == 0)
            code, _, _ = await asyncio.to_thread(running.ended)
    assert held["data"] == {"owner": "service", "reason": "the service ends"}
    assert stopped["system_state"]["task_status"] == "PAUSED_TASK"
    assert code == 0


async def _frame_where(
    client: ClientConnection, is_it: Callable[[dict[str, Any]], bool]
) -> dict[str, Any]:
    """Return the first frame from now on that is it; the time is limited by that of the test."""
    while True:
        frame: dict[str, Any] = json.loads(await client.recv())
        if is_it(frame):
            return frame


def _commanded(frame: dict[str, Any]) -> float:
    """Return the speed that the vehicle was told by a frame that says so; else less than none."""
    vehicle = frame.get("vehicle")
    return -1.0 if vehicle is None else float(vehicle["command"]["speed_mps"])


def test_ctrl_c_ends_it_like_sigterm() -> None:
    with service() as running:
        running.send_signal(signal.SIGINT)
        code, seconds, errors = running.ended()

    assert code == 0
    assert "Traceback" not in errors
    assert seconds < 2


async def test_a_client_that_waits_for_a_change_is_answered_and_does_not_hold_up_the_end() -> None:
    with service() as running:
        async with httpx.AsyncClient(base_url=running.url) as http:
            waiting = asyncio.create_task(_wait_for_a_change(http))
            await _until_a_change_runs(http)

            running.send_signal(signal.SIGTERM)
            code, seconds, errors = await asyncio.to_thread(running.ended)
            answer = await waiting
    assert (answer.status_code, answer.json()["status"]) == (202, "running")
    assert code == 0
    assert "Traceback" not in errors
    assert seconds < 2


async def test_a_second_ctrl_c_ends_it_at_once() -> None:
    with service() as running:
        address = urlsplit(running.url)
        _, writer = await asyncio.open_connection(address.hostname, address.port)
        # A body that never ends: the server waits a second for its request.
        writer.write(b"POST /signals HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\n{")
        await asyncio.sleep(0.2)

        running.send_signal(signal.SIGINT)
        await asyncio.sleep(0.2)
        assert running.runs
        running.send_signal(signal.SIGINT)
        code, seconds, _ = await asyncio.to_thread(running.ended)

        writer.close()
    assert code == 130
    assert seconds < 0.5


async def _wait_for_a_change(http: httpx.AsyncClient) -> httpx.Response:
    path = "/nodes/drive_base/state?wait=60"
    return await http.post(path, json={"transition": "activate"}, timeout=90)


async def _until_a_change_runs(http: httpx.AsyncClient) -> None:
    async def it_runs() -> bool:
        return bool((await http.get("/changes")).json()["items"])

    await until(it_runs, pause_s=0.02)


def test_a_task_that_fails_ends_the_process_and_is_named(tmp_path: Path) -> None:
    harness = tmp_path / "failing.py"
    harness.write_text(
        textwrap.dedent("""
        import asyncio
        from api.cli import command_line
        from service.simulation.simulated import SimulatedBackend

        async def fail(self, deliver):
            await asyncio.sleep(0.3)
            raise OSError("the bus is gone")

        SimulatedBackend.run = fail
        raise SystemExit(command_line.main())
        """)
    )
    with service(command=(sys.executable, str(harness))) as running:
        code, _, errors = running.ended()

    assert code == 1
    assert "'robot'" in errors
    assert "the bus is gone" in errors


def test_the_greeting_says_what_is_simulated_and_what_to_try() -> None:
    with service() as running:
        greeting = running.greeting

    assert "Simulated: nodes, signals, vehicle." in greeting
    assert "curl -X POST" in greeting


def test_what_the_greeting_says_to_try_works() -> None:
    with service() as running:
        line = next(line for line in running.greeting.splitlines() if "curl -X POST" in line)
        url, body = (shlex.split(line)[place] for place in (3, 5))
        answer = httpx.post(url, content=body)

    assert answer.status_code == 202, answer.text


def test_a_port_in_use_is_told_in_one_line() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        code, output, errors = run("serve", "--port", port)

    assert (code, output) == (1, "")
    assert errors.count("\n") == 1
    assert f"port {port} of 127.0.0.1 is in use" in errors


def test_it_does_not_open_itself_to_the_network_without_being_told_twice() -> None:
    code, output, errors = run("serve", "--host", "0.0.0.0", "--port", "0")

    assert (code, output) == (2, "")
    assert "--anonymous" in errors
    assert errors.count("\n") == 1


def test_an_invalid_model_is_told_with_its_places_and_nothing_is_started(
    tmp_path: Path,
) -> None:
    model = tmp_path / "robot.yaml"
    model.write_text(
        "robot:\n  ros__parameters:\n    type: system\n    modes:\n"
        "      __DEFAULT__:\n        arm: active\n"
    )

    code, output, errors = run("serve", str(model), "--port", "0")

    assert (code, output) == (1, "")
    assert errors.startswith(f"{model}:6:9: error[UNKNOWN_PART]: ")


def test_a_model_that_is_not_there_is_told_in_one_line(tmp_path: Path) -> None:
    code, _, errors = run("serve", str(tmp_path / "robot.yaml"), "--port", "0")

    assert code == 2
    assert errors.count("\n") == 1
    assert "Traceback" not in errors
