"""`GET /events`: the log for those who ask now and then."""

import asyncio
from collections.abc import AsyncIterator
from typing import Any

import httpx
import pytest

from api.app import create_app
from api.streaming.encoder import StreamEncoder
from domain.actor import Actor
from domain.events.event import RecordedEvent
from domain.inputs import ModeRequest
from domain.state_and_mode import PartName
from service.event_log import EventReader, Gap
from service.supervisor import Supervisor
from tests.support.frames import RareHappened, event
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.websocket import WebSocketClient


@pytest.fixture
async def supervisor() -> AsyncIterator[Supervisor]:
    """A robot that was brought into PERFORMANCE."""
    clock = ManualClock()
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        supervisor.submit(ModeRequest(PartName("actuation"), "PERFORMANCE", Actor("operator")))
        await clock.advance(2)
        yield supervisor


@pytest.fixture
async def http(supervisor: Supervisor) -> AsyncIterator[httpx.AsyncClient]:
    app = create_app(supervisor, allowed_hosts=[])
    transport = httpx.ASGITransport(app)
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000") as client:
        yield client


async def events(http: httpx.AsyncClient, **query: str | int) -> dict[str, Any]:
    answer = await http.get("/events", params=query)
    assert answer.status_code == 200
    found = answer.json()
    assert isinstance(found, dict)
    return found


def ids(found: dict[str, Any]) -> list[int]:
    return [item["id"] for item in found["items"]]


async def test_the_log_tells_how_the_change_came_about_and_ended(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    found = await events(http)

    kinds = [item["kind"] for item in found["items"]]
    assert kinds.index("change.requested") < kinds.index("change.succeeded")
    assert ids(found) == sorted(ids(found))
    assert (found["epoch"], found["oldest"]) == (supervisor.epoch, 1)
    assert found["newest"] == supervisor.events.newest
    assert found["gaps"] == []


async def test_without_a_cursor_the_newest_are_told(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    newest = supervisor.events.newest

    assert ids(await events(http, limit=3)) == [newest - 2, newest - 1, newest]


async def test_a_cursor_leads_through_the_whole_log_in_portions(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    found: list[int] = []
    while portion := ids(await events(http, after=found[-1] if found else 0, limit=4)):
        found += portion

    assert found == list(range(1, supervisor.events.newest + 1))


async def test_events_are_chosen_by_their_kind_or_by_its_beginning(
    http: httpx.AsyncClient,
) -> None:
    exact = await events(http, kind="change.succeeded", limit=1_000)
    area = await events(http, kind="change", after=0, limit=1_000)

    assert [item["kind"] for item in exact["items"]] == ["change.succeeded"]
    assert {item["kind"].partition(".")[0] for item in area["items"]} == {"change"}
    assert (await events(http, kind="chang"))["items"] == []


async def test_a_kind_is_found_however_far_behind_the_cursor_it_is(
    http: httpx.AsyncClient,
) -> None:
    found = await events(http, kind="change.succeeded", after=0, limit=1)

    assert [item["kind"] for item in found["items"]] == ["change.succeeded"]


async def test_a_rare_kind_is_found_without_a_look_at_the_log_for_each_event(
    http: httpx.AsyncClient, supervisor: Supervisor, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = supervisor.events
    for number in range(log.newest + 1, 5_000):
        log.append(event(number))
    log.append(event(5_000, RareHappened))
    looks = 0
    take = EventReader.take

    def counted(reader: EventReader, limit: int) -> list[RecordedEvent | Gap]:
        nonlocal looks
        looks += 1
        return take(reader, limit)

    monkeypatch.setattr(EventReader, "take", counted)

    found = await events(http, kind="test.rare", after=0, limit=1)

    assert ids(found) == [5_000]
    assert looks <= 10


async def test_others_get_their_turn_while_a_large_answer_is_made(
    http: httpx.AsyncClient, supervisor: Supervisor, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = supervisor.events
    for number in range(log.newest + 1, 2_001):
        log.append(event(number))
    encoded = 0
    seen_by_another: set[int] = set()
    encode = StreamEncoder.event

    def counted(encoder: StreamEncoder, given: RecordedEvent) -> str:
        nonlocal encoded
        encoded += 1
        return encode(encoder, given)

    async def another() -> None:
        while encoded < 1_000:
            seen_by_another.add(encoded)
            await asyncio.sleep(0)

    monkeypatch.setattr(StreamEncoder, "event", counted)

    await asyncio.gather(events(http, after=0, limit=1_000), another())

    assert len(seen_by_another - {0}) >= 3


async def test_what_happens_while_a_large_answer_is_made_is_left_for_the_next_question(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    log = supervisor.events
    newest = 2_000
    for number in range(log.newest + 1, newest + 1):
        log.append(event(number))

    async def more() -> None:
        for number in range(newest + 1, newest + 100):
            await asyncio.sleep(0)
            log.append(event(number))

    found, _ = await asyncio.gather(events(http, limit=1_000), more())

    assert ids(found)[-1] == found["newest"]


async def test_the_stream_tells_the_very_same(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    app = create_app(supervisor, allowed_hosts=[])
    async with WebSocketClient(app, topics="events", after=0) as client:
        streamed = await client.frame("event")

    assert (await events(http, after=0))["items"][0] == streamed


async def test_events_that_are_forgotten_are_told_as_a_gap(
    http: httpx.AsyncClient, supervisor: Supervisor
) -> None:
    log = supervisor.events
    for number in range(log.newest + 1, 10_051):
        log.append(event(number))

    found = await events(http, after=10, limit=1)

    assert found["gaps"] == [{"type": "gap", "from": 11, "to": 50, "epoch": log.epoch}]
    assert ids(found) == [51]


async def test_a_cursor_of_an_earlier_run_begins_anew_and_is_told_so(
    http: httpx.AsyncClient,
) -> None:
    found = await events(http, after=7, epoch="earlier", limit=1)

    assert found["gaps"] == [{"type": "gap", "from": 8, "to": None, "epoch": "earlier"}]
    assert ids(found) == [1]


@pytest.mark.parametrize(
    "query",
    [{"after": -1}, {"after": "x"}, {"after": 2**63}, {"limit": 0}, {"limit": 1_001}],
)
async def test_a_cursor_or_limit_that_cannot_be_is_refused(
    http: httpx.AsyncClient, query: dict[str, Any]
) -> None:
    assert (await http.get("/events", params=query)).status_code == 422
