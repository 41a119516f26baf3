"""Whatever somebody sends, the real process writes its token nowhere."""

import asyncio
import json
import random
import signal
from pathlib import Path
from urllib.parse import quote, urlsplit

import httpx
import pytest
import websockets

from api.access_token import TOKEN_VARIABLE
from tests.support.process import ServiceProcess, run, service

TOKEN = "correct-horse-battery-staple-91"
HEADERS = {"Authorization": f"Bearer {TOKEN}"}


def _raw_requests() -> list[bytes]:
    """Return requests that hold the token in every place that a client might put it in."""
    dice = random.Random(11)
    places = [
        f"GET /system_state?token={TOKEN} HTTP/1.1\r\nHost: localhost\r\n\r\n",
        f"GET /nodes/{quote(TOKEN)} HTTP/1.1\r\nHost: localhost\r\nAuthorization: {TOKEN}\r\n\r\n",
        f"{TOKEN} / HTTP/1.1\r\n\r\n",
        f"GET / HTTP/{TOKEN}\r\n\r\n",
        f"GET / HTTP/1.1\r\nHost: {TOKEN}\r\nAuthorization: Bearer {TOKEN}\r\n\r\n",
        f"POST /holds/x HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {TOKEN}\r\n"
        f"Content-Length: 99\r\n\r\n{TOKEN}",
        f"GET /ws HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n{TOKEN}\r\n\r\n",
        f"GET /ws?token={TOKEN} HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\n"
        f"Upgrade: websocket\r\nSec-WebSocket-Key: {TOKEN}\r\nSec-WebSocket-Version: 13\r\n\r\n",
    ]
    cut = [place[: dice.randrange(1, len(place))] for place in places]
    return [text.encode() for text in (*places, *cut)]


async def _ask_in_every_way(running: ServiceProcess) -> None:
    address = urlsplit(running.url)
    for request in _raw_requests():
        _, writer = await asyncio.open_connection(address.hostname, address.port)
        writer.write(request)
        await asyncio.sleep(0.02)
        writer.close()
    for first in (json.dumps({"type": "auth", "token": TOKEN}), TOKEN, f'{{"token": "{TOKEN}"'):
        async with websockets.connect(running.stream_url) as stream:
            await stream.send(first)
            await stream.recv()
    async with websockets.connect(
        running.stream_url, additional_headers=HEADERS, max_queue=None
    ) as stream:
        await stream.send(b"\xff" + TOKEN.encode())
        await stream.recv()
    async with httpx.AsyncClient(base_url=running.url, headers=HEADERS) as http:
        await http.put(f"/holds/{TOKEN}", json={"reason": TOKEN})
        await http.post("/tasks", content=f"{TOKEN},0,0")


@pytest.mark.parametrize("level", ["debug", "info"])
async def test_the_log_never_holds_it(level: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(TOKEN_VARIABLE, TOKEN)
    # asyncio then logs what it runs, with its arguments.
    monkeypatch.setenv("PYTHONASYNCIODEBUG", "1")

    with service("--log-level", level) as running:
        await _ask_in_every_way(running)
        command_line = await asyncio.to_thread(Path(f"/proc/{running.pid}/cmdline").read_text)
        running.send_signal(signal.SIGTERM)
        _, _, errors = await asyncio.to_thread(running.ended)

    assert TOKEN not in errors + command_line + running.greeting
    assert quote(TOKEN) not in errors


def test_a_token_that_can_be_guessed_does_not_open_the_service_to_the_network(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(TOKEN_VARIABLE, "short")

    code, output, errors = run("serve", "--host", "0.0.0.0", "--port", "0")

    assert (code, output) == (2, "")
    assert "16 characters" in errors
    assert "short" not in errors
