"""What a client of rosbridge says, and what it hears, without a network."""

import asyncio
import json
from collections.abc import AsyncIterator, Coroutine
from typing import Any

import pytest

from api.rosbridge import session as session_module
from api.rosbridge.send_queue import SendQueue
from api.rosbridge.session import MAX_CALLS, Session
from domain.actor import Actor
from tests.support.manual_clock import settle
from tests.support.rosbridge import (
    MODE_EVENT,
    MODE_REQUEST,
    SYSTEM_STATE,
    SmallInterface,
    make_bridge,
)


class Talk:
    """One session, and what it was told."""

    def __init__(self, calls_per_s: int = 1_000, *, reads_only: bool = False) -> None:
        self.interface = SmallInterface()
        self.calls: list[asyncio.Task[None]] = []
        self._queue = SendQueue(lambda: None)
        self.bridge = make_bridge(self.interface, calls_per_s=calls_per_s)
        self.session = Session(
            self.bridge,
            self._queue,
            Actor(way="rosbridge", address="test"),
            self._spawn,
            reads_only=reads_only,
        )

    def say(self, op: str, **members: object) -> None:
        self.session.hear({"text": json.dumps({"op": op, **members})})

    def heard(self) -> list[dict[str, Any]]:
        return [json.loads(text) for text in self._queue.take(0)]

    def only(self) -> dict[str, Any]:
        (found,) = self.heard()
        return found

    async def answer(self) -> dict[str, Any]:
        await settle()
        return self.only()

    def _spawn(self, call: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        task = asyncio.ensure_future(call)
        self.calls.append(task)
        return task


@pytest.fixture
async def talk() -> AsyncIterator[Talk]:
    talk = Talk()
    yield talk
    talk.session.end()
    await asyncio.gather(*talk.calls, return_exceptions=True)


# --- subscriptions -------------------------------------------------------------------------------


async def test_a_subscriber_hears_a_topic_by_the_name_it_used(talk: Talk) -> None:
    talk.say("subscribe", topic="actuation/mode_event", type="system_modes_msgs/ModeEvent")
    talk.interface.tell(MODE_EVENT, {"goal_mode": {"label": "FAST"}})

    assert talk.only() == {
        "op": "publish",
        "topic": "actuation/mode_event",
        "msg": {"goal_mode": {"label": "FAST"}},
    }


async def test_a_late_comer_hears_what_was_asked_last(talk: Talk) -> None:
    talk.interface.last = {"goal_mode": {"label": "FAST"}}

    talk.say("subscribe", topic="/actuation/mode_request_info")

    assert talk.only()["msg"] == talk.interface.last


async def test_two_subscriptions_of_a_topic_hear_each_message_once(talk: Talk) -> None:
    talk.say("subscribe", topic="/actuation/mode_event", id="a")
    talk.say("subscribe", topic="/actuation/mode_event", id="b")
    talk.interface.tell(MODE_EVENT, {})

    assert len(talk.heard()) == 1


async def test_a_topic_is_heard_until_its_last_subscription_ends(talk: Talk) -> None:
    talk.say("subscribe", topic="/actuation/mode_event", id="a")
    talk.say("subscribe", topic="/actuation/mode_event", id="b")
    talk.say("unsubscribe", topic="/actuation/mode_event", id="a")
    assert talk.interface.listens(MODE_EVENT) == 1

    talk.say("unsubscribe", topic="/actuation/mode_event", id="b")

    assert talk.interface.listens(MODE_EVENT) == 0
    assert talk.heard() == []


async def test_without_an_id_all_subscriptions_of_a_topic_end(talk: Talk) -> None:
    for name in ("a", "b"):
        talk.say("subscribe", topic="/system_state", id=name)
    talk.interface.tell(SYSTEM_STATE, {"state": 1})

    talk.say("unsubscribe", topic="/system_state")

    assert talk.interface.listens(SYSTEM_STATE) == 0
    assert talk.heard() == []


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"topic": "/nothing"}, "there is no topic '/nothing' (/rosapi/topics lists"),
        ({"topic": "/estop"}, "/estop can only be published to"),
        ({"topic": "/system_state", "type": "std_msgs/Bool"}, "is pilothouse_msgs/msg/SystemState"),
        ({"topic": ""}, "/topic"),
    ],
)
async def test_a_subscription_that_cannot_be_is_answered_with_an_error(
    talk: Talk, asked: dict[str, str], words: str
) -> None:
    talk.say("subscribe", id="subscribe:1", **asked)

    status = talk.only()
    assert (status["op"], status["level"], status["id"]) == ("status", "error", "subscribe:1")
    assert words in status["msg"]
    assert talk.interface.listens(SYSTEM_STATE) == 0


