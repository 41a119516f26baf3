"""Robots of 1,000 and 10,000 nodes: a change of all of them, a stop meanwhile, and the idle stream.

A robot of ten nodes is measured in the same way beside them.
"""

import asyncio
import json
import time
from collections.abc import Callable, Coroutine, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.asyncio.client import connect

from tests.support.asker import asking
from tests.support.bench import Row, report
from tests.support.big_model import FAST, SLOW, big_model, big_model_text
from tests.support.measured_service import PILOTHOUSE, MeasuredService, measured_service
from tests.support.stream_listener import listening

pytestmark = pytest.mark.bench

SIZES = (10, 1_000, 10_000)
STEP_S = 0.3
IDLE_S = 10.0
SETTLE_S = 5.0
STOP_EVERY_S = 0.1
LARGEST = max(SIZES)
CLIENTS = 8
_COMPLETE_BYTES = 100 * LARGEST
"""Less than a frame with all parts has, and more than any other."""
MIDWAY_S = 0.8
"""After the start of a change of all nodes, while most of them have not begun."""
NODE = ", ".join(
    f"{step}_s: {STEP_S}" for step in ("configure", "activate", "deactivate", "set_parameters")
)
RESOURCES = ("changes/c1", "nodes", "systems", "model", "metrics")


async def test_large_robots(tmp_path: Path) -> None:
    rows: dict[str, Row] = {}
    for size in SIZES:
        command = _command(tmp_path, size)
        begin = time.perf_counter()
        with measured_service(command) as service:
            start_s = time.perf_counter() - begin
            rows[f"{size:,} nodes"] = {
                "start_s": round(start_s, 1),
                **await _measure(service, str(big_model(size).parts[0])),
            }
    report(
        "large_robot",
        "Large robots",
        "A balanced tree of systems with ten parts each, whose simulated nodes need "
        f"{STEP_S:g} s for each step. `up` takes all of them from unconfigured to a mode, which is "
        "three steps; `mode` is from there to another mode, one step. Gaps are the longest times "
        "between two frames at one client of all topics. `stop` and `release` are the longest "
        "answers to PUT /emergency_stop, of which a release is on disk before it is carried out, "
        f"every {1000 * STOP_EVERY_S:g} ms during a change; `read` is the longest "
        "one to GET /livez while large resources are read.",
        rows,
        asked="1,000 nodes: gaps of at most 70 ms, a change in 1 s; 10,000 nodes: gaps of at most "
        "150 ms, a change in 6 s; stop below 100 ms; idle below 10 kB/s.",
    )
    for label, row in rows.items():
        assert row["succeeded"] == 1, label


async def test_what_is_asked_of_a_large_robot(tmp_path: Path) -> None:
    rows: dict[str, Row] = {}
    root = str(big_model(LARGEST).parts[0])
    with measured_service(_command(tmp_path, LARGEST)) as service:
        async with listening(service.host) as listener:
            await asyncio.sleep(SETTLE_S)
            spans: dict[str, tuple[float, float, float]] = {}
            for label, ask in _QUESTIONS.items():
                await _change(service, root, FAST)
                spans[label] = await _stop_beside(service, ask(service, root))
                await asyncio.sleep(1.0)
            heard = await listener.heard()
    for label, (begin, end, stop_s) in spans.items():
        rows[label] = {
            "took_s": round(end - begin, 2),
            "gap_ms": round(1000 * heard.longest_gap_s(begin, end + 0.1)),
            "stop_max_ms": round(1000 * stop_s, 1),
        }
    report(
        "large_robot_questions",
        f"What is asked of a robot of {LARGEST:,} nodes",
        "The longest time between two frames at one client of all topics, and the longest answer "
        f"to a PUT /emergency_stop every {1000 * STOP_EVERY_S / 2:g} ms, which releases what is "
        "released, while something is asked. All nodes are active in one mode before.",
        rows,
        asked="gaps of at most 150 ms, stop below 100 ms.",
    )


