"""Somebody who looks at a recording, on a clock that a test moves."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import httpx
from fastapi import FastAPI

from api.replaying.player import Player
from api.replaying.recording import recording_of
from api.replaying.replay_app import create_replay_app
from tests.support.manual_clock import ManualClock, settle
from tests.support.stored_robot import boot_of


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


@asynccontextmanager
async def viewing(folder: Path) -> AsyncIterator[Viewer]:
    """Let a recording be played at ten times its speed as long as the context lasts."""
    clock, version = ManualClock(), boot_of(1).version
    player = Player(recording_of(folder, version, None, None), version, clock, 10)
    run = asyncio.create_task(player.run())
    try:
        yield Viewer(player, create_replay_app(player, clock), clock)
    finally:
        run.cancel()
        await asyncio.wait([run])
