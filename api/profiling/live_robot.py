"""The robot of a running service: readings and frames over one WebSocket, tasks over HTTP."""

import asyncio
import json
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from math import cos, sin
from typing import Any

import httpx
import websockets
from websockets.asyncio.client import ClientConnection

from api.client.outcomes import Json, no_connection
from api.profiling.robot import LostServiceError, Seen
from api.profiling.run import SPEED_MPS
from api.profiling.triggers import Settings

_ANSWER_S = 10.0
_TOPICS = "system_state,vehicle"


class NotSimulatedError(Exception):
    """The service reaches something real, or publishes mock signals; the message says which."""


class LiveRobot:
    """Implements `Robot` with a connection to a service."""

    def __init__(
        self, http: httpx.AsyncClient, stream: ClientConnection, settings: Settings
    ) -> None:
        """Use connections that are open.

        Args:
            http: Sends requests.
            stream: Of the topics `system_state` and `vehicle`.
            settings: Of the signals.
        """
        self._http = http
        self._stream = stream
        self._settings = settings
        self._frames: asyncio.Queue[Seen | None] = asyncio.Queue()
        """None: the connection was closed."""
        self._vehicle: Json = {}
        self._clock = asyncio.get_running_loop().time

    @property
    def settings(self) -> Settings:
        """Return the settings of its signals."""
        return self._settings

    def now(self) -> float:
        """Return the present time of the event loop, s."""
        return self._clock()

    async def read(self) -> None:
        """Read frames, and note when each came, until the connection is closed."""
        try:
            while True:
                text = await self._stream.recv()
                # Before anything is done with it.
                at_s = self._clock()
                frame = json.loads(text)
                if frame["type"] == "state":
                    self._vehicle = frame.get("vehicle", self._vehicle)
                    self._frames.put_nowait(_seen(frame["system_state"], self._vehicle, at_s))
        except websockets.ConnectionClosed:
            self._frames.put_nowait(None)

    async def drive(self, length_m: float) -> None:
        """Submit a task that leads straight ahead from where the vehicle is."""
        pose = self._vehicle["pose"]
        x_m, y_m, yaw_rad = pose["x_m"], pose["y_m"], pose["yaw_rad"]
        waypoints = [
            {"x_m": x_m + way * cos(yaw_rad), "y_m": y_m + way * sin(yaw_rad), "yaw_rad": yaw_rad}
            for way in range(round(length_m) + 1)
        ]
        await _answer(
            self._http, "POST", "/tasks", {"waypoints": waypoints, "speed_mps": SPEED_MPS}
        )

    async def send(self, signal: str, value: float | bool | str) -> float:
        """Send a reading over the WebSocket, and return when."""
        text = json.dumps({"type": "reading", "signal": signal, "value": value})
        at_s = self._clock()
        try:
            await self._stream.send(text)
        except websockets.ConnectionClosed as error:
            raise LostServiceError(_LOST) from error
        return at_s

    async def echo(self) -> float:
        """Return how long a ping and its pong take on the same WebSocket, s."""
        try:
            async with asyncio.timeout(_ANSWER_S):
                begin = self._clock()
                await (await self._stream.ping())
                return self._clock() - begin
        except (websockets.ConnectionClosed, TimeoutError) as error:
            raise LostServiceError(_LOST) from error

    async def seen(self, until: float) -> Seen | None:
        """Return what the next frame tells; None: there was none until then."""
        if self._frames.empty() and until <= self._clock():
            return None
        try:
            async with asyncio.timeout_at(until):
                seen = await self._frames.get()
        except TimeoutError:
            return None
        if seen is None:
            raise LostServiceError(_LOST)
        return seen


_LOST = "the service closed the connection"


@asynccontextmanager
async def live_robot(url: str) -> AsyncIterator[LiveRobot]:
    """Connect to the robot of a service, if all of it is simulated and no signals are mocked.

    Args:
        url: Of a service that needs no token.

    Raises:
        NotSimulatedError: Something is real, or mock signals are published.
        LostServiceError: The service does not answer.
    """
    stream_url = f"{url.replace('http', 'ws', 1)}/ws?topics={_TOPICS}"
    async with httpx.AsyncClient(base_url=url, timeout=_ANSWER_S, trust_env=False) as http:
        _check_simulated((await _answer(http, "GET", "/system_state"))["simulated"])
        signals = (await _answer(http, "GET", "/signals"))["items"]
        settings = {signal["signal"]: signal["settings"] for signal in signals}
        async with websockets.connect(
            stream_url, compression=None, ping_interval=None, max_queue=None, proxy=None
        ) as stream:
            robot = LiveRobot(http, stream, settings)
            reading = asyncio.create_task(robot.read())
            try:
                await _first_frame(robot)
                yield robot
            finally:
                reading.cancel()


async def _first_frame(robot: LiveRobot) -> None:
    """Wait until it is known where the vehicle is."""
    if await robot.seen(robot.now() + _ANSWER_S) is None:
        raise LostServiceError("the service sends no frames")


def _check_simulated(simulated: list[str]) -> None:
    for needed in ("nodes", "vehicle"):
        if needed not in simulated:
            raise NotSimulatedError(f"not simulated: {needed}; a profile would stop the robot")
    if "signals" in simulated:
        raise NotSimulatedError(
            "mock signals are published, which would replace the readings that are measured: set"
            " `mock: false` in the robot file"
        )


async def _answer(
    http: httpx.AsyncClient, method: str, path: str, body: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Return the response to a request.

    Raises:
        LostServiceError: There is none, or the request was rejected.
    """
    try:
        response = await http.request(method, path, json=body)
    except httpx.ConnectError as error:
        raise LostServiceError(str(no_connection(str(http.base_url), error))) from error
    except httpx.HTTPError as error:
        raise LostServiceError(f"no answer to {method} {path}: {error}") from error
    answer: dict[str, Any] = response.json()
    if response.is_error:
        raise LostServiceError(f"{method} {path} was rejected: {answer.get('detail')}")
    return answer


def _seen(state: Json, vehicle: Json, at_s: float) -> Seen:
    return Seen(
        at_s,
        state["state"],
        tuple(state["errors"]),
        state["task_status"],
        vehicle["command"]["speed_mps"],
    )
