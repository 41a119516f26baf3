"""The stream over a real network connection."""

import asyncio
import json
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx
import pytest
import websockets
from websockets.asyncio.client import ClientConnection

from tests.support.process import ServiceProcess, connect, read_on, service
from tests.support.waiting import until

READING = '{"type":"reading","signal":"battery_level","value":0.9}'


@pytest.fixture(scope="module")
def running() -> Iterator[ServiceProcess]:
    with service() as process:
        yield process


async def next_frame(client: ClientConnection, kind: str) -> dict[str, Any]:
    while True:
        frame: dict[str, Any] = json.loads(await asyncio.wait_for(client.recv(), 5))
        if frame["type"] == kind:
            return frame


async def count_frames(client: ClientConnection, seconds: float) -> list[dict[str, Any]]:
    frames = []
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        frames.append(await next_frame(client, "state"))
    return frames


async def test_frames_come_at_twenty_a_second(running: ServiceProcess) -> None:
    async with connect(running.stream_url) as client:
        # In the first second the robot comes up, which is told at once and not at the next tick.
        await count_frames(client, 1)
        frames = await count_frames(client, 2)

    assert 38 <= len(frames) <= 42
    assert {frame["skipped"] for frame in frames} == {0}
    assert [frame["seq"] - frames[0]["seq"] for frame in frames] == list(range(len(frames)))


async def test_a_client_that_never_reads_harms_nobody_and_is_dropped(
    running: ServiceProcess,
) -> None:
    async with connect(running.stream_url) as other:
        await count_frames(other, 1)
        before = running.memory_bytes()
        mute = _connect_and_never_read(running)
        skipped = 0
        async with httpx.AsyncClient(base_url=running.url) as http:
            await until(lambda: _has_clients(http, 2), pause_s=0.01)
            start = time.monotonic()
            while await _clients(http) == 2:
                assert time.monotonic() - start < 10
                frames = await count_frames(other, 0.5)
                skipped += sum(frame["skipped"] for frame in frames)
                assert len(frames) >= 9
        grown = running.memory_bytes() - before
        mute.close()

    assert skipped == 0
    assert grown < 4 * 1024 * 1024


def _connect_and_never_read(running: ServiceProcess) -> socket.socket:
    parts = urlsplit(running.url)
    client = socket.create_connection((parts.hostname or "", parts.port or 0))
    client.sendall(
        f"GET /ws HTTP/1.1\r\nHost: {parts.netloc}\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode()
    )
    return client


async def _has_clients(http: httpx.AsyncClient, count: int) -> bool:
    return await _clients(http) == count


async def _clients(http: httpx.AsyncClient) -> int:
    for line in (await http.get("/metrics")).text.splitlines():
        if line.startswith("pilothouse_ws_clients "):
            return int(float(line.split()[1]))
    raise AssertionError("there is no such metric")


async def test_a_client_that_comes_back_misses_no_event(running: ServiceProcess) -> None:
    async with connect(f"{running.stream_url}?topics=events&after=0") as client:
        epoch = (await next_frame(client, "hello"))["epoch"]
        known = (await next_frame(client, "event"))["id"]
    async with httpx.AsyncClient(base_url=running.url) as http:
        path = "/systems/actuation/mode?wait=10"
        assert (await http.post(path, json={"mode": "PERFORMANCE"})).status_code == 200
        newest = (await http.get("/events?limit=1")).json()["newest"]

    url = f"{running.stream_url}?topics=events&after={known}&epoch={epoch}"
    async with connect(url) as client:
        ids = [(await next_frame(client, "event"))["id"] for _ in range(known, newest)]

    assert ids == list(range(known + 1, newest + 1))


async def test_a_client_that_comes_back_after_a_restart_is_told_so(
    running: ServiceProcess,
) -> None:
    with service() as earlier:
        async with connect(earlier.stream_url) as client:
            epoch = (await next_frame(client, "hello"))["epoch"]

    url = f"{running.stream_url}?topics=events&after=5&epoch={epoch}"
    async with connect(url) as client:
        gap = await next_frame(client, "gap")
        first = await next_frame(client, "event")

    assert (gap["from"], gap["to"], gap["epoch"]) == (6, None, epoch)
    assert first["id"] == 1
    assert first["epoch"] != epoch


async def test_a_message_that_is_too_large_ends_that_connection_only(
    running: ServiceProcess,
) -> None:
    async with (
        connect(running.stream_url) as other,
        connect(running.stream_url) as client,
    ):
        await client.send(" " * 65_537)
        with pytest.raises(websockets.ConnectionClosed) as closed:
            await read_on(client)
        frames = await count_frames(other, 0.5)

    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1009
    assert frames


async def test_as_many_clients_are_served_as_the_robot_file_allows(tmp_path: Path) -> None:
    robot = tmp_path / "robot.yaml"
    robot.write_text("limits: {stream_clients: 3}\n")
    with service("--robot", str(robot)) as running:
        clients = [await connect(running.stream_url) for _ in range(3)]
        async with connect(running.stream_url) as one_too_many:
            with pytest.raises(websockets.ConnectionClosed) as closed:
                await one_too_many.recv()
        await asyncio.gather(*(client.close() for client in clients))

    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1013


async def test_a_request_head_without_end_is_cut_off(running: ServiceProcess) -> None:
    parts = urlsplit(running.url)
    reader, writer = await asyncio.open_connection(parts.hostname, parts.port)
    writer.write(b"GET / HTTP/1.1\r\nX-Endless: ")
    answer = b""
    try:
        for _ in range(64):
            writer.write(b"x" * 65_536)
            await writer.drain()
    except ConnectionError:
        pass
    else:
        answer = await asyncio.wait_for(reader.read(), 5)
    writer.close()

    async with httpx.AsyncClient(base_url=running.url) as http:
        assert (await http.get("/livez")).status_code == 200
    assert answer == b"" or b"400" in answer
