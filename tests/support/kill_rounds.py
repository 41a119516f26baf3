"""A service that is killed again and again while operators use it, and what must be there after.

Each round starts the service on the same folder, checks it against what earlier rounds were
answered, uses it for a while, and kills it. Of what was asked and not answered when it died, the
old or the new state may be there, and nothing else.
"""

import asyncio
import json
import random
import time
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import websockets

from tests.support.process import ServiceProcess, connect, service

OWNERS = ("cell", "door", "operator")
MODES = ("MODERATE", "PERFORMANCE")
SPEED_MPS = 2.0
PATH_M = 10_000.0
LOST_S = 0.5
"""So much of the progress may be lost."""
_READY_TRIES = 500
_SLACK_M = 0.3
"""What the vehicle goes between two frames, and while it begins to drive."""


@dataclass
class Expected:
    """What a restarted service must show; several values while a request was not answered."""

    stop: set[bool] = field(default_factory=lambda: {False})
    holds: dict[str, set[bool]] = field(default_factory=lambda: {name: {False} for name in OWNERS})
    target: set[str | None] = field(default_factory=lambda: {None})
    tasks: set[str] = field(default_factory=set)
    """Those that were answered."""
    distance_m: dict[str, float] = field(default_factory=dict)
    """By task, the progress that a client saw last."""
    events: dict[int, str] = field(default_factory=dict)
    """Those that a client saw, by id."""
    answered: int = 0


