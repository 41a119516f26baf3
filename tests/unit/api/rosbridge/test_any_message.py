"""Whatever a client says is done or answered, and is no fault of ours."""

import asyncio
import json
from collections.abc import Coroutine
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from api.rosbridge.bridge import Bridge
from api.rosbridge.operations import OPERATIONS
from api.rosbridge.send_queue import SendQueue
from api.rosbridge.session import Session
from domain.actor import Actor
from service.ros.interface.interface import RosInterface
from tests.support.live_robot import make_supervisor
from tests.support.manual_clock import settle

_JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=20),
    lambda below: (
        st.lists(below, max_size=4) | st.dictionaries(st.text(max_size=10), below, max_size=4)
    ),
    max_leaves=10,
)
_TOPICS = st.sampled_from(["/system_state", "/actuation/mode_event", "/estop", "temperature", "x"])
_SERVICES = st.sampled_from(
    ["/actuation/change_mode", "drive_base/change_state", "/rosapi/topic_type", "/cancel_tasks"]
)
_FIELDS = st.sampled_from(
    ["enabled", "temperature", "header", "stamp", "mode_name", "transition", "label", "topic"]
)
_MESSAGES = st.recursive(
    _JSON, lambda below: st.dictionaries(_FIELDS, below, max_size=3), max_leaves=4
)
_SAID = st.fixed_dictionaries(
    {"op": st.sampled_from([*OPERATIONS, "fragment", ""]) | _JSON},
    optional={
        "topic": _TOPICS | _JSON,
        "service": _SERVICES | _JSON,
        "args": _MESSAGES,
        "msg": _MESSAGES,
        "id": st.text(max_size=5) | _JSON,
        "type": _JSON,
        "throttle_rate": _JSON,
        "queue_length": _JSON,
        "compression": _JSON,
        "level": st.sampled_from(["info", "none"]) | _JSON,
        "token": _JSON,
    },
)


@given(st.lists(_SAID, max_size=6))
def test_whatever_is_said_is_done_or_answered(said: list[dict[str, Any]]) -> None:
    answers, faults = asyncio.run(_say([json.dumps(message) for message in said]))

    assert faults == []
    assert {answer["op"] for answer in answers} <= {"status", "service_response", "publish"}


_STOP_AROUND = st.dictionaries(_FIELDS | st.sampled_from(["seq", "data"]), _MESSAGES, max_size=3)


@given(
    _STOP_AROUND,
    st.dictionaries(st.sampled_from(["id", "type", "latch", "throttle_rate"]), _JSON, max_size=3),
    st.sampled_from(["enabled", "data"]),
    st.sampled_from([True, 1, "true"]),
    st.booleans(),
)
def test_whatever_stands_around_it_a_stop_is_taken(
    inner: dict[str, Any], outer: dict[str, Any], field: str, asking: object, again: bool
) -> None:
    message = {**inner, field: asking}
    text = json.dumps({"op": "publish", "topic": "/estop", **outer, "msg": message})
    if again:
        text = f'{text[:-1]},"msg":{{"enabled":false}}}}'

    assert asyncio.run(_is_stopped_by([text]))


@given(_STOP_AROUND, _JSON)
def test_only_exactly_false_releases_a_stop(inner: dict[str, Any], value: object) -> None:
    pressed = json.dumps({"op": "publish", "topic": "/estop", "msg": {"enabled": True}})
    said = json.dumps({"op": "publish", "topic": "/estop", "msg": {**inner, "enabled": value}})

    assert asyncio.run(_is_stopped_by([pressed, said])) or value is False


async def _is_stopped_by(texts: list[str]) -> bool:
    supervisor = make_supervisor()
    bridge = Bridge(
        RosInterface(supervisor),
        supervisor.frames,
        supervisor.clock,
        1_000,
        supervisor.refused_readings,
    )
    session = Session(bridge, SendQueue(lambda: None), Actor("test"), asyncio.ensure_future)
    for text in texts:
        session.hear({"text": text})
    return supervisor.core.signal("estop").value is True


async def _say(texts: list[str]) -> tuple[list[dict[str, Any]], list[Exception]]:
    """Return what was sent back, and what calls raised."""
    supervisor = make_supervisor()
    queue = SendQueue(lambda: None)
    calls: list[asyncio.Task[None]] = []

    def spawn(call: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        calls.append(asyncio.ensure_future(call))
        return calls[-1]

    bridge = Bridge(
        RosInterface(supervisor),
        supervisor.frames,
        supervisor.clock,
        1_000,
        supervisor.refused_readings,
    )
    session = Session(bridge, queue, Actor("rosbridge:test"), spawn)
    for text in texts:
        session.hear({"text": text})
        await settle()
    session.end()
    ends = await asyncio.gather(*calls, return_exceptions=True)
    faults = [end for end in ends if isinstance(end, Exception)]
    return [json.loads(text) for text in queue.take(0)], faults
