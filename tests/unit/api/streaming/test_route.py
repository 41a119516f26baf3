"""`WS /ws` as a client sees it, over the real supervisor in virtual time."""

import asyncio
import json
from collections.abc import AsyncIterator

import pytest
from fastapi import FastAPI
from hypothesis import given

from api.app import create_app
from api.http.access import Access
from api.http.gate.origins import AllowedOrigins
from api.http.limits import ServiceLimits
from api.streaming import route as stream
from api.streaming import stream_server as stream_server_module
from api.streaming.stream_server import stream_server
from domain.actor import Actor
from domain.computers import ComputerName
from domain.devices.settings import DeviceSettings
from domain.inputs import EmergencyStopRequest, ModeRequest
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from service.supervisor import Supervisor
from tests.support.around_a_stop import ANY, ASKING, MEMBERS, WRAPPED, object_of
from tests.support.http_robot import http_robot
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock, settle
from tests.support.waiting import until
from tests.support.websocket import WebSocketClient

PERFORMANCE = ModeRequest(PartName("actuation"), "PERFORMANCE", Actor("operator"))


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def supervisor(clock: ManualClock) -> AsyncIterator[Supervisor]:
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        yield supervisor


@pytest.fixture
def app(supervisor: Supervisor) -> FastAPI:
    return create_app(supervisor, allowed_hosts=[])


async def in_step(client: WebSocketClient) -> None:
    """Read what is there from the start."""
    await client.frame("state")
    client.frames()


async def test_a_client_is_greeted_and_then_told_everything(
    app: FastAPI, supervisor: Supervisor
) -> None:
    async with WebSocketClient(app) as client:
        hello = await client.frame()
        state = await client.frame()

    assert hello["type"] == "hello"
    assert hello["epoch"] == supervisor.epoch
    assert state["type"] == "state"
    assert state["skipped"] == 0
    assert set(state["parts"]) == {"actuation", "drive_base", "manipulator"}
    assert len(state["signals"]) == 5


async def test_frames_come_at_twenty_a_second_without_a_gap(
    app: FastAPI, clock: ManualClock
) -> None:
    async with WebSocketClient(app) as client:
        await in_step(client)
        await clock.advance(3)
        frames = client.frames()

    states = [frame for frame in frames if frame["type"] == "state"]
    assert len(states) == 60
    assert [frame["seq"] - states[0]["seq"] for frame in states] == list(range(60))
    assert {frame["skipped"] for frame in states} == {0}


async def test_every_30_seconds_everything_is_told_again(app: FastAPI, clock: ManualClock) -> None:
    async with WebSocketClient(app, topics="parts") as client:
        await in_step(client)
        await clock.advance(100)
        complete = [frame for frame in client.frames() if len(frame.get("parts", ())) == 3]

    assert len(complete) == 3


async def test_a_client_that_asks_for_it_gets_everything_and_is_in_step_again(
    app: FastAPI, clock: ManualClock
) -> None:
    async with WebSocketClient(app) as asking, WebSocketClient(app) as other:
        await in_step(asking)
        await in_step(other)
        await clock.advance(0.1)
        asking.frames()
        other.frames()

        asking.send({"type": "resync"})
        complete = await asking.frame("state")
        await clock.advance(0.05)
        following = await asking.frame("state")

        assert {"parts", "signals", "task", "vehicle", "holds", "emergency_stop"} <= set(complete)
        assert (following["seq"], following["skipped"]) == (complete["seq"] + 1, 0)
        assert "holds" not in following
        assert [frame["seq"] for frame in other.frames()] == [following["seq"]]


async def test_an_emergency_stop_is_told_at_once_and_not_at_the_next_tick(
    app: FastAPI, supervisor: Supervisor
) -> None:
    async with WebSocketClient(app, topics="system_state") as client:
        await in_step(client)

        supervisor.submit(EmergencyStopRequest(True, "test", Actor("operator")))

        frame = await client.frame("state")
    assert frame["system_state"]["state"] == "ERROR"
    assert frame["system_state"]["errors"] == ["ESTOP"]


async def test_a_change_of_mode_is_followed_by_events_in_order(
    app: FastAPI, supervisor: Supervisor, clock: ManualClock
) -> None:
    async with WebSocketClient(app, topics="events") as client:
        await client.frame("hello")
        supervisor.submit(PERFORMANCE)
        await clock.advance(2)
        events = client.frames()

    assert {event["type"] for event in events} == {"event"}
    ids = [event["id"] for event in events]
    assert ids == list(range(ids[0], ids[0] + len(ids)))
    assert events[0]["kind"] == "change.requested"
    assert events[0]["actor"] == "operator"
    assert "change.succeeded" in {event["kind"] for event in events}


