import asyncio
import json
from typing import Any

import pytest

from api.rosbridge.read_ahead import MAX_CHARACTERS, ReadAhead, is_urgent
from tests.support.manual_clock import settle


def said(op: str, **members: object) -> dict[str, str]:
    return {"type": "websocket.receive", "text": json.dumps({"op": op, **members})}


PRESSED = said("publish", topic="/estop", msg={"enabled": True})
LARGE = {"type": "websocket.receive", "text": "x" * MAX_CHARACTERS}


async def test_messages_keep_their_order() -> None:
    ahead = ReadAhead()
    sent = [said("subscribe", topic=f"/topic_{number}") for number in range(5)]
    for message in sent:
        await ahead.put(message)

    assert [(await ahead.get())[0] for _ in sent] == sent


async def test_who_takes_waits_for_a_message() -> None:
    ahead = ReadAhead()
    taken = asyncio.create_task(ahead.get())
    await settle()
    assert not taken.done()

    await ahead.put(PRESSED)
    assert (await taken)[0] == PRESSED


async def test_no_more_is_read_than_there_is_room_for() -> None:
    ahead = ReadAhead()
    await ahead.put(LARGE)
    further = asyncio.create_task(ahead.put(PRESSED))
    await settle()
    assert not further.done()

    await ahead.get()
    await further


@pytest.mark.parametrize(
    ("message", "urgent"),
    [
        (PRESSED, True),
        (said("publish", topic="estop", msg={"enabled": 1}), True),
        (said("publish", topic="estop", msg={"data": True}), True),
        (said("publish", topic="estop", msg={"enabled": False}), False),
        (said("publish", topic="/battery_level", msg={"battery_level": 0.5}), False),
        (said("subscribe", topic="/estop"), False),
        (said("publish", topic="/estop", msg={"enabled": True, "padding": "x" * 1_000}), False),
        ({"type": "websocket.disconnect", "code": 1000}, False),
        ({"type": "websocket.receive", "bytes": b"estop publish"}, False),
    ],
)
def test_only_what_asks_for_a_stop_is_urgent(message: dict[str, object], urgent: bool) -> None:
    assert is_urgent(message) is urgent


async def test_what_publishes_faster_than_it_is_heard_replaces_its_own_messages() -> None:
    ahead = ReadAhead()
    await ahead.put(said("call_service", service="/cancel_tasks"))
    for number in range(10_000):
        message = said("publish", topic="/estop", msg={"enabled": False, "n": number})
        await asyncio.wait_for(ahead.put(message), 1)
    end = asyncio.create_task(ahead.put({"type": "websocket.disconnect", "code": 1000}))

    heard: list[Any] = []
    while not heard or heard[-1]["type"] != "websocket.disconnect":
        heard.append((await ahead.get())[0])

    await end
    assert "cancel_tasks" in heard[0]["text"]
    assert len(heard) < MAX_CHARACTERS // 100
    assert '"n": 9999' in heard[-2]["text"]


async def test_what_asks_for_a_stop_is_never_replaced() -> None:
    ahead = ReadAhead()
    long = said("publish", topic="/estop", msg={"enabled": True, "padding": "x" * 1_000})
    await ahead.put(long)
    await ahead.put(LARGE)
    further = asyncio.create_task(ahead.put(said("publish", topic="/estop", msg={"data": False})))
    await settle()
    assert not further.done()

    assert (await ahead.get())[0] == long
    await ahead.get()
    await further


async def test_a_stop_overtakes_what_came_before_it_and_nothing_that_comes_after() -> None:
    ahead = ReadAhead()
    await ahead.put(PRESSED)
    ahead.overtake()
    await ahead.put(PRESSED)

    assert ahead.is_overtaken((await ahead.get())[1])
    assert not ahead.is_overtaken((await ahead.get())[1])
