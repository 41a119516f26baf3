"""A client over restarts of the service: what it is told of earlier runs, with each journal."""

import json
import random
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from api.app import create_app
from domain.actor import Actor
from domain.inputs import CancelTaskRequest, EmergencyStopRequest, ModeRequest, TaskRequest
from domain.state_and_mode import PartName
from service.event_log import EventLog
from service.storage.journal import Journal
from service.storage.memory import MemoryJournal, MemoryStore
from service.storage.sqlite.journal import SqliteJournal
from service.storage.sqlite.opening import StoreSettings
from service.supervisor import Supervisor
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.noted_robot import boot
from tests.support.paths import straight
from tests.support.websocket import WebSocketClient

IN_MEMORY = 40
"""Events that a run keeps in memory: few, so that most are read from the journal."""
ALL_IN_MEMORY = 1_000


@dataclass
class Runs:
    """Starts one run after the other on the same data."""

    open: Callable[[int, ManualClock], Awaitable[Journal]]
    clock: ManualClock
    number: int = 0

    @asynccontextmanager
    async def run(self, in_memory: int = IN_MEMORY) -> AsyncIterator[Supervisor]:
        self.number += 1
        journal = await self.open(self.number, self.clock)
        found = journal.found
        before = found.restored.next_event - 1
        log = EventLog(in_memory, journal.boot.epoch, before, found.epochs)
        supervisor = make_supervisor(self.clock, events=log, journal=journal)
        try:
            async with running(supervisor):
                yield supervisor
        finally:
            await journal.close()


@pytest.fixture(params=["memory", "sqlite"])
async def runs(request: pytest.FixtureRequest, tmp_path: Path) -> Runs:
    store = MemoryStore()

    async def open_memory(number: int, clock: ManualClock) -> Journal:
        return MemoryJournal(boot(number, clock.now()), clock, store)

    async def open_sqlite(number: int, clock: ManualClock) -> Journal:
        settings = StoreSettings(tmp_path / "robot", "robot")
        return await SqliteJournal.open(settings, boot(number, clock.now()), clock)

    opened = {"memory": open_memory, "sqlite": open_sqlite}
    return Runs(opened[request.param], ManualClock())


def app_of(supervisor: Supervisor) -> FastAPI:
    return create_app(supervisor, allowed_hosts=[])


async def events_text(supervisor: Supervisor, **query: str | int) -> str:
    """Return the text of the events of an answer, without what says how many there are."""
    transport = httpx.ASGITransport(app_of(supervisor))
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000") as http:
        answer = await http.get("/events", params={"limit": 1_000, **query})
    assert answer.status_code == 200, answer.text
    return answer.text.partition('"items":[')[2].removesuffix("]}")


async def live_texts(supervisor: Supervisor, clock: ManualClock) -> list[str]:
    """Return what a client is streamed while a mode is requested and reached."""
    async with WebSocketClient(app_of(supervisor), topics="events") as client:
        await client.frame("hello")
        request = ModeRequest(PartName("actuation"), "PERFORMANCE", Actor("operator"))
        supervisor.submit(request)
        await clock.advance(2)
        texts: list[str] = []
        while not texts or f'"id":{supervisor.events.newest},' not in texts[-1]:
            texts.append(await client.text())
    return texts


async def test_events_of_an_earlier_run_read_byte_for_byte_as_they_were_streamed(
    runs: Runs,
) -> None:
    async with runs.run() as first:
        streamed = await live_texts(first, runs.clock)
    runs.clock.stall(3_600)

    async with runs.run() as second:
        stored = await events_text(second, after=0)

    assert len(streamed) > 10
    assert ",".join(streamed) in stored


async def test_conditions_choose_alike_from_memory_and_from_the_journal(runs: Runs) -> None:
    queries: list[dict[str, str | int]] = [
        {"kind": "change"},
        {"kind": "*.s*ed"},
        {"part": "drive_base"},
        {"actor": "operator"},
        {"actor": ""},
        {"from_at": "2026-01-01T00:00:00.500Z", "to_at": "2026-01-01T00:00:01Z"},
        {"part": "actuation", "kind": "change.*", "actor": "operator"},
    ]
    async with runs.run(ALL_IN_MEMORY) as first:
        await live_texts(first, runs.clock)
        last = first.events.newest
        live = [await events_text(first, before=last + 1, **query) for query in queries]
    runs.clock.stall(3_600)

    async with runs.run() as second:
        stored = [await events_text(second, before=last + 1, **query) for query in queries]

    assert stored == live


async def test_the_last_task_stays_in_frames_over_a_restart_until_the_next_one(
    runs: Runs,
) -> None:
    async with runs.run() as first:
        first.submit(TaskRequest(straight(), 0, "stanley", 2.8))
        await runs.clock.advance(1)
        first.submit(CancelTaskRequest(Actor("operator")))
        await runs.clock.advance(2)
        ended = await task_in_frames(first)
    assert (ended["id"], ended["status"]) == ("t1", "CANCELED")

    async with runs.run() as second:
        assert await task_in_frames(second) == ended
        second.submit(TaskRequest(straight(), 0, "stanley", 2.8))
        await runs.clock.advance(0.1)
        assert (await task_in_frames(second))["id"] == "t2"


async def task_in_frames(supervisor: Supervisor) -> dict[str, Any]:
    async with WebSocketClient(app_of(supervisor), topics="task") as client:
        task = (await client.frame("state"))["task"]
    assert isinstance(task, dict)
    return task


@pytest.mark.parametrize("seed", range(3))
async def test_a_stream_cut_fifty_times_and_resumed_by_id_is_exactly_the_log(
    runs: Runs, seed: int
) -> None:
    draw = random.Random(seed)
    heard: list[dict[str, Any]] = []
    cuts = 0
    while cuts < 50:
        async with runs.run() as supervisor:
            app = app_of(supervisor)
            for _ in range(draw.randrange(1, 12)):
                await follow(app, supervisor, heard, draw)
                cuts += 1
    async with runs.run() as supervisor:
        while heard[-1]["id"] != supervisor.events.newest:
            await follow(app_of(supervisor), supervisor, heard, draw, presses=0)
        stored = await all_events(supervisor)

    assert heard == stored
    assert [frame["id"] for frame in heard] == list(range(1, len(heard) + 1))
    assert len({frame["epoch"] for frame in heard}) == runs.number > 3


async def all_events(supervisor: Supervisor) -> list[dict[str, Any]]:
    """Return all events, page by page."""
    found: list[dict[str, Any]] = []
    while page := json.loads(f"[{await events_text(supervisor, after=len(found))}]"):
        found += page
    return found


async def follow(
    app: FastAPI,
    supervisor: Supervisor,
    heard: list[dict[str, Any]],
    draw: random.Random,
    presses: int | None = None,
) -> None:
    """Resume after the last frame, read some, and go; things happen meanwhile."""
    last = heard[-1] if heard else {"id": 0, "epoch": supervisor.epoch}
    async with WebSocketClient(app, topics="events", after=last["id"], epoch=last["epoch"]) as one:
        await one.frame("hello")
        for _ in range(draw.randrange(12) if presses is None else presses):
            for engaged in (True, False):
                supervisor.submit(EmergencyStopRequest(engaged, "test", Actor("operator")))
        for _ in range(draw.randrange(60)):
            if last["id"] == supervisor.events.newest:
                break
            last = await one.frame()
            heard.append(last)