async def test_the_last_frame_of_a_change_shows_the_robot_as_it_was_asked_to_be(
    app: FastAPI, supervisor: Supervisor, clock: ManualClock
) -> None:
    parts: dict[str, object] = {}
    async with WebSocketClient(app) as client:
        await in_step(client)
        supervisor.submit(PERFORMANCE)
        await clock.advance(2)
        for frame in client.frames():
            parts |= frame.get("parts", {})

    actuation = parts["actuation"]
    assert isinstance(actuation, dict)
    assert actuation["converged"] is True
    assert actuation["actual"]["mode"] == "PERFORMANCE"


async def test_a_client_that_comes_back_gets_the_events_it_missed(
    app: FastAPI, supervisor: Supervisor, clock: ManualClock
) -> None:
    known = supervisor.events.newest
    supervisor.submit(PERFORMANCE)
    await clock.advance(2)
    newest = supervisor.events.newest

    epoch = supervisor.epoch
    async with WebSocketClient(app, topics="events", after=known, epoch=epoch) as client:
        ids = [(await client.frame("event"))["id"] for _ in range(known, newest)]

    assert ids == list(range(known + 1, newest + 1))


async def test_a_client_of_an_earlier_run_is_told_of_the_gap_and_gets_all_there_is(
    app: FastAPI, supervisor: Supervisor
) -> None:
    async with WebSocketClient(app, topics="events", after=88, epoch="earlier") as client:
        await client.frame("hello")
        gap = await client.frame()
        first = await client.frame()

    assert gap == {"type": "gap", "from": 89, "to": None, "epoch": "earlier"}
    assert (first["type"], first["id"], first["epoch"]) == ("event", 1, supervisor.epoch)


async def test_without_a_cursor_only_new_events_come(app: FastAPI, supervisor: Supervisor) -> None:
    known = supervisor.events.newest
    assert known > 0

    async with WebSocketClient(app, topics="events") as client:
        await client.frame("hello")
        supervisor.submit(EmergencyStopRequest(True, "test", Actor("operator")))
        event = await client.frame()

    assert event["id"] == known + 1


async def test_a_slow_client_skips_is_told_how_many_and_gets_everything_then(
    app: FastAPI, clock: ManualClock
) -> None:
    async with WebSocketClient(app, topics="parts,signals") as client:
        await in_step(client)
        client.stop_reading()
        await clock.advance(0.5)
        client.go_on_reading()
        await clock.advance(0.05)
        waited = await client.frame("state")
        after = await client.frame("state")

    assert waited["skipped"] == 0
    assert after["seq"] == waited["seq"] + after["skipped"] + 1
    assert after["skipped"] == 9
    assert len(after["parts"]) == 3


async def test_a_slow_client_delays_nobody(app: FastAPI, clock: ManualClock) -> None:
    async with WebSocketClient(app) as slow, WebSocketClient(app) as quick:
        await in_step(slow)
        await in_step(quick)
        slow.stop_reading()
        await clock.advance(2)
        frames = quick.frames()

    assert len([frame for frame in frames if frame["type"] == "state"]) == 40
    assert not any(frame.get("skipped") for frame in frames)


async def test_a_client_that_does_not_read_at_all_is_cut_off_within_five_seconds(
    app: FastAPI, clock: ManualClock
) -> None:
    async with WebSocketClient(app) as client:
        await in_step(client)
        client.stop_reading()
        await clock.advance(4)
        assert not client.cut_off
        await clock.advance(1)

        assert client.cut_off
        await client.end()
    assert stream_server(app).fan_out.dropped == 1
    assert stream_server(app).clients == 0


async def test_a_client_that_leaves_by_itself_is_not(app: FastAPI) -> None:
    async with WebSocketClient(app) as client:
        await in_step(client)

    assert stream_server(app).fan_out.dropped == 0


async def test_one_client_too_many_is_told_to_come_later(
    supervisor: Supervisor,
) -> None:
    app = create_app(supervisor, allowed_hosts=[], limits=ServiceLimits(stream_clients=1))

    async with WebSocketClient(app) as first, WebSocketClient(app) as second:
        assert await second.end() == 1013
        assert (await first.frame())["type"] == "hello"


