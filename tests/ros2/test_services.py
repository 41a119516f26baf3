"""Services of ours that take their time, asked by another link."""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import pytest

from service.ros.graph.crossing import MAX_UNANSWERED
from service.ros.graph.graph import Client, Lane
from tests.ros2.support.links import WITHIN_S, Link, a_link, ready

pytestmark = pytest.mark.ros2

TRIGGER = "std_srvs/srv/Trigger"
SET_BOOL = "std_srvs/srv/SetBool"
QUIET_S = 0.3


async def test_a_slow_answer_keeps_nobody_else_waiting(link: Link) -> None:
    release = asyncio.Event()

    async def answer(request: Any) -> dict[str, object]:  # noqa: ANN401
        if request["data"]:
            await release.wait()
        return {"success": request["data"], "message": "done"}

    link.node("pilothouse", Lane.GATEWAY).serve("/work", SET_BOOL, answer)
    async with a_link() as other:
        client = await ready(other.node("asker", Lane.STATES).client("/work", SET_BOOL))
        slow = asyncio.create_task(client.call({"data": True}, WITHIN_S))
        quick = await client.call({"data": False}, WITHIN_S)
        assert not slow.done()
        release.set()
        answered = await slow

    assert (quick.success, quick.message) == (False, "done")
    assert (answered.success, answered.message) == (True, "done")


async def test_waiting_for_a_slow_answer_costs_no_processor_time(link: Link) -> None:
    begun = asyncio.Event()

    async def answer(_request: object) -> dict[str, object]:
        begun.set()
        await asyncio.Event().wait()
        return {}

    link.node("pilothouse", Lane.GATEWAY).serve("/work", TRIGGER, answer)
    async with a_link() as other:
        client = await ready(other.node("asker", Lane.STATES).client("/work", TRIGGER))
        asking = asyncio.create_task(client.call({}, WITHIN_S))
        await begun.wait()
        # Counted, not timed: what polls without a pause goes round thousands of times here.
        rounds = count_rounds(link, Lane.GATEWAY)
        await asyncio.sleep(QUIET_S)
        asking.cancel()
        await asyncio.wait([asking])

    assert len(rounds) < 20


def count_rounds(link: Link, lane: Lane) -> list[None]:
    """Count from now on how often the thread of a lane wakes up."""
    executor = link._spinners[lane].executor  # noqa: SLF001  # nothing else can tell
    rounds: list[None] = []
    spin_once: Callable[[], None] = executor.spin_once

    def counted() -> None:
        rounds.append(None)
        spin_once()

    executor.spin_once = counted
    return rounds


async def test_more_requests_than_can_wait_get_an_empty_answer(
    link: Link, caplog: pytest.LogCaptureFixture
) -> None:
    turns = asyncio.Semaphore(0)

    async def answer(_request: object) -> dict[str, object]:
        await turns.acquire()
        return {"success": True}

    link.node("pilothouse", Lane.GATEWAY).serve("/work", TRIGGER, answer)
    async with a_link() as other:
        client = await ready(other.node("asker", Lane.STATES).client("/work", TRIGGER))
        # The way back may be found later than the way there: what is answered before is lost.
        await _answered(client, turns)
        waiting = {
            asyncio.create_task(client.call({}, WITHIN_S)) for _ in range(MAX_UNANSWERED + 1)
        }
        refused, waiting = await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
        answered = []
        while waiting:
            # One by one, since a client of ROS misses responses if more than 10 come at once.
            turns.release()
            done, waiting = await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
            answered += [task.result().success for task in done]
        again = await _answered(client, turns)

    assert [task.result().success for task in refused] == [False]
    assert answered == [True] * MAX_UNANSWERED
    assert again.success
    assert f"/work: {MAX_UNANSWERED} requests wait" in caplog.text


async def _answered(client: Client, turns: asyncio.Semaphore) -> Any:  # noqa: ANN401
    """Return an answer; the middleware may lose the first one, and one after a hundred."""
    for _ in range(3):
        turns.release()
        with suppress(TimeoutError):
            return await client.call({}, WITHIN_S)
    raise TimeoutError


async def test_a_fault_in_an_answer_is_an_empty_one(
    link: Link, caplog: pytest.LogCaptureFixture
) -> None:
    async def answer(_request: object) -> dict[str, object]:
        return {"success": "yes"}

    link.node("pilothouse", Lane.GATEWAY).serve("/work", TRIGGER, answer)
    client = await ready(link.node("asker", Lane.STATES).client("/work", TRIGGER))

    response = await client.call({}, WITHIN_S)

    assert not response.success
    assert "/work: a request gets an empty response" in caplog.text