class Round:
    """One life of the service."""

    def __init__(self, process: ServiceProcess, expected: Expected, chance: random.Random) -> None:
        self._process = process
        self._expected = expected
        self._chance = chance

    async def check(self, http: httpx.AsyncClient) -> None:
        """Compare the service with what is expected of it, before anybody asks for anything."""
        state = (await http.get("/emergency_stop")).json()["engaged"]
        holds = {item["owner"] for item in (await http.get("/holds")).json()["items"]}
        part = (await http.get("/systems/actuation")).json()
        changes = (await http.get("/changes")).json()["items"]
        vehicle = (await http.get("/vehicle")).json()
        tasks = (await http.get("/tasks")).json()["items"]
        target = part["target"] and part["target"]["mode"]

        assert state in self._expected.stop, "emergency stop"
        for owner, may_be in self._expected.holds.items():
            assert (owner in holds) in may_be, f"hold {owner}"
        assert target in self._expected.target, "target"
        assert not [item for item in changes if item["status"] == "running"], "a change runs"
        assert vehicle["command"]["speed_mps"] == 0.0, "the vehicle is driven"
        assert vehicle["speed_mps"] == 0.0, "the vehicle moves"
        self._check_tasks({item["id"]: item for item in tasks}, holds)
        self._settle(state, holds, target)

    def _check_tasks(self, tasks: dict[str, Any], holds: set[str]) -> None:
        missing = sorted(self._expected.tasks - tasks.keys())
        assert not missing or len(tasks) >= 100, f"tasks {missing} are forgotten"
        current = [item for item in tasks.values() if item["ended_at"] is None]
        assert len(current) <= 1
        assert ("restart" in holds) is bool(current), "the hold `restart`"
        for item in current:
            assert item["status"] == "PAUSED", item["status"]
            seen_m = self._expected.distance_m.get(item["id"], 0.0)
            lost_m = seen_m - item["distance_m"]
            assert lost_m <= LOST_S * SPEED_MPS + _SLACK_M, f"{lost_m:.2f} m are lost"

    def _settle(self, state: bool, holds: set[str], target: str | None) -> None:
        """What is found is what is expected from now on."""
        self._expected.stop = {state}
        self._expected.holds = {owner: {owner in holds} for owner in OWNERS}
        self._expected.target = {target}

    async def use(self, http: httpx.AsyncClient, for_s: float) -> None:
        """Let operators use it for some time, then kill it."""
        await http.delete("/holds/restart")
        work: list[Coroutine[None, None, None]] = [
            self._again_and_again(self._stop_or_release, http),
            *(self._again_and_again(self._hold_or_release(owner), http) for owner in OWNERS),
            self._again_and_again(self._drive, http),
            self._again_and_again(self._change, http),
            self._watch(),
        ]
        busy = [asyncio.create_task(item) for item in work]
        await asyncio.sleep(for_s)
        self._process.kill()
        for task in busy:
            task.cancel()
        for failure in await asyncio.gather(*busy, return_exceptions=True):
            if isinstance(failure, AssertionError):
                raise failure

    async def _again_and_again(
        self,
        act: Callable[[httpx.AsyncClient], Coroutine[None, None, None]],
        http: httpx.AsyncClient,
    ) -> None:
        with suppress(httpx.TransportError):
            while True:
                await act(http)
                await asyncio.sleep(self._chance.expovariate(50.0))

    def _hold_or_release(
        self, owner: str
    ) -> Callable[[httpx.AsyncClient], Coroutine[None, None, None]]:
        async def act(http: httpx.AsyncClient) -> None:
            wanted = self._chance.random() < 0.3
            self._expected.holds[owner] |= {wanted}
            if wanted:
                answer = await http.put(f"/holds/{owner}", json={"reason": "busy"})
            else:
                answer = await http.delete(f"/holds/{owner}")
            if self._is_kept(answer):
                self._expected.holds[owner] = {wanted}

        return act

    async def _stop_or_release(self, http: httpx.AsyncClient) -> None:
        wanted = self._chance.random() < 0.2
        self._expected.stop |= {wanted}
        if self._is_kept(await http.put("/emergency_stop", json={"engaged": wanted})):
            self._expected.stop = {wanted}

    async def _drive(self, http: httpx.AsyncClient) -> None:
        """Submit a task from where the vehicle is; it replaces the one before."""
        await asyncio.sleep(self._chance.random())
        x_m = (await http.get("/vehicle")).json()["pose"]["x_m"]
        waypoints = [{"x_m": x, "y_m": 0, "yaw_rad": 0} for x in (x_m, x_m + PATH_M)]
        answer = await http.post("/tasks", json={"waypoints": waypoints, "speed_mps": SPEED_MPS})
        if self._is_kept(answer):
            self._expected.tasks.add(answer.json()["id"])

    async def _change(self, http: httpx.AsyncClient) -> None:
        mode = self._chance.choice(MODES)
        before = set(self._expected.target)
        self._expected.target |= {mode}
        answer = await http.post("/systems/actuation/mode", json={"mode": mode})
        if answer.status_code == httpx.codes.CONFLICT:
            self._expected.target = before
        elif self._is_kept(answer):
            self._expected.target = {mode}
        await asyncio.sleep(0.1)

    def _is_kept(self, answer: httpx.Response) -> bool:
        assert answer.status_code < httpx.codes.BAD_REQUEST, answer.text
        self._expected.answered += 1
        return answer.headers["Pilothouse-Durable"] == "true"

    async def _watch(self) -> None:
        """Follow the stream: no event comes twice, and progress is seen."""
        with suppress(websockets.ConnectionClosed, OSError):
            async with connect(f"{self._process.stream_url}?topics=task,events") as stream:
                async for text in stream:
                    self._note(json.loads(text))

    def _note(self, frame: dict[str, Any]) -> None:
        if frame["type"] == "event":
            told = f"{frame['epoch']} {frame['kind']} {frame['at']}"
            assert self._expected.events.setdefault(frame["id"], told) == told, "an id came twice"
        task = frame.get("task")
        if task and task["ended_at"] is None:
            self._expected.distance_m[task["id"]] = task["distance_m"]


@asynccontextmanager
async def _client(url: str) -> AsyncIterator[httpx.AsyncClient]:
    async with httpx.AsyncClient(base_url=url, timeout=10.0) as http:
        for _ in range(_READY_TRIES):
            answer = await http.get("/readyz")
            if not answer.is_error:
                break
            await asyncio.sleep(0.02)
        else:
            raise AssertionError(f"it does not become ready: {answer.text}")
        yield http


async def kill_rounds(folder: Path, count: int, seed: int) -> tuple[Expected, list[float]]:
    """Kill a service `count` times under load.

    Returns:
        What was expected in the end, and how long each start took, s.
    """
    chance, expected, starts = random.Random(seed), Expected(), []
    for _ in range(count):
        begin = time.perf_counter()
        with service("--data", str(folder)) as process:
            async with _client(process.url) as http:
                starts.append(time.perf_counter() - begin)
                life = Round(process, expected, chance)
                await life.check(http)
                await life.use(http, chance.uniform(0.02, 1.0))
    with service("--data", str(folder)) as process:
        async with _client(process.url) as http:
            await Round(process, expected, chance).check(http)
    return expected, starts
