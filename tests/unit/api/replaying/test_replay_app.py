"""The interface of a recorded robot: everything can be read, and nothing changes."""

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from api.http.gate.policies import each_route
from api.http.route_policy import policy_of
from api.replaying.player import Player
from api.replaying.recording import recording_of
from api.replaying.replay_app import create_replay_app
from tests.support.manual_clock import ManualClock, settle
from tests.support.recorded_robot import RecordedRobot
from tests.support.stored_robot import boot_of, held_on_its_way, store
from tests.support.websocket import WebSocketClient

VERSION = boot_of(1).version


class Viewer:
    """Somebody who looks at a recording."""

    def __init__(self, player: Player, app: FastAPI, clock: ManualClock) -> None:
        self.player = player
        self.app = app
        self.clock = clock
        self.http = httpx.AsyncClient(
            transport=httpx.ASGITransport(app), base_url="http://127.0.0.1:8000"
        )

    async def put(self, **wish: object) -> httpx.Response:
        """Ask the player for something."""
        asked = asyncio.create_task(self.http.put("/replay", json=wish))
        await settle()
        await self.clock.advance(0.1)
        return await asked


@pytest.fixture(scope="module")
def robot() -> RecordedRobot:
    return held_on_its_way()


@pytest.fixture(scope="module")
def folder(robot: RecordedRobot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data") / "robot"
    store(folder, robot, checkpoints=(20,))
    return folder


@pytest.fixture
async def viewer(folder: Path) -> AsyncIterator[Viewer]:
    clock = ManualClock()
    player = Player(recording_of(folder, VERSION, None, None), VERSION, clock, 10)
    run = asyncio.create_task(player.run())
    yield Viewer(player, create_replay_app(player, clock), clock)
    run.cancel()
    await asyncio.wait([run])


async def test_it_can_be_read_like_a_robot(viewer: Viewer, robot: RecordedRobot) -> None:
    await viewer.clock.advance(1)

    for path in ("/system_state", "/tasks", "/vehicle", "/holds", "/signals", "/events", "/docs"):
        assert (await viewer.http.get(path)).status_code == 200, path
    events = (await viewer.http.get("/events")).json()["items"]
    assert events[-1]["id"] == robot.events[-1].id
    task = (await viewer.http.get("/tasks")).json()["items"][-1]["id"]
    assert (await viewer.http.get(f"/tasks/{task}/waypoints")).status_code == 200


async def test_every_request_that_would_change_a_robot_is_rejected(viewer: Viewer) -> None:
    tried = set()
    for route in each_route(viewer.app.routes):
        declared = policy_of(route.endpoint)
        assert declared is not None
        for method in (route.methods or set()) if declared.permission.writes else ():
            path = route.path.replace("{", "").replace("}", "").replace(":path", "")
            answer = await viewer.http.request(method, path, content=b"{}")
            assert (answer.status_code, answer.json()["code"]) == (409, "RECORDING"), path
            tried.add(path)

    assert {"/emergency_stop", "/tasks", "/signals", "/holds/owner", "/mock/signal"} <= tried


async def test_speed_pause_and_time_are_asked_for(viewer: Viewer) -> None:
    boot = boot_of(1)
    answer = await viewer.put(paused=True, speed=0.5)
    assert answer.json()["paused"] is True

    answer = await viewer.put(at="2026-01-01T00:00:02Z")

    assert answer.json() == {
        "robot": "robot",
        "from_at": boot.wall_at.isoformat(timespec="milliseconds").replace("+00:00", "Z"),
        "to_at": answer.json()["to_at"],
        "at": "2026-01-01T00:00:02.000Z",
        "speed": 0.5,
        "paused": True,
        "fault": None,
    }
    assert (await viewer.http.get("/replay")).json() == answer.json()
    assert "gate" in {hold["owner"] for hold in (await viewer.http.get("/holds")).json()["items"]}


@pytest.mark.parametrize(
    "wish", [{"speed": 0.01}, {"speed": 1000}, {"speed": "fast"}, {"at": "noon"}, {"paus": True}]
)
async def test_what_the_player_cannot_do_is_rejected(
    viewer: Viewer, wish: dict[str, object]
) -> None:
    assert (await viewer.put(**wish)).status_code == 422


async def test_a_page_of_another_site_cannot_touch_the_player(viewer: Viewer) -> None:
    answer = await viewer.http.put(
        "/replay", json={"paused": True}, headers={"Origin": "http://elsewhere.example"}
    )

    assert answer.status_code == 403
    assert not viewer.player.is_paused


async def test_the_stream_says_that_it_is_a_recording_and_goes_on_20_times_a_second(
    viewer: Viewer,
) -> None:
    async with WebSocketClient(viewer.app, "/ws") as client:
        hello = await client.frame("hello")
        first = await client.frame("state")
        await viewer.clock.advance(0.05)
        following = await client.frame("state")

        assert hello["replay"]["robot"] == "robot"
        assert hello["replay"]["speed"] == 10
        assert following["seq"] > first["seq"]
        client.send({"type": "reading", "signal": "estop", "value": True})
        assert (await client.frame("problem"))["code"] == "RECORDING"
