"""`WS /rosbridge` as a client sees it, over the real supervisor in virtual time."""

from collections.abc import AsyncIterator

import pytest
from fastapi import FastAPI

from api.app import create_app
from api.http.access import Access
from api.http.limits import ServiceLimits
from api.rosbridge import clients as clients_module
from api.rosbridge import route as rosbridge
from api.rosbridge.clients import rosbridge_clients
from api.streaming import stream_server as stream_server_module
from domain.actor import Actor
from domain.inputs import ModeRequest
from domain.state_and_mode import PartName
from service.supervisor import Supervisor
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock, settle
from tests.support.rosbridge import RosbridgeClient

TOKEN = "correct horse battery staple"


@pytest.fixture
async def supervisor(clock: ManualClock) -> AsyncIterator[Supervisor]:
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        yield supervisor


@pytest.fixture
async def app(supervisor: Supervisor) -> FastAPI:
    app = create_app(supervisor, allowed_hosts=[])
    # In a thread, for which virtual time does not wait.
    await rosbridge_clients(app).bridge()
    return app


@pytest.fixture
def closed_app(supervisor: Supervisor) -> FastAPI:
    """The interface of a service that was started with a token."""
    return create_app(supervisor, allowed_hosts=[], access=Access.with_token(TOKEN))


async def test_the_state_of_the_robot_comes_at_twenty_a_second(
    app: FastAPI, clock: ManualClock
) -> None:
    async with RosbridgeClient(app) as client:
        client.ask("subscribe", topic="/system_state", type="gem_state_msgs/SystemStateStamped")
        await settle()
        client.frames()
        await clock.advance(3)
        messages = client.frames()

    assert len(messages) == 60
    assert {message["msg"]["state"] for message in messages} == {0}


async def test_a_mode_is_changed_and_seen_to_change(app: FastAPI, clock: ManualClock) -> None:
    async with RosbridgeClient(app) as client:
        client.ask("subscribe", topic="/actuation/mode_event")
        client.ask(
            "call_service",
            service="/actuation/change_mode",
            args={"mode_name": "PERFORMANCE"},
            id="call:1",
        )
        await clock.advance(3)
        messages = client.frames()

    events = [message["msg"] for message in messages if message["op"] == "publish"]
    assert events[-1]["goal_mode"] == {"label": "PERFORMANCE"}
    (response,) = [message for message in messages if message["op"] == "service_response"]
    assert (response["values"], response["result"]) == ({"success": True}, True)


async def test_a_change_is_on_record_with_who_asked_for_it(
    app: FastAPI, supervisor: Supervisor, clock: ManualClock
) -> None:
    async with RosbridgeClient(app) as client:
        client.ask("call_service", service="actuation/change_mode", args=["PERFORMANCE"])
        await clock.advance(1)

    asked = [
        event
        for event in supervisor.events.oldest_first()
        if event.actor.label == "rosbridge:127.0.0.1"
    ]
    assert [event.kind for event in asked][:1] == ["change.requested"]


async def test_what_was_asked_before_the_first_client_came_is_told_to_it(
    app: FastAPI, supervisor: Supervisor, clock: ManualClock
) -> None:
    supervisor.submit(ModeRequest(PartName("actuation"), "PERFORMANCE", Actor("operator")))
    await clock.advance(1)

    async with RosbridgeClient(app) as client:
        client.ask("subscribe", topic="/actuation/mode_request_info")
        told = await client.next("publish")

    assert told["msg"]["goal_mode"] == {"label": "PERFORMANCE"}


async def test_a_published_stop_makes_the_robot_stop(app: FastAPI, supervisor: Supervisor) -> None:
    async with RosbridgeClient(app) as client:
        client.ask("subscribe", topic="/system_state")
        client.ask("advertise", topic="/estop", type="gem_state_msgs/EstopStamped")
        client.ask("publish", topic="/estop", msg={"enabled": True})
        message = (await client.next("publish"))["msg"]
        while message["state"] != 2:
            message = (await client.next("publish"))["msg"]

    assert message["error_code"] == 2
    assert "rosbridge:127.0.0.1" in supervisor.core.system_state().reasons[0].message


async def test_what_is_wrong_is_answered_and_the_connection_stays(app: FastAPI) -> None:
    async with RosbridgeClient(app) as client:
        client.send_text("{")
        client.ask("call_service", service="/rosapi/topics", id="call:1")

        assert (await client.next("status"))["level"] == "error"
        topics = (await client.next("service_response"))["values"]["topics"]
    assert {"/system_state", "/drive_base/mode_event", "/estop"} <= set(topics)