@pytest.mark.parametrize("asked", [{"compression": "cbor"}, {"fragment_size": 1_000}])
async def test_who_asks_for_another_form_is_warned_and_gets_the_usual_one(
    talk: Talk, asked: dict[str, object]
) -> None:
    talk.say("subscribe", topic="/actuation/mode_event", **asked)
    talk.interface.tell(MODE_EVENT, {})

    warning, message = talk.heard()
    assert (warning["op"], warning["level"]) == ("status", "warning")
    assert message == {"op": "publish", "topic": "/actuation/mode_event", "msg": {}}


async def test_no_client_has_subscriptions_without_end(
    talk: Talk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(session_module, "MAX_SUBSCRIPTIONS", 2)
    for name in ("a", "b"):
        talk.say("subscribe", topic="/system_state", id=name)

    talk.say("subscribe", topic="/actuation/mode_event")

    assert "too many subscriptions" in talk.only()["msg"]
    assert talk.interface.listens(MODE_EVENT) == 0


@pytest.mark.parametrize("ended", [{"id": "a"}, {}])
async def test_a_subscription_that_ended_makes_room_for_another(
    talk: Talk, monkeypatch: pytest.MonkeyPatch, ended: dict[str, str]
) -> None:
    monkeypatch.setattr(session_module, "MAX_SUBSCRIPTIONS", 1)
    talk.say("subscribe", topic="/system_state", id="a")
    talk.say("unsubscribe", topic="/system_state", **ended)

    talk.say("subscribe", topic="/actuation/mode_event")

    assert talk.heard() == []
    assert talk.interface.listens(MODE_EVENT) == 1


@pytest.mark.parametrize("asked", [{"topic": "/nothing"}, {"topic": "/system_state", "id": "b"}])
async def test_to_end_what_was_not_begun_is_warned_of(talk: Talk, asked: dict[str, str]) -> None:
    talk.say("subscribe", topic="/system_state", id="a")

    talk.say("unsubscribe", **asked)

    assert talk.only()["level"] == "warning"
    assert talk.interface.listens(SYSTEM_STATE) == 1


async def test_when_a_client_goes_nothing_is_listened_to_any_more(talk: Talk) -> None:
    talk.say("subscribe", topic="/system_state")
    talk.say("subscribe", topic="/actuation/mode_request_info")

    talk.session.end()

    assert talk.interface.listens(SYSTEM_STATE) == 0
    assert talk.interface.listens(MODE_REQUEST) == 0


# --- publishing ----------------------------------------------------------------------------------


@pytest.mark.parametrize("topic", ["/estop", "estop"])
@pytest.mark.parametrize(
    "type_name", ["pilothouse_msgs/EmergencyStop", "gem_state_msgs/EstopStamped"]
)
async def test_a_reading_is_published_under_the_names_of_the_client(
    talk: Talk, topic: str, type_name: str
) -> None:
    talk.say("advertise", topic=topic, type=type_name, latch=False)
    talk.say("publish", topic=topic, msg={"enabled": True})
    talk.say("unadvertise", topic=topic)

    assert talk.interface.readings == [({"enabled": True}, Actor(way="rosbridge", address="test"))]
    assert talk.heard() == []


async def test_a_reading_that_is_refused_is_answered_with_an_error(talk: Talk) -> None:
    talk.say("publish", topic="/estop", msg={"enabled": "yes"}, id="publish:1")

    status = talk.only()
    assert (status["level"], status["id"]) == ("error", "publish:1")
    assert "enabled must be" in status["msg"]


@pytest.mark.parametrize("first", ["advertise", "publish"])
async def test_that_nobody_hears_a_topic_is_told_once(talk: Talk, first: str) -> None:
    talk.say(first, topic="/cmd_vel", type="geometry_msgs/Twist", msg={})
    assert "there is no subscriber of '/cmd_vel'" in talk.only()["msg"]

    talk.say("publish", topic="/cmd_vel", msg={})
    talk.say("publish", topic="/cmd_vel", msg={})

    assert talk.heard() == []


async def test_a_topic_of_another_type_is_refused_when_it_is_advertised(talk: Talk) -> None:
    talk.say("advertise", topic="/estop", type="std_msgs/Bool")

    assert "/estop is pilothouse_msgs/msg/EmergencyStop" in talk.only()["msg"]


async def test_to_end_what_was_not_advertised_is_warned_of(talk: Talk) -> None:
    talk.say("unadvertise", topic="/estop", id="unadvertise:1")

    status = talk.only()
    assert (status["level"], status["id"]) == ("warning", "unadvertise:1")


async def test_no_client_makes_us_remember_topics_without_end(
    talk: Talk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(session_module, "_MAX_PUBLISHED", 1)
    talk.say("publish", topic="/a", msg={})
    talk.say("publish", topic="/b", msg={})
    talk.say("publish", topic="/a", msg={})

    assert [status["level"] for status in talk.heard()] == ["error"] * 3


# --- calls ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("args", [{"mode_name": "FAST"}, ["FAST"]])
@pytest.mark.parametrize("service", ["/actuation/change_mode", "actuation/change_mode"])
async def test_a_call_is_answered_when_it_is_done(talk: Talk, service: str, args: object) -> None:
    talk.say("call_service", service=service, args=args, id="call:1")
    await settle()
    assert talk.heard() == []

    talk.interface.answer.set()

    assert await talk.answer() == {
        "op": "service_response",
        "id": "call:1",
        "service": service,
        "values": {"success": True},
        "result": True,
    }
    assert talk.interface.asked == [({"mode_name": "FAST"}, Actor(way="rosbridge", address="test"))]


async def test_a_call_without_values_and_id_is_answered_without_an_id(talk: Talk) -> None:
    talk.say("call_service", service="/actuation/get_mode")

    response = await talk.answer()
    assert response["values"] == {"current_mode": "SLOW"}
    assert "id" not in response


async def test_a_call_that_takes_long_keeps_no_other_from_its_answer(talk: Talk) -> None:
    talk.say("call_service", service="/actuation/change_mode", args=["FAST"], id="slow")
    talk.say("call_service", service="/actuation/get_mode", id="quick")

    assert (await talk.answer())["id"] == "quick"


@pytest.mark.parametrize(
    ("service", "args", "words"),
    [
        ("/nothing", {}, "there is no service /nothing"),
        ("/actuation/change_mode", {"mode_name": 7}, "mode_name must be a text"),
        ("/actuation/change_mode", ["FAST", "SLOW"], "2 values were sent"),
    ],
)
async def test_a_call_that_fails_says_why_and_has_no_result(
    talk: Talk, service: str, args: object, words: str
) -> None:
    talk.say("call_service", service=service, args=args, id="call:1")

    response = await talk.answer()
    assert (response["result"], response["id"]) == (False, "call:1")
    assert words in response["values"]


async def test_a_client_need_not_wait_longer_than_it_wants(talk: Talk) -> None:
    talk.say("call_service", service="/actuation/change_mode", args=["FAST"], timeout=0.01)

    await asyncio.gather(*talk.calls)

    response = talk.only()
    assert response["result"] is False
    assert response["values"] == "/actuation/change_mode did not answer within 0.01 s"


async def test_one_call_too_many_is_answered_at_once_and_not_made(talk: Talk) -> None:
    for _ in range(MAX_CALLS + 1):
        talk.say("call_service", service="/actuation/change_mode", args=["FAST"])

    assert (await talk.answer())["values"] == "too many pending calls: at most 16"
    assert len(talk.interface.asked) == MAX_CALLS
    talk.interface.answer.set()
    await settle()
    talk.heard()
    talk.say("call_service", service="/actuation/get_mode")
    assert (await talk.answer())["result"] is True


async def test_a_call_too_soon_is_answered_at_once_and_not_made() -> None:
    talk = Talk(calls_per_s=1)
    talk.interface.answer.set()
    for _ in range(3):
        talk.say("call_service", service="/actuation/change_mode", args=["FAST"])
    await asyncio.gather(*talk.calls)

    responses = talk.heard()
    assert sorted(response["result"] for response in responses) == [False, True, True]
    assert responses[0]["values"] == "more than 1 calls a second came from this address"
    assert len(talk.interface.asked) == 2


async def test_when_a_client_goes_nobody_waits_for_its_calls(talk: Talk) -> None:
    talk.say("call_service", service="/actuation/change_mode", args=["FAST"])
    await settle()

    talk.session.end()
    await settle()

    assert [call.cancelled() for call in talk.calls] == [True]


# --- the rest ------------------------------------------------------------------------------------


async def test_a_message_that_is_no_operation_is_answered_with_an_error(talk: Talk) -> None:
    talk.session.hear({"bytes": b"\x00"})
    talk.session.hear({"text": "{"})
    talk.say("subscibe", id=7)

    binary, broken, unknown = talk.heard()
    assert {binary["level"], broken["level"], unknown["level"]} == {"error"}
    assert unknown["id"] == 7


@pytest.mark.parametrize(
    ("level", "told"),
    [
        ("info", ["warning", "error"]),
        ("warning", ["warning", "error"]),
        ("error", ["error"]),
        ("none", []),
    ],
)
async def test_a_client_chooses_what_it_is_told(talk: Talk, level: str, told: list[str]) -> None:
    talk.say("set_level", level=level, id="roslibpy always sends one")

    talk.say("unadvertise", topic="/estop")
    talk.say("publish", topic="/nothing", msg={})

    assert [status["level"] for status in talk.heard()] == told


async def test_a_token_that_nobody_asked_for_is_passed_over(talk: Talk) -> None:
    talk.say("auth", token="secret")

    assert talk.heard() == []


# --- a stop is taken whatever stands around it ---------------------------------------------------

STOPS = [
    '{"op":"publish","topic":"/estop","msg":{"enabled":true,"enabled":false}}',
    '{"op":"publish","topic":"/estop","msg":{"enabled":true},"msg":{"enabled":false}}',
    '{"op":"publish","topic":"/temperature","topic":"estop","msg":{"data":1}}',
    '{"op":"publish","topic":"/estop","msg":{"enabled":true},"id":{"of":[]}}',
    '{"op":"publish","op":"subscribe","topic":"/estop","msg":{"enabled":"true"}}',
    '{"op":"publish","topic":"/estop","msg":{"enabled":true,"frame_id":"\\ud800"}}',
    '{"op":"publish","topic":"/estop","msg":{"enabled":true,"x":' + "1" * 5_000 + "}}",
    '{"op":"publish","topic":"/estop","msg":{"enabled":true}',
    '{"topic":"/estop","msg":{"enabled":true}}',
    '{"op":"publish","topic":"/estop","enabled":true}',
    '[{"op":"publish","topic":"//estop","msg":{"data":true}}]',
]


@pytest.mark.parametrize("text", STOPS)
def test_a_stop_is_taken_and_what_was_ignored_is_told(talk: Talk, text: str) -> None:
    talk.session.hear({"text": text})

    assert [fields for fields, _ in talk.interface.readings] == [{"enabled": True}]
    told = talk.only()
    assert (told["level"], told["msg"][:29]) == ("warning", "the stop was taken; ignored: ")


def test_a_stop_in_a_binary_message_is_taken(talk: Talk) -> None:
    talk.session.hear({"bytes": b'{"op":"publish","topic":"/estop","msg":{"enabled":true}}'})

    assert [fields for fields, _ in talk.interface.readings] == [{"enabled": True}]


@pytest.mark.parametrize("type_name", [None, "std_msgs/Bool", "gem_state_msgs/EstopStamped"])
def test_a_stop_is_taken_whatever_type_was_advertised(talk: Talk, type_name: str | None) -> None:
    talk.say("advertise", topic="/estop", type=type_name)
    talk.say("publish", topic="estop", msg={"enabled": True})

    assert [fields for fields, _ in talk.interface.readings] == [{"enabled": True}]


def test_a_release_that_a_stop_has_overtaken_is_void(talk: Talk) -> None:
    release = {"op": "publish", "topic": "/estop", "msg": {"enabled": False}}
    talk.session.hear({"text": json.dumps(release)}, overtaken=True)
    talk.session.hear({"text": json.dumps({**release, "msg": {"enabled": True}})}, overtaken=True)

    assert [fields for fields, _ in talk.interface.readings] == [{"enabled": True}]


@pytest.mark.parametrize(
    ("text", "response"),
    [
        ('{"op":"call_service","service":7,"id":"a"}', ("", "a")),
        ('{"op":"call_service","service":"/x","args":"?","id":[1]}', ("/x", None)),
        ('{"op":"call_service","service":"/x","id":"a","id":"b"}', ("/x", "a")),
        ('{"op":"call_service","service":"/x","id":12345678901234567}', None),
        ('{"op":"call_service","id":7}', ("", 7)),
        ('{"op":"call_service","service":"\\ud800","id":"a"}', ("?", "a")),
        ('{"op":"call_service"}', ("", None)),
        ('{"op":"call_service","service":["/x"],"id":{}}', ("", None)),
        ('{"op":"call_service","service":"/x","id":"a","args":{"mode_name":', ("/x", "a")),
        ('{\'op\':\'x\', "op": "call_service", "id": 7,}', ("", 7)),
    ],
)
async def test_a_call_that_cannot_be_read_is_answered_as_a_call(
    talk: Talk, text: str, response: tuple[str, object] | None
) -> None:
    talk.session.hear({"text": text})
    told = talk.only()

    assert (told["op"], told["result"]) == ("service_response", False)
    if response is not None:
        assert (told["service"], told.get("id")) == response


def test_a_message_that_cannot_be_read_is_counted_as_a_refused_reading(talk: Talk) -> None:
    talk.session.hear({"text": '{"op":"publish","topic":"/battery_level","msg":7}'})

    assert talk.bridge.refused.counts == {"rosbridge": 1}


# --- a page of another origin, without a token ---------------------------------------------------


async def test_who_may_only_read_subscribes_and_changes_nothing() -> None:
    talk = Talk(reads_only=True)

    talk.say("subscribe", topic=SYSTEM_STATE.name)
    assert not [said for said in talk.heard() if said["op"] == "status"]
    for op, members in (
        ("publish", {"topic": "/estop", "msg": {"enabled": True}}),
        ("call_service", {"service": MODE_REQUEST.name, "args": {}}),
    ):
        talk.say(op, **members)
        told = talk.only()
        assert "may only read" in told["msg" if op == "publish" else "values"]
    talk.session.hear({"text": '{"op":"publish","topic":"/estop","msg":{"enabled":true},"x"'})
    assert "not JSON" in talk.only()["msg"]
    assert not talk.calls
    assert not talk.interface.readings
    talk.session.end()
