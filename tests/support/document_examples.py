"""Record what the documents show as examples, from the example robot in virtual time.

    python -m tests.support.document_examples

writes `api/documents/examples.json`.
"""

import asyncio
import json
from collections.abc import Coroutine
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx

from api.documents.examples import Examples, Exchange, StreamExample
from api.http.page.assembled_page import assembled_page
from api.http.problems import MEDIA_TYPE
from domain.health.signals import (
    Bound,
    Comparison,
    MonitorSettings,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.processes.settings import ProcessSettings
from domain.snapshot import Severity
from domain.supervision import SupervisionSettings
from domain.timebase import seconds
from domain.windows.settings import Statistic, WindowSettings
from service.ports import ProcessOutput
from tests.support.document_story import CHECKPOINTS, CSV, JSON, PROCESS_OF, REACTING, STORY, Asked
from tests.support.good import GOOD
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.manual_clock import ManualClock
from tests.support.process_runner import ScriptedProcesses
from tests.support.robot_with_devices import ARM_COMPUTER, DEVICES, ToldLink, heard, status
from tests.support.shared import PROJECT
from tests.support.stored_service import stored_service
from tests.support.websocket import WebSocketClient

FILE = PROJECT / "api" / "documents" / "examples.json"
EPOCH = "9f86d081884c7d65"
"""Instead of the epoch of a run, which is another one each time."""
PAGE_VERSION = "6f0c2b9d41e7"
"""Instead of the version of the page, so that a change to it leaves the documents as they are."""

_BATTERY_SLOPE = SignalSettings(
    SignalSpec("battery_slope", SignalKind.NUMBER, "1/s"),
    (Bound("BATTERY_DRAINED", Comparison.BELOW, -0.01),),
    stale_after=0,
    severity=Severity.WARNING,
    monitor=MonitorSettings(
        "battery_level", WindowSettings(statistic=Statistic.SLOPE, length=seconds(30))
    ),
)
_SETTINGS = SupervisionSettings(
    (*default_signals(), _BATTERY_SLOPE),
    checkpoints=CHECKPOINTS,
    processes={PROCESS_OF: ProcessSettings()},
    devices={ARM_COMPUTER: DEVICES[ARM_COMPUTER]},
)
_EXCERPT_LINES = 4
_METRICS = ("pilothouse_system_state", "pilothouse_task")
_PARSED = (JSON, MEDIA_TYPE)


async def record() -> Examples:
    """Let the story happen, and return what was asked, answered and streamed."""
    async with http_robot(REACTING, settings=_SETTINGS) as robot:
        robot.supervisor.submit(status(ARM_COMPUTER))
        await robot.pass_time(1)
        robot.supervisor.link = ToldLink({ARM_COMPUTER: heard(robot.clock.now())})
        _let_run(robot)
        requests = [
            _exchange(asked, await _answer_of_a_record(asked))
            if asked.is_recorded
            else _exchange(asked, await _answer(robot, asked))
            for asked in STORY
        ]
        text = Examples(requests=requests, stream=await _messages(robot)).model_dump_json()
        text = text.replace(robot.supervisor.epoch, EPOCH)
        return Examples.model_validate_json(text.replace(assembled_page().version, PAGE_VERSION))


def _let_run(robot: HttpRobot) -> None:
    """Let a node have a process that runs."""
    runner = ScriptedProcesses(robot.supervisor, PROCESS_OF)
    runner.printed = ProcessOutput(("base 1.4 is up", "listening on /dev/ttyUSB0"), ())
    runner.is_ready()
    runner.runs(4711)


def _exchange(asked: Asked, answer: httpx.Response) -> Exchange:
    """Keep an answer as the document shows it."""
    media_type = answer.headers.get("content-type", "").partition(";")[0] or None
    body_type = None if asked.body is None else asked.body_type
    return Exchange(
        operation=asked.operation,
        summary=asked.summary,
        path=asked.path,
        query=asked.query,
        body_type=body_type,
        body=asked.body,
        status=answer.status_code,
        answer_type=media_type,
        answer=_shown(answer, media_type),
    )


async def _answer(robot: HttpRobot, asked: Asked) -> httpx.Response:
    method, _, template = asked.operation.partition(" ")
    headers = {"accept": asked.accept}
    content: str | None = None
    if asked.body is not None:
        headers["content-type"] = asked.body_type
        content = asked.body if isinstance(asked.body, str) else json.dumps(asked.body)
    request: Coroutine[Any, Any, httpx.Response] = robot.http.request(
        method,
        template.format_map(asked.path),
        params=asked.query,
        headers=headers,
        content=content,
    )
    if "wait" in asked.query:
        return await robot.while_time_passes(asked.then_s, request)
    answer = await request
    await robot.pass_time(asked.then_s)
    return answer


async def _answer_of_a_record(asked: Asked) -> httpx.Response:
    """Ask a robot whose service has run for two seconds, and wrote down what happened."""
    with TemporaryDirectory() as folder:
        async with stored_service(Path(folder) / "robot", ManualClock()) as robot:
            await robot.clock.advance(2)
            method, _, path = asked.operation.partition(" ")
            return await robot.http.request(method, path, params=asked.query)


def _shown(answer: httpx.Response, media_type: str | None) -> object:
    """Return the answer as an example; of long texts, and of measured values, only some lines."""
    if media_type in _PARSED:
        return answer.json()
    if media_type is None:
        return None
    lines = answer.text.splitlines(keepends=True)
    if media_type == CSV:
        lines = lines[:_EXCERPT_LINES]
    if media_type == "text/plain":
        lines = [line for line in lines if line.removeprefix("# HELP ").startswith(_METRICS)]
    return "".join(lines)


async def _messages(robot: HttpRobot) -> list[StreamExample]:
    """Return a message of each kind: frames as they come, and what a client may send."""
    await robot.http.post("/signals", json=dict(GOOD))
    async with WebSocketClient(robot.app, after=0, epoch="an-earlier-one") as client:
        hello, gap = await client.frame("hello"), await client.frame("gap")
        full = await client.frame("state")
        await robot.pass_time(0.1)
        client.frames()
        client.send({"type": "reading", "signal": "battery_level", "value": "full"})
        await robot.pass_time(0.05)
        problem = await client.frame("problem")
        reading = {"type": "reading", "signal": "battery_level", "value": 0.42, "source": "bench"}
        client.send(reading)
        event = await client.frame("event")
        while event["kind"] != "error.raised":
            event = await client.frame("event")
        changed = await client.frame("state")
        while "signals" not in changed:
            changed = await client.frame("state")
    return [
        StreamExample(message="hello", summary="First of all", payload=hello),
        StreamExample(message="gap", summary="After a restart", payload=gap),
        StreamExample(message="state", summary="The first, with everything", payload=full),
        StreamExample(message="state", summary="What has changed", payload=changed),
        StreamExample(message="event", summary="An error", payload=event),
        StreamExample(message="problem", summary="A reading that is none", payload=problem),
        StreamExample(message="reading", summary="From a named sender", payload=reading),
        StreamExample(
            message="resync", summary="After a loss of its own", payload={"type": "resync"}
        ),
        StreamExample(
            message="auth", summary="First of all", payload={"type": "auth", "token": "a-secret"}
        ),
    ]


if __name__ == "__main__":
    recorded = asyncio.run(record()).model_dump(mode="json")
    FILE.write_text(json.dumps(recorded, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