async def _measure(service: MeasuredService, root: str) -> Row:
    async with listening(service.host) as listener:
        await asyncio.sleep(SETTLE_S)
        idle = time.perf_counter()
        await asyncio.sleep(IDLE_S)
        idle_end = time.perf_counter()
        spans, changes = {"idle": (idle, idle_end)}, {}
        for label, mode in (("up", FAST), ("mode", SLOW)):
            begin = time.perf_counter()
            changes[label] = await _change(service, root, mode)
            spans[label] = (begin, time.perf_counter())
        read_s = await _read_all(service)
        stops, stopped = await _stop_meanwhile(service, root)
        heard = await listener.heard()
    ended = [*changes.values(), stopped]
    return {
        "memory_MB": round(service.process.memory_bytes() / 1e6),
        "idle_kB_per_s": round(heard.bytes_per_s(idle, idle_end) / 1000, 1),
        **{f"{label}_s": round(_took(change), 2) for label, change in changes.items()},
        **{
            f"{label}_gap_ms": round(1000 * heard.longest_gap_s(begin, end))
            for label, (begin, end) in spans.items()
        },
        "stop_max_ms": round(1000 * stops[True], 1),
        "release_max_ms": round(1000 * stops[False], 1),
        "read_max_ms": round(1000 * read_s, 1),
        "succeeded": int(all(change["status"] == "succeeded" for change in ended)),
        "event_gaps": heard.gaps,
    }


async def _change(service: MeasuredService, root: str, mode: str) -> Mapping[str, Any]:
    """Ask for a mode of all, and return the change when it has ended."""
    async with httpx.AsyncClient(timeout=90, base_url=str(service.process.url)) as http:
        answer = await http.post(f"/systems/{root}/mode?wait=60", json={"mode": mode})
    change: dict[str, Any] = answer.json()
    return change


async def _stop_meanwhile(
    service: MeasuredService, root: str
) -> tuple[Mapping[bool, float], Mapping[str, Any]]:
    """Engage and release the emergency stop during a change; return the longest answers, s."""
    changing = asyncio.create_task(_change(service, root, FAST))
    longest = {True: 0.0, False: 0.0}
    async with asking(service.host) as asker:
        while not changing.done():
            # Nodes that are active already do not mind a stop.
            for engaged in (True, False):
                body = json.dumps({"engaged": engaged, "reason": "bench"})
                _, took = await asker.ask("PUT /emergency_stop", body)
                longest[engaged] = max(longest[engaged], took)
            await asyncio.sleep(STOP_EVERY_S)
    return longest, await changing


async def _read_all(service: MeasuredService) -> float:
    """Read large resources, and return the longest answer to a small request meanwhile, s."""
    longest = 0.0
    async with httpx.AsyncClient(timeout=90, base_url=str(service.process.url)) as http:
        for resource in RESOURCES:
            reading = asyncio.create_task(http.get(f"/{resource}"))
            async with asking(service.host) as asker:
                while not reading.done():
                    longest = max(longest, (await asker.ask("GET /livez"))[1])
                    await asyncio.sleep(0.002)
            (await reading).raise_for_status()
    return longest


def _took(change: Mapping[str, Any]) -> float:
    """Return how long a change took, s."""
    begin, end = (datetime.fromisoformat(change[key]) for key in ("started_at", "ended_at"))
    return (end - begin).total_seconds()


def _command(folder: Path, size: int) -> tuple[str, ...]:
    """Return the command that serves a robot of so many nodes."""
    robot, model = folder / f"robot_{size}.yaml", folder / f"model_{size}.yaml"
    names = big_model(size).nodes
    robot.write_text("\n".join(["nodes:", *(f"  {name}: {{{NODE}}}" for name in names), ""]))
    model.write_text(big_model_text(size))
    return (*PILOTHOUSE, str(model), "--robot", str(robot))