async def test_nothing_is_said_to_a_client_that_went_while_it_was_let_in(
    app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = WebSocketClient(app)
    monkeypatch.setattr(client, "is_closing", lambda: True)
    async with client:
        await client.end()

    assert client.frames() == []


async def test_a_client_that_left_leaves_its_place_to_the_next(app: FastAPI) -> None:
    async with WebSocketClient(app) as client:
        await client.frame()
        assert stream_server(app).clients == 1

    assert stream_server(app).clients == 0


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ({"topics": "partz"}, "there is no topic 'partz'"),
        ({"topics": ""}, "no topic is named"),
        ({"after": "yesterday"}, "invalid event id"),
    ],
)
async def test_what_is_wrong_with_the_address_is_told_before_it_is_closed(
    app: FastAPI, query: dict[str, str], words: str
) -> None:
    async with WebSocketClient(app, "/ws", None, **query) as client:
        problem = await client.frame()

        assert await client.end() == 1008
    assert (problem["type"], problem["status"]) == ("problem", 422)
    assert words in problem["detail"]


@pytest.mark.parametrize(
    ("named", "told"), [({}, "mock"), ({"source": "left button"}, "left button")]
)
async def test_the_mock_stands_in_for_a_client_that_does_not_say_who_measured(
    named: dict[str, str], told: str, app: FastAPI, supervisor: Supervisor
) -> None:
    async with WebSocketClient(app) as client:
        await in_step(client)

        client.send({"type": "reading", "signal": "estop", "value": True, **named})
        await until(lambda: bool(supervisor.core.system_state().errors))

    assert told in supervisor.core.system_state().reasons[0].message


async def test_a_reading_over_the_stream_counts_like_any_other(
    app: FastAPI, supervisor: Supervisor
) -> None:
    async with WebSocketClient(app, topics="system_state") as client:
        await in_step(client)
        client.send({"type": "reading", "signal": "battery_level", "value": 0.2})
        frame = await client.frame("state")

    assert frame["system_state"]["errors"] == ["BATTERY_LOW"]
    assert supervisor.core.signal("battery_level").value == 0.2


STOPS = [
    '{"type":"reading","signal":"estop","value":true,"stamp":"garbage"}',
    '{"type":"reading","signal":"estop","value":true,"more":{"of":[null]}}',
    '{"type":"reading","signal":"estop","value":true,"value":false}',
    '{"type":"reading","signal":"estop","signal":"temperature","value":1}',
    '{"signal":"estop","value":"true"}',
    '{"type":7,"signal":"/estop","value":true}',
    '{"type":"reading","signal":"estop","value":true,"source":"\\ud800"}',
    '{"type":"reading","signal":"estop","value":true',
]


@pytest.mark.parametrize("text", STOPS)
async def test_a_stop_is_taken_whatever_stands_around_it_and_the_rest_is_told(
    app: FastAPI, supervisor: Supervisor, text: str
) -> None:
    async with WebSocketClient(app, topics="events") as client:
        await client.frame("hello")
        client.send_text(text)
        problem = await client.frame("problem")

    assert problem["code"] == "STOP_TAKEN"
    assert problem["detail"].startswith("the stop was taken; ignored: ")
    assert supervisor.core.signal("estop").value is True


@given(MEMBERS, ASKING, MEMBERS, WRAPPED)
def test_whatever_json_stands_around_it_a_stop_is_taken(
    before: list[tuple[str, object]],
    asking: object,
    after: list[tuple[str, object]],
    wrapped: str,
) -> None:
    asks = [("type", "reading"), ("signal", "estop"), ("value", asking)]
    text = wrapped % object_of([*before, *asks, *after])

    assert asyncio.run(_value_after([text])) is True


@given(MEMBERS, ANY, WRAPPED)
def test_only_exactly_false_releases_a_stop(
    around: list[tuple[str, object]], value: object, wrapped: str
) -> None:
    said = [*around, ("type", "reading"), ("signal", "estop"), ("value", value)]
    pressed = '{"type":"reading","signal":"estop","value":true}'

    assert asyncio.run(_value_after([pressed, wrapped % object_of(said)])) or value is False


async def _value_after(texts: list[str]) -> object:
    """Return the value of the e-stop after messages of one client."""
    supervisor = make_supervisor()
    app = create_app(supervisor, allowed_hosts=[])
    async with running(supervisor), WebSocketClient(app, topics="events") as client:
        await client.frame("hello")
        for text in texts:
            client.send_text(text)
        await settle()
    return supervisor.core.signal("estop").value


