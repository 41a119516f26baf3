"""Requests whose outcome is kept: hundreds a second, beside the same in memory and a bare sync."""

import asyncio
import os
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path

import pytest

from domain.tasks.holds import RESERVED
from service.storage.journal import EventQuery
from service.storage.sqlite.recorded_log import RecordedLog
from tests.support.asker import Asker, asking
from tests.support.bench import quantiles, report
from tests.support.measured_service import PILOTHOUSE, measured_service

pytestmark = pytest.mark.bench

CONNECTIONS = 32
PER_S = 300
SECONDS = 20.0
ALONE = 300
"""Requests over one connection, with nobody else."""
RATIO = 1.5
"""Of the slowest percent in a folder to that in memory, at most."""
MISSED = ", which is more than required: see decision 38."
SYNCED_BYTES = 4_096
READY_TRIES = 500
KINDS = {"PUT": "hold.set", "DELETE": "hold.released", "task": "task.requested"}
"""What each answered request must have left in the log."""
TASK = '{"waypoints": [{"x_m": 0, "y_m": 0, "yaw_rad": 0}, {"x_m": 20, "y_m": 0, "yaw_rad": 0}]}'
MODES = ("MODERATE", "PERFORMANCE")


@dataclass
class Asked:
    """What was asked of a service, and how long each answer took, s."""

    took: list[float] = field(default_factory=list)
    answered: dict[str, int] = field(default_factory=dict)
    alone: dict[str, list[float]] = field(default_factory=dict)
    syncs: list[float] = field(default_factory=list)
    elapsed_s: float = 0.0


async def test_what_keeping_costs_those_who_ask(tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    in_memory = await _ask_all(":memory:", tmp_path)
    on_disk = await _ask_all(str(folder), tmp_path)
    lost = _lost(folder, on_disk)
    ratio = quantiles(on_disk.took)["p99_ms"] / quantiles(in_memory.took)["p99_ms"]
    rows = {
        f"{CONNECTIONS} connections, in memory": _row(in_memory),
        f"{CONNECTIONS} connections, in a folder": {**_row(on_disk), "lost": lost},
        "one alone, in memory: PUT /holds": quantiles(in_memory.alone["PUT"]),
        "one alone, in memory: DELETE /holds": quantiles(in_memory.alone["DELETE"]),
        "one alone, in a folder: PUT /holds": quantiles(on_disk.alone["PUT"]),
        "one alone, in a folder: DELETE /holds": quantiles(on_disk.alone["DELETE"]),
        f"write and fsync of {SYNCED_BYTES} bytes": quantiles(on_disk.syncs),
    }
    report(
        "kept_requests",
        "Requests that are kept",
        f"Holds are set and released, modes changed and tasks submitted over {CONNECTIONS} "
        f"connections, {PER_S} requests per second for {SECONDS:g} s, with `--data :memory:` and "
        "with a folder, whose service is then killed with SIGKILL; what was answered is compared "
        f"with its log. From sending a request to the head of its response. And {ALONE} requests "
        "over one connection, each beside a bare fsync in the same folder. A hold is set first and "
        "then stored; a release is announced on disk, carried out, and stored.",
        rows,
        asked=f"p99 in a folder at most {RATIO:g} times that in memory, none lost; one alone: p99 "
        "of setting a hold at most 5 ms more than a bare fsync.",
        notes=[f"The ratio is {ratio:.1f}{MISSED if ratio > RATIO else '.'}"],
    )
    assert lost == 0


async def _ask_all(data: str, folder: Path) -> Asked:
    """Ask one service for everything, and kill it."""
    asked = Asked()
    with measured_service((*PILOTHOUSE, "--data", data)) as service:
        async with asking(service.host) as asker:
            await _ready(asker)
            # The vehicle stays where tasks begin.
            await asker.ask("PUT /holds/bench", '{"reason": "bench"}')
            _count(asked, "PUT")
            # The first one loads numpy, which takes 0.1 s, and is not what is measured here.
            await asker.ask("POST /tasks", TASK)
            _count(asked, "task")
            await _ask_alone(asker, asked, folder)
        begin = time.perf_counter()
        await asyncio.gather(
            *(_ask_on(service.host, number, begin, asked) for number in range(CONNECTIONS))
        )
        asked.elapsed_s = time.perf_counter() - begin
        service.process.kill()
    return asked


async def _ready(asker: Asker) -> None:
    for _ in range(READY_TRIES):
        try:
            await asker.ask("GET /readyz")
        except AssertionError:
            await asyncio.sleep(0.02)
        else:
            return
    raise AssertionError("it does not become ready")


async def _ask_alone(asker: Asker, asked: Asked, folder: Path) -> None:
    """Ask one request after the other, each with a bare sync right before."""
    with (folder / "synced").open("ab", buffering=0) as file:
        for number in range(ALONE):
            begin = time.perf_counter()
            file.write(os.urandom(SYNCED_BYTES))
            os.fsync(file.fileno())
            asked.syncs.append(time.perf_counter() - begin)
            kind, request, body = _hold("alone", number)
            asked.alone.setdefault(kind, []).append((await asker.ask(request, body))[1])
            _count(asked, kind)
            await asyncio.sleep(0.002)


async def _ask_on(host: str, connection: int, begin: float, asked: Asked) -> None:
    """Ask at an even rate over one connection; who is late does not wait."""
    every_s = CONNECTIONS / PER_S
    async with asking(host) as asker:
        for number, (kind, request, body) in enumerate(_requests(connection)):
            due = begin + (number + connection / CONNECTIONS) * every_s
            if due >= begin + SECONDS:
                return
            await asyncio.sleep(max(0.0, due - time.perf_counter()))
            asked.took.append((await asker.ask(request, body))[1])
            _count(asked, kind)


def _requests(connection: int) -> Iterator[tuple[str, str, str]]:
    """Yield kind, request line and body: of ten, eight are about a hold."""
    others_after = connection % 8
    for number in count():
        yield _hold(f"c{connection}", number)
        if number % 8 == others_after:
            mode = MODES[number // 8 % 2]
            yield "task", "POST /tasks", TASK
            yield "mode", "POST /systems/actuation/mode", f'{{"mode": "{mode}"}}'


def _hold(owner: str, number: int) -> tuple[str, str, str]:
    if number % 2:
        return "DELETE", f"DELETE /holds/{owner}", ""
    return "PUT", f"PUT /holds/{owner}", '{"reason": "busy"}'


def _count(asked: Asked, kind: str) -> None:
    asked.answered[kind] = asked.answered.get(kind, 0) + 1


def _row(asked: Asked) -> dict[str, float]:
    rate = len(asked.took) / asked.elapsed_s
    return {**quantiles(asked.took), "requests": len(asked.took), "per_s": round(rate)}


def _lost(folder: Path, asked: Asked) -> int:
    """Return how many of the answered requests left nothing in the log of a killed service."""
    log = RecordedLog(folder)
    lost = 0
    for kind, event in KINDS.items():
        found = log.events(EventQuery(after=0, kind=event, limit=10**6))
        asked_for = [each for each in found if each.data.get("owner") not in RESERVED]
        lost += asked.answered.get(kind, 0) - len(asked_for)
    return lost
