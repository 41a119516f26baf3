import asyncio
import json

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

    assert [await ahead.get() for _ in sent] == sent


async def test_who_takes_waits_for_a_message() -> None:
    ahead = ReadAhead()
    taken = asyncio.create_task(ahead.get())
    await settle()
    assert not taken.done()

    await ahead.put(PRESSED)
    assert await taken == PRESSED


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
        (said("publish", topic="estop", msg={"enabled": False}), True),
        (said("publish", topic="/battery_level", msg={"battery_level": 0.5}), False),
        (said("subscribe", topic="/estop"), False),
        (said("publish", topic="/estop", msg={"padding": "x" * 1_000}), False),
        ({"type": "websocket.disconnect", "code": 1000}, False),
        ({"type": "websocket.receive", "bytes": b"estop publish"}, False),
    ],
)
def test_only_a_reading_of_the_emergency_stop_is_urgent(
    message: dict[str, object], urgent: bool
) -> None:
    assert is_urgent(message) is urgent
