import asyncio
import json

import pytest
from starlette.types import Message, Receive, Scope, Send

from api.http.gate.ending import Ending
from tests.support.asgi import websocket_scope
from tests.support.http_robot import http_scope


async def _work_for_ever(_scope: Scope, _receive: Receive, _send: Send) -> None:
    await asyncio.Event().wait()


async def _answer_for_ever(_scope: Scope, _receive: Receive, send: Send) -> None:
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await asyncio.Event().wait()


async def _cancelled(app: Ending, scope: Scope) -> list[Message]:
    sent: list[Message] = []

    async def send(message: Message) -> None:
        sent.append(message)

    async def receive() -> Message:
        return {"type": "http.request"}

    task = asyncio.create_task(app(scope, receive, send))
    await asyncio.sleep(0)
    task.cancel()
    await task
    return sent


async def test_a_request_that_is_cut_off_is_told_that_the_service_ends() -> None:
    start, body = await _cancelled(Ending(_work_for_ever), http_scope("GET", "/tasks"))

    problem = json.loads(body["body"])
    assert start["status"] == problem["status"] == 503
    assert (problem["code"], problem["instance"]) == ("ENDING", "/tasks")


@pytest.mark.parametrize(
    ("app", "scope", "count"),
    [(_answer_for_ever, http_scope("GET", "/"), 1), (_work_for_ever, websocket_scope({}), 0)],
)
async def test_what_has_begun_and_a_websocket_just_end(
    app: object, scope: Scope, count: int
) -> None:
    assert len(await _cancelled(Ending(app), scope)) == count  # type: ignore[arg-type]