async def test_a_stop_in_a_binary_message_is_taken(app: FastAPI, supervisor: Supervisor) -> None:
    async with WebSocketClient(app, topics="events") as client:
        await client.frame("hello")
        client.send_bytes(b'{"type":"reading","signal":"estop","value":true,"source":"panel"}')
        await client.frame("problem")

    assert supervisor.core.signal("estop").source == "panel"


async def test_a_rejected_value_is_pointed_at_where_it_is_in_the_message(app: FastAPI) -> None:
    async with WebSocketClient(app, topics="events") as client:
        await client.frame("hello")
        client.send({"type": "reading", "signal": "battery_level", "value": 7})
        problem = await client.frame("problem")

    assert (problem["status"], problem["code"]) == (422, "INVALID_VALUE")
    assert [fault["pointer"] for fault in problem["errors"]] == ["/value"]


async def test_a_rejected_reading_is_counted(app: FastAPI, supervisor: Supervisor) -> None:
    async with WebSocketClient(app, topics="events") as client:
        await client.frame("hello")
        client.send({"type": "reading", "signal": "battery_level", "value": 7})
        await client.frame("problem")

    assert supervisor.refused_readings.counts == {"websocket": 1}


BAD = [
    ("{", 400),
    ('{"type":"reading","signal":"estop","value":false,"value":false}', 400),
    ('{"type":"reading","signal":"estop","value":false,"more":1}', 422),
    ('{"type":"reading","signal":"estop","value":"maybe"}', 422),
    ("", 400),
    ("[" * 30_000, 400),
    ('{"type":"reading","signal":"battery_level","value":"\\ud800"}', 400),
    ('"reading"', 422),
    ("{}", 422),
    ('{"type":"command","signal":"battery_level","value":0.8}', 422),
    ('{"type":"reading","signal":"battery_level"}', 422),
    ('{"type":"reading","signal":"battery_level","value":0.8,"more":1}', 422),
    ('{"type":"reading","signal":"battery_level","value":NaN}', 422),
    ('{"type":"reading","signal":"battery_level","value":1e999}', 422),
    ('{"type":"reading","signal":"battery_level","value":null}', 422),
    ('{"type":"reading","signal":"battery_level","value":true}', 422),
    ('{"type":"reading","signal":"battery_level","value":0.8,"stamp":"noon"}', 422),
    ('{"type":"reading","signal":"battery_level","value":0.8,"stamp":"2026-01-01T00:00:00"}', 422),
    ('{"type":"reading","signal":"no_such_signal","value":0.8}', 404),
]


@pytest.mark.parametrize(("text", "status"), BAD, ids=[text[:60] for text, _ in BAD])
async def test_a_bad_message_is_answered_with_a_problem_and_the_connection_stays(
    app: FastAPI, supervisor: Supervisor, text: str, status: int
) -> None:
    before = supervisor.core.signals()
    async with WebSocketClient(app, topics="events") as client:
        await client.frame("hello")
        client.send_text(text)
        problem = await client.frame()
        client.send({"type": "reading", "signal": "battery_level", "value": 0.3})
        event = await client.frame()

    assert (problem["type"], problem["status"]) == ("problem", status)
    assert event["data"]["values"] == {"battery_level": 0.3}
    assert before["battery_level"].value == 1.0


async def test_a_binary_message_is_answered_with_a_problem_too(app: FastAPI) -> None:
    async with WebSocketClient(app, topics="events") as client:
        await client.frame("hello")
        client.send_bytes(b"\x00")
        problem = await client.frame()

        assert problem["status"] == 422
        assert "binary" in problem["detail"]
        assert client.closed is None


async def test_a_flood_of_messages_does_not_keep_others_from_their_turn(
    app: FastAPI, clock: ManualClock
) -> None:
    text = json.dumps({"type": "reading", "signal": "battery_level", "value": 0.9})
    async with WebSocketClient(app, topics="events") as loud, WebSocketClient(app) as other:
        await in_step(other)
        for _ in range(500):
            loud.send_text(text)
        await clock.advance(0.05)

        assert (await other.frame("state"))["skipped"] == 0


TOKEN = "correct horse battery staple"


