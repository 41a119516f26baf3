"""The connection to a service, against a small server that says what a test tells it to."""

import asyncio
import json
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from http import HTTPStatus
from math import pi
from typing import Any

import httpx
import pytest
import websockets
from websockets.asyncio.server import ServerConnection, serve
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from api.profiling.live_robot import LiveRobot, NotSimulatedError, live_robot
from api.profiling.robot import LostServiceError
from tests.support.profiled_robot import SETTINGS

VEHICLE = {"pose": {"x_m": 1.0, "y_m": 2.0, "yaw_rad": pi / 2}, "command": {"speed_mps": 2.8}}


def state(state: str, *errors: str, **more: object) -> str:
    system_state = {"state": state, "errors": errors, "task_status": "RUNNING_TASK"}
    return json.dumps({"type": "state", "system_state": system_state, **more})


class Service:
    """Keeps what it is told, and says what a test wants."""

    def __init__(self, simulated: tuple[str, ...] = ("nodes", "vehicle")) -> None:
        self.heard: list[dict[str, Any]] = []
        self.tasks: list[dict[str, Any]] = []
        self.task_answer: tuple[int, Mapping[str, Any]] = (201, {"id": "t1"})
        self.begin = [json.dumps({"type": "hello"}), state("IDLE", vehicle=VEHICLE)]
        self.stream: ServerConnection | None = None
        self._simulated = simulated

    async def hold(self, stream: ServerConnection) -> None:
        self.stream = stream
        for text in self.begin:
            await stream.send(text)
        async for message in stream:
            self.heard.append(json.loads(message))

    def request(self, _: ServerConnection, request: Request) -> Response | None:
        answers = {
            "/system_state": {"simulated": self._simulated},
            "/signals": {
                "items": [{"signal": name, "settings": dict(SETTINGS[name])} for name in SETTINGS]
            },
        }
        answer = answers.get(request.path)
        if answer is None:
            return None
        body = json.dumps(answer).encode()
        headers = Headers({"Content-Length": str(len(body)), "Connection": "close"})
        return Response(HTTPStatus.OK, "OK", headers, body)

    def task(self, request: httpx.Request) -> httpx.Response:
        self.tasks.append(json.loads(request.content))
        status, answer = self.task_answer
        return httpx.Response(status, json=answer)

    async def say(self, text: str) -> None:
        assert self.stream is not None
        await self.stream.send(text)

    @asynccontextmanager
    async def serving(self) -> AsyncIterator[str]:
        async with serve(self.hold, "127.0.0.1", 0, process_request=self.request) as server:
            port = next(iter(server.sockets)).getsockname()[1]
            yield f"127.0.0.1:{port}"

    @asynccontextmanager
    async def robot(self) -> AsyncIterator[LiveRobot]:
        """Connect with requests that this service answers."""
        transport = httpx.MockTransport(self.task)
        async with (
            self.serving() as host,
            websockets.connect(f"ws://{host}/ws") as stream,
            httpx.AsyncClient(transport=transport, base_url="http://robot") as http,
        ):
            robot = LiveRobot(http, stream, SETTINGS)
            reading = asyncio.create_task(robot.read())
            assert await robot.seen(robot.now() + 5)
            yield robot
            reading.cancel()


async def test_frames_are_seen_in_order_with_the_latest_command() -> None:
    service = Service()
    async with service.robot() as robot:
        await service.say(state("ERROR", "ESTOP", vehicle={**VEHICLE, "command": {"speed_mps": 0}}))
        await service.say(state("ERROR", "ESTOP"))
        first, second = await robot.seen(robot.now() + 5), await robot.seen(robot.now() + 5)

        assert first is not None
        assert second is not None
        assert (first.state, first.errors, first.command_mps) == ("ERROR", ("ESTOP",), 0)
        assert second.command_mps == 0
        assert first.at_s <= second.at_s <= robot.now()


async def test_nothing_is_seen_where_nothing_comes() -> None:
    async with Service().robot() as robot:
        assert await robot.seen(robot.now() - 1) is None
        assert await robot.seen(robot.now() + 0.01) is None


async def test_a_reading_goes_over_the_stream() -> None:
    service = Service()
    async with service.robot() as robot:
        before = robot.now()
        assert before <= await robot.send("estop", value=True) <= robot.now()
        assert await robot.echo() > 0

    assert service.heard == [{"type": "reading", "signal": "estop", "value": True}]


async def test_a_task_leads_straight_ahead_of_the_vehicle() -> None:
    service = Service()
    async with service.robot() as robot:
        await robot.drive(2.4)

    (task,) = service.tasks
    places = [(round(point["x_m"], 9), round(point["y_m"], 9)) for point in task["waypoints"]]
    assert places == [(1, 2), (1, 3), (1, 4)]


async def test_a_rejected_task_ends_the_measurement_with_the_reason() -> None:
    service = Service()
    service.task_answer = (409, {"detail": "the vehicle is parked"})
    async with service.robot() as robot:
        with pytest.raises(LostServiceError, match="the vehicle is parked"):
            await robot.drive(5)


async def test_a_closed_connection_ends_the_measurement() -> None:
    service = Service()
    async with service.robot() as robot:
        assert service.stream is not None
        await service.stream.close()
        with pytest.raises(LostServiceError):
            await robot.seen(robot.now() + 5)
        with pytest.raises(LostServiceError):
            await robot.send("estop", value=True)
        with pytest.raises(LostServiceError):
            await robot.echo()


async def test_settings_are_those_of_the_service() -> None:
    async with Service().serving() as host, live_robot(f"http://{host}") as robot:
        assert robot.settings == SETTINGS


@pytest.mark.parametrize(
    ("simulated", "why"),
    [
        (("nodes",), "not simulated: vehicle"),
        (("vehicle",), "not simulated: nodes"),
        (("nodes", "signals", "vehicle"), "set `mock: false` in the robot file"),
    ],
)
async def test_what_is_not_all_simulated_is_not_measured(
    simulated: tuple[str, ...], why: str
) -> None:
    async with Service(simulated).serving() as host:
        with pytest.raises(NotSimulatedError, match=why):
            async with live_robot(f"http://{host}"):
                pass


async def test_no_service_is_said_to_be_none() -> None:
    with pytest.raises(LostServiceError, match="no service answers"):
        async with live_robot("http://127.0.0.1:9"):
            pass