async def test_a_client_that_does_not_read_is_cut_off_within_five_seconds(
    app: FastAPI, clock: ManualClock
) -> None:
    async with RosbridgeClient(app) as client:
        client.ask("subscribe", topic="/system_state")
        await settle()
        client.stop_reading()
        await clock.advance(4)
        assert not client.cut_off
        await clock.advance(1)

        assert client.cut_off
        await client.end()
    assert rosbridge_clients(app).clients == 0


async def test_a_quiet_client_stays_for_as_long_as_it_answers_pings(
    app: FastAPI, clock: ManualClock
) -> None:
    async with RosbridgeClient(app) as client:
        await clock.advance(60)

        assert not client.cut_off
        assert rosbridge_clients(app).clients == 1


async def test_one_client_too_many_is_told_to_come_later(
    app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clients_module, "MAX_CLIENTS", 1)
    async with RosbridgeClient(app) as first:
        await settle()
        async with RosbridgeClient(app) as second:
            assert await second.end() == 1013

        first.ask("call_service", service="/rosapi/nodes")
        assert (await first.next("service_response"))["result"] is True


async def test_a_client_that_went_while_it_was_let_in_is_not_served(
    app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = RosbridgeClient(app)
    monkeypatch.setattr(client, "is_closing", lambda: True)
    async with client:
        await client.end()

    assert client.frames() == []


async def test_a_page_of_another_site_is_kept_out(app: FastAPI) -> None:
    headers = {"origin": "https://elsewhere.example"}

    with pytest.raises(ConnectionRefusedError):
        await RosbridgeClient(app, headers=headers).__aenter__()


@pytest.mark.parametrize("headers", [{}, {"authorization": f"Bearer {TOKEN}"}])
async def test_a_client_that_gives_the_token_is_let_in(
    closed_app: FastAPI, headers: dict[str, str]
) -> None:
    async with RosbridgeClient(closed_app, headers=headers) as client:
        client.ask("auth", token=TOKEN)
        client.ask("call_service", service="/rosapi/nodes")

        assert (await client.next("service_response"))["values"]["nodes"][0] == "/actuation"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"op":"auth","token":"a guess","id":"auth:1"}', "wrong token"),
        ('{"op":"auth","mac":"x","id":"auth:1"}', "first message"),
        ('{"op":"publish","topic":"/estop","msg":{"enabled":true},"id":"auth:1"}', "first message"),
        ("{", "first message"),
    ],
)
async def test_a_client_that_gives_something_else_is_told_and_does_nothing(
    closed_app: FastAPI, supervisor: Supervisor, text: str, words: str
) -> None:
    async with RosbridgeClient(closed_app) as client:
        client.send_text(text)
        status = await client.next("status")

        assert await client.end() == 4401
        assert client.frames() == []
    assert status["level"] == "error"
    assert words in status["msg"]
    assert not supervisor.core.system_state().errors
    assert closed_app.state.refusals.counts == {401: 1}


async def test_a_client_that_says_nothing_is_closed_in_the_end(
    closed_app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rosbridge, "AUTH_TIMEOUT_S", 0.01)
    async with RosbridgeClient(closed_app) as client:
        assert "no token was sent" in (await client.next("status"))["msg"]
        assert await client.end() == 4401


async def test_a_stranger_that_goes_is_no_refusal(closed_app: FastAPI) -> None:
    async with RosbridgeClient(closed_app) as client:
        client.leave()
        await client.end()

    assert closed_app.state.refusals.counts == {}


async def test_the_oldest_client_without_a_token_makes_room(
    closed_app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stream_server_module, "MAX_STRANGERS", 1)
    headers = {"authorization": f"Bearer {TOKEN}"}
    async with RosbridgeClient(closed_app) as oldest:
        await settle()
        async with RosbridgeClient(closed_app):
            await settle()
            assert oldest.cut_off
            async with RosbridgeClient(closed_app, headers=headers) as known:
                known.ask("call_service", service="/rosapi/nodes")
                assert (await known.next("service_response"))["result"] is True


async def test_calls_may_come_as_often_as_requests(supervisor: Supervisor) -> None:
    limits = ServiceLimits(requests_per_s=1)
    app = create_app(supervisor, allowed_hosts=[], limits=limits)
    await rosbridge_clients(app).bridge()
    async with RosbridgeClient(app) as client:
        for _ in range(3):
            client.ask("call_service", service="/actuation/get_mode")
        results = [(await client.next("service_response"))["result"] for _ in range(3)]

    assert sorted(results) == [False, True, True]