async def _stop_beside(
    service: MeasuredService, asked: Coroutine[object, object, None]
) -> tuple[float, float, float]:
    """Return when something was asked, when it was done, and the longest stop meanwhile, s."""
    begin, longest = time.perf_counter(), 0.0
    asking_it = asyncio.create_task(asked)
    async with asking(service.host) as asker:
        while not asking_it.done():
            body = json.dumps({"engaged": False})
            longest = max(longest, (await asker.ask("PUT /emergency_stop", body))[1])
            await asyncio.sleep(STOP_EVERY_S / 2)
    await asking_it
    return begin, time.perf_counter(), longest


async def _request(
    service: MeasuredService,
    method: str,
    path: str,
    *,
    json: object = None,
    content: str | None = None,
) -> None:
    async with httpx.AsyncClient(timeout=90, base_url=str(service.process.url)) as http:
        (await http.request(method, path, json=json, content=content)).raise_for_status()


async def _supersede(service: MeasuredService, root: str) -> None:
    older = asyncio.create_task(_change(service, root, SLOW))
    await asyncio.sleep(MIDWAY_S)
    newer = await _change(service, root, FAST)
    assert ((await older)["status"], newer["status"]) == ("superseded", "succeeded")


async def _cancel(service: MeasuredService, root: str) -> None:
    canceled = asyncio.create_task(_change(service, root, SLOW))
    await asyncio.sleep(MIDWAY_S)
    async with httpx.AsyncClient(timeout=90, base_url=str(service.process.url)) as http:
        newest = (await http.get("/changes?limit=1")).json()["items"][0]["id"]
        (await http.delete(f"/changes/{newest}")).raise_for_status()
    assert (await canceled)["status"] == "canceled"


async def _press_estop(service: MeasuredService, root: str) -> None:
    changing = asyncio.create_task(_change(service, root, SLOW))
    for pressed in (True, False):
        await asyncio.sleep(MIDWAY_S)
        await _request(service, "POST", "/signals/estop", json={"value": pressed})
    assert (await changing)["status"] == "succeeded"


async def _read(service: MeasuredService, root: str) -> None:
    for path in ("/", "/systems", "/nodes", f"/systems/{root}", f"/systems/{root}/modes"):
        await _request(service, "GET", path)
    await _request(service, "GET", "/metrics")
    await _request(service, "GET", "/changes?limit=3")


async def _connect(service: MeasuredService, clients: int, *, resync: bool) -> None:
    """Let clients connect at the same time, and wait until each has all parts."""

    async def follow() -> None:
        async with connect(f"ws://{service.host}/ws", max_size=None, close_timeout=0) as client:
            for _ in range(1 + resync):
                # Not parsed: who measures the stop would wait for that.
                while len(await client.recv(decode=False)) < _COMPLETE_BYTES:
                    pass
                await client.send('{"type":"resync"}')

    await asyncio.gather(*(follow() for _ in range(clients)))


_QUESTIONS: Mapping[str, Callable[[MeasuredService, str], Coroutine[object, object, None]]] = {
    "a change supersedes another": _supersede,
    "a change is canceled": _cancel,
    "the e-stop is pressed during a change": _press_estop,
    "a dry run": lambda service, root: _request(
        service, "POST", f"/systems/{root}/mode?dry_run=true", json={"mode": SLOW}
    ),
    "all resources are read": _read,
    "a client connects": lambda service, _: _connect(service, 1, resync=False),
    f"{CLIENTS} clients connect": lambda service, _: _connect(service, CLIENTS, resync=False),
    f"{CLIENTS} clients ask for all again": lambda service, _: _connect(
        service, CLIENTS, resync=True
    ),
    "a model of that size is checked": lambda service, _: _request(
        service, "POST", "/model/check", content=big_model_text(LARGEST)
    ),
    "a simulation of a copy": lambda service, _: _request(
        service, "POST", "/simulations", json={"from": "live", "until_s": 1}
    ),
}
