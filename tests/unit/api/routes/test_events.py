"""`GET /events`: the log for those who ask now and then."""

from collections.abc import AsyncIterator
from typing import Any

import httpx
import pytest

from api.app import create_app
from domain.messages import ModeRequest
from domain.system_model import PartName
from service.supervisor import Supervisor
from tests.support.frames import event
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.websocket import WebSocketClient


@pytest.fixture
async def supervisor() -> AsyncIterator[Supervisor]:
    """A robot that was brought into PERFORMANCE."""
    clock = ManualClock()
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        supervisor.submit(ModeRequest(PartName("actuation"), "PERFORMANCE", "operator"))
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