@pytest.fixture
def closed_app(supervisor: Supervisor) -> FastAPI:
    """The interface of a service that was started with a token."""
    return create_app(supervisor, allowed_hosts=[], access=Access.with_token(TOKEN))


async def test_a_client_that_gives_the_token_first_is_let_in(closed_app: FastAPI) -> None:
    async with WebSocketClient(closed_app) as client:
        client.send({"type": "auth", "token": TOKEN})

        assert (await client.frame())["type"] == "hello"
        assert (await client.frame("state"))["skipped"] == 0


async def test_a_client_that_gives_it_in_the_handshake_is_let_in(closed_app: FastAPI) -> None:
    headers = {"authorization": f"Bearer {TOKEN}"}
    async with WebSocketClient(closed_app, headers=headers) as client:
        assert (await client.frame())["type"] == "hello"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"type":"auth","token":"a guess"}', "wrong token"),
        ('{"type":"auth","token":7}', "first message"),
        ('{"type":"reading","signal":"estop","value":true}', "first message"),
        ("{", "first message"),
    ],
)
async def test_a_client_that_gives_something_else_is_told_and_sees_nothing_of_the_robot(
    closed_app: FastAPI, supervisor: Supervisor, text: str, words: str
) -> None:
    async with WebSocketClient(closed_app) as client:
        client.send_text(text)
        problem = await client.frame()

        assert await client.end() == 4401
        assert client.frames() == []
    assert (problem["type"], problem["status"]) == ("problem", 401)
    assert problem["code"] == "UNAUTHORIZED"
    assert words in problem["detail"]
    assert not supervisor.core.system_state().errors
    assert closed_app.state.refusals.counts == {401: 1}


async def test_a_client_that_says_nothing_is_closed_in_the_end(
    closed_app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stream, "AUTH_TIMEOUT_S", 0.01)
    async with WebSocketClient(closed_app) as client:
        problem = await client.frame()

        assert await client.end() == 4401
    assert "no token was sent" in problem["detail"]


async def test_the_oldest_client_without_a_token_makes_room(
    closed_app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stream_server_module, "MAX_STRANGERS", 1)
    headers = {"authorization": f"Bearer {TOKEN}"}
    async with WebSocketClient(closed_app) as oldest:
        await settle()
        async with WebSocketClient(closed_app) as owner:
            await settle()
            assert oldest.cut_off
            async with WebSocketClient(closed_app, headers=headers) as known:
                assert (await known.frame())["type"] == "hello"
            owner.send({"type": "auth", "token": TOKEN})
            assert (await owner.frame())["type"] == "hello"


async def test_a_token_that_nobody_asked_for_is_passed_over(
    app: FastAPI, supervisor: Supervisor
) -> None:
    async with WebSocketClient(app, topics="events") as client:
        await client.frame("hello")
        client.send({"type": "auth", "token": TOKEN})
        supervisor.submit(EmergencyStopRequest(True, "test", Actor("operator")))

        assert (await client.frame())["type"] == "event"


async def test_a_page_of_another_origin_reads_and_sends_no_reading_without_a_token(
    supervisor: Supervisor,
) -> None:
    allowed = AllowedOrigins(["http://grafana:3000"])
    app = create_app(supervisor, allowed_hosts=["robot"], allowed_origins=allowed)
    headers = {"host": "robot", "origin": "http://grafana:3000"}
    async with WebSocketClient(app, headers=headers) as client:
        await settle()
        client.send({"type": "reading", "signal": "estop", "value": True})
        client.send({"type": "reading", "signal": "estop", "value": True, "more": 1})
        await settle()
        problems = [frame for frame in client.frames() if frame["type"] == "problem"]

    assert [problem["code"] for problem in problems] == ["READS_ONLY", "INVALID_BODY"]
    assert supervisor.core.signal("estop").value is not True


async def test_a_reading_of_a_signal_that_a_device_reads_is_a_problem_that_names_the_device() -> (
    None
):
    base = ComputerName("base")
    own = DeviceSettings(base, (PartName("drive_base"),), ("temperature",))
    settings = SupervisionSettings(devices={base: own})
    async with http_robot(mock=False, settings=settings) as robot:
        async with WebSocketClient(robot.app) as client:
            await in_step(client)
            client.send({"type": "reading", "signal": "temperature", "value": 10})
            problem = await client.frame("problem")

        assert problem["code"] == "ACTS_ELSEWHERE"
        assert problem["detail"].startswith("temperature is read on device base")
        assert robot.supervisor.core.signal("temperature").value is None
