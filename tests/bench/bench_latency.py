"""From an e-stop reading to the ERROR frame at another client, beside a bare echo."""

import json
import sys
import time
from collections.abc import AsyncIterator, Callable
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from websockets.asyncio.client import ClientConnection

from tests.support.asker import Asker, asking
from tests.support.bench import quantiles, report
from tests.support.process import connect, service

pytestmark = pytest.mark.bench

ROUNDS = 500

ROBOT = "signals: {estop: {min_on_s: 0}}\n"
"""An error that ends at once, so that the rounds do not wait for it."""

ECHO = """\
import asyncio, sys
import uvicorn, uvloop
from uvicorn.config import Config

clients = set()

async def app(scope, receive, send):
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.accept"})
        clients.add(send)
        await receive()
        clients.discard(send)
        return
    body = (await receive())["body"].decode()
    for client in clients:
        await client({"type": "websocket.send", "text": body})
    headers = [(b"content-length", b"2")]
    await send({"type": "http.response.start", "status": 200, "headers": headers})
    await send({"type": "http.response.body", "body": b"{}"})

class Echo(uvicorn.Server):
    async def startup(self, sockets=None):
        await super().startup(sockets)
        port = self.servers[0].sockets[0].getsockname()[1]
        print(f"page  http://127.0.0.1:{port}/\\nCtrl-C", flush=True)

config = Config(app, port=0, ws="websockets-sansio", ws_per_message_deflate=False, lifespan="off",
                log_level="warning", access_log=False)
with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
    runner.run(Echo(config).serve())
"""


class Prober:
    """Posts over one connection, and times what another one hears of it."""

    def __init__(self, client: ClientConnection, asker: Asker) -> None:
        self._client = client
        self._asker = asker

    async def post(self, path: str, body: str, awaited: Callable[[str], bool]) -> float:
        """Return the seconds from sending a request until an awaited frame has come."""
        begin = self._asker.send(f"POST {path}", body)
        while not awaited(str(await self._client.recv())):
            pass
        took = time.perf_counter() - begin
        await self._asker.answer()
        return took


@asynccontextmanager
async def prober(url: str, query: str = "") -> AsyncIterator[Prober]:
    host = urlsplit(url).netloc
    async with asking(host) as asker, connect(f"ws://{host}/ws{query}") as client:
        yield Prober(client, asker)


async def test_an_emergency_stop_is_known_everywhere_at_once(tmp_path: Path) -> None:
    echo_script = tmp_path / "echo.py"
    echo_script.write_text(ECHO)
    robot_file = tmp_path / "robot.yaml"
    robot_file.write_text(ROBOT)
    times: dict[str, list[float]] = {"bare echo": [], "e-stop to ERROR": []}
    async with AsyncExitStack() as stack:
        robot = stack.enter_context(service("--robot", str(robot_file)))
        echo = stack.enter_context(service(command=(sys.executable, str(echo_script))))
        stop = await stack.enter_async_context(prober(robot.url, "?topics=system_state"))
        control = await stack.enter_async_context(prober(echo.url))
        for number in range(ROUNDS):
            times["bare echo"].append(await control.post("/", str(number), _is_text(number)))
            times["e-stop to ERROR"].append(
                await stop.post("/signals/estop", '{"value": true}', _is("ERROR"))
            )
            await stop.post("/signals/estop", '{"value": false}', _is("IDLE"))
    report(
        "latency",
        "From a reading to a frame",
        f"From an e-stop reading over HTTP to the frame with ERROR at another client, {ROUNDS} "
        "times, alternating with a bare uvicorn that forwards posted data to a WebSocket.",
        {name: quantiles(taken) for name, taken in times.items()},
    )


def _is_text(number: int) -> Callable[[str], bool]:
    return lambda text: text == str(number)


def _is(state: str) -> Callable[[str], bool]:
    def awaited(text: str) -> bool:
        frame = json.loads(text)
        return bool(frame["type"] == "state" and frame["system_state"]["state"] == state)

    return awaited
