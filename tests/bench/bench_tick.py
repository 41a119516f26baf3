"""How evenly the service ticks, beside a bare loop that does nothing else at the same time."""

import asyncio
import json
import sys
from pathlib import Path

import httpx
import pytest

from tests.support.bench import report
from tests.support.big_model import FAST, SLOW, big_model, big_model_text
from tests.support.fan_out.load import load
from tests.support.fan_out.open_files import allow_many_files
from tests.support.posting import Posts, post
from tests.support.recorded_service import RecordedService, Watched, period_rows, recorded_service

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(sys.platform != "linux", reason="the clients are read by epoll"),
]

SECONDS = 15.0
SETTLE_S = 2.0
CLIENTS = 500
NODES = 50
CHANGE_EVERY_S = 0.5

HOW = (
    "Deviation of periods from 50 ms: of an idle loop in a separate process, of the tick, and of "
    f"frames at a client, all in the same {SECONDS:g} s. "
)


async def test_the_tick_keeps_its_period_with_many_clients(tmp_path: Path) -> None:
    allow_many_files()
    with recorded_service(tmp_path) as robot:
        # In the first second the robot comes up, and what changes is told between the ticks.
        await asyncio.sleep(SETTLE_S)
        idle = await robot.watch(SECONDS)
        with load(robot.host, "/ws?topics=system_state") as clients:
            connected = clients.connect(CLIENTS)
            await asyncio.sleep(SETTLE_S)
            busy = await robot.watch(SECONDS)
        record = robot.end()
    rows = period_rows({"idle": idle, f"{connected} clients": busy}, record)
    about = HOW + "Without load, and with many additional clients that read every frame."
    report("tick_clients", "Period of the tick with many clients", about, rows)
    assert idle.missing == busy.missing == 0


async def test_the_tick_keeps_its_period_while_nodes_change(tmp_path: Path) -> None:
    model, root = tmp_path / "model.yaml", big_model(NODES).parts[0]
    model.write_text(big_model_text(NODES))
    with recorded_service(tmp_path, str(model)) as robot:
        await _enter(robot, f"{root}", FAST)
        idle = await robot.watch(SECONDS)
        busy = await _watch_changes(robot, f"{root}", tmp_path)
        record = robot.end()
    rows = period_rows({"idle": idle, f"{NODES} nodes change": busy}, record)
    about = HOW + (
        f"Every {CHANGE_EVERY_S:g} s, the mode of a system of {NODES} nodes changes over HTTP, and "
        "with it the parameters of each node."
    )
    report("tick_changes", "Period of the tick while nodes change", about, rows)
    assert idle.missing == busy.missing == 0


async def _enter(robot: RecordedService, system: str, mode: str) -> None:
    """Let a system come up in a mode."""
    async with httpx.AsyncClient(timeout=20) as http:
        url = f"{robot.process.url}/systems/{system}/mode?wait=15"
        answer = await http.post(url, json={"mode": mode})
    assert answer.status_code == httpx.codes.OK, answer.text


async def _watch_changes(robot: RecordedService, system: str, folder: Path) -> Watched:
    """Follow the stream while a system goes from one mode to the other and back."""
    bodies = []
    for mode in (SLOW, FAST):
        file = folder / f"{mode}.json"
        file.write_text(json.dumps({"mode": mode}))
        bodies.append((f"/systems/{system}/mode?wait=5", "application/json", file))
    posts = Posts(round(SECONDS / CHANGE_EVERY_S), CHANGE_EVERY_S, bodies)
    posting = await post(robot.host, posts)
    seen = await robot.watch(SECONDS)
    done = await posting.done()
    assert [each.status for each in done] == [httpx.codes.OK] * posts.count
    return seen
