"""A service that stores what happens in a folder, on a clock that a test moves."""

import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import httpx
from fastapi import FastAPI

from api.app import close_workers, create_app
from api.serving.composition import ServeOptions, compose, open_stores, read_files
from api.streaming.client_input import STATE_TOPICS
from api.streaming.encoder import StreamEncoder
from service.frame_publisher import FramePublisher
from service.supervisor import Supervisor
from service.worker import InlineJobs
from tests.support.live_robot import running
from tests.support.manual_clock import ManualClock


class StoredService:
    """One run of the service of the example robot."""

    def __init__(self, supervisor: Supervisor, app: FastAPI, clock: ManualClock) -> None:
        self.supervisor = supervisor
        self.app = app
        self.clock = clock
        self.http = httpx.AsyncClient(
            transport=httpx.ASGITransport(app), base_url="http://127.0.0.1:8000"
        )

    @property
    def now(self) -> str:
        """Return the time of day, to the millisecond."""
        wall = self.clock.wall_time(self.clock.now())
        return wall.isoformat(timespec="milliseconds").replace("+00:00", "Z")

    def frame(self) -> dict[str, Any]:
        """Return the complete frame of now."""
        publisher = FramePublisher(self.supervisor.core, self.clock, self.supervisor.simulated)
        publisher.publish()
        frame = publisher.frames.complete()
        assert frame is not None
        shown = json.loads(StreamEncoder(self.supervisor).frame(frame, 0, STATE_TOPICS))
        assert isinstance(shown, dict)
        return shown

    async def ask(self, method: str, path: str, **body: object) -> httpx.Response:
        """Return the answer to a request that changes something, once it is carried out."""
        # Not in the millisecond that was looked at last.
        await self.clock.advance(0.01)
        answer = await self.http.request(method, path, json=body or None)
        assert answer.is_success, answer.text
        await self.clock.advance(0.1)
        return answer

    async def frame_at(self, moment: str) -> httpx.Response:
        """Ask for the frame of a moment."""
        return await self.http.get("/frames", params={"at": moment})


@asynccontextmanager
async def stored_service(
    folder: Path, clock: ManualClock, *, in_process: bool = True
) -> AsyncIterator[StoredService]:
    """Let the service run as long as the context lasts.

    Args:
        folder: Of the robot.
        clock: Goes on from run to run.
        in_process: Replay in this process, not in the worker.
    """
    options = ServeOptions(data=str(folder))
    files = read_files(options)
    stores = await open_stores(options, files, clock)
    supervisor = compose(options, clock, files, stores).supervisor
    app = create_app(supervisor, allowed_hosts=[])
    if in_process:
        app.state.replayer = InlineJobs()
    try:
        async with running(supervisor):
            yield StoredService(supervisor, app, clock)
    finally:
        await close_workers(app)
        await stores.close()


def later(moment: str, by_s: float) -> str:
    """Return a moment some time later."""

    wall = datetime.fromisoformat(moment) + timedelta(seconds=by_s)
    return wall.isoformat(timespec="milliseconds").replace("+00:00", "Z")
