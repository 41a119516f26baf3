"""What clients are told over a restart of the service: two runs of a robot over one journal."""

import json
from collections.abc import AsyncIterator
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from api.app import create_app
from domain.actor import Actor
from domain.errors import StorageDegradedError
from domain.events.event import RecordedEvent
from domain.inputs import EmergencyStopRequest, ModeRequest
from domain.state_and_mode import PartName
from domain.timebase import seconds
from tests.support.frames import Happened
from tests.support.kept_events import Disk, EventJournal
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock, settle
from tests.support.websocket import WebSocketClient


class Robot:
    """One run of the service."""

    def __init__(self, disk: Disk, clock: ManualClock, capacity: int = 1_000) -> None:
        self.journal = EventJournal(disk, clock)
        log = self.journal.log(capacity)
        self.supervisor = make_supervisor(clock, events=log, journal=self.journal)
        self.app = create_app(self.supervisor, allowed_hosts=[])

    def press_and_release_the_stop(self, times: int) -> None:
        for engaged in (True, False) * times:
            self.supervisor.submit(EmergencyStopRequest(engaged, "test", Actor("operator")))

    async def get(self, path: str, **query: str | int) -> httpx.Response:
        transport = httpx.ASGITransport(self.app)
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000") as http:
            return await http.get(path, params=query)

    async def events(self, **query: str | int) -> dict[str, Any]:
        answer = await self.get("/events", **query)
        assert answer.status_code == 200, answer.text
        found = answer.json()
        assert isinstance(found, dict)
        return found


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def disk() -> Disk:
    return Disk()


@pytest.fixture
async def before(disk: Disk, clock: ManualClock) -> Robot:
    """The first run, in which a mode was requested; it was killed."""
    robot = Robot(disk, clock)
    async with running(robot.supervisor):
        request = ModeRequest(PartName("actuation"), "PERFORMANCE", Actor("operator"))
        robot.supervisor.submit(request)
        await clock.advance(2)
    robot.journal.write_down()
    return robot


@pytest.fixture
async def robot(before: Robot, disk: Disk, clock: ManualClock) -> AsyncIterator[Robot]:
    """The second run."""
    clock.stall(60)
    robot = Robot(disk, clock)
    async with running(robot.supervisor):
        yield robot


def newest(robot: Robot) -> int:
    return robot.supervisor.events.newest


async def test_events_of_the_earlier_run_read_as_they_did_then(before: Robot, robot: Robot) -> None:
    live = await before.get("/events", after=0, limit=1_000)
    stored = await robot.get("/events", after=0, before=newest(before) + 1, limit=1_000)

    def items(answer: httpx.Response) -> str:
        return answer.text.partition('"items":')[2]

    assert items(stored) == items(live)
    assert len(stored.json()["items"]) > 10


async def test_a_value_that_json_cannot_hold_reads_alike_too(
    disk: Disk, clock: ManualClock
) -> None:
    robot = Robot(disk, clock)
    odd = RecordedEvent(
        newest(robot) + 1,
        seconds(1),
        None,
        Actor("test"),
        Happened(float("nan")),  # type: ignore[arg-type]
    )
    robot.supervisor.events.append(odd)
    robot.journal.note_events(odd)
    robot.journal.write_down()

    live = await robot.get("/events", limit=1)
    later = await Robot(disk, clock).get("/events", before=odd.id + 1, limit=1)

    assert later.json()["items"] == live.json()["items"]


async def test_the_list_reaches_back_over_the_restart_and_tells_the_lost_ids(
    before: Robot, robot: Robot
) -> None:
    found = await robot.events(limit=1_000)

    ids = [item["id"] for item in found["items"]]
    assert ids[: newest(before)] == list(range(1, newest(before) + 1))
    assert found["gaps"] == [
        {"type": "gap", "from": newest(before) + 1, "to": newest(before) + 20, "epoch": "run1"}
    ]
    assert (found["epoch"], found["oldest"], found["newest"]) == ("run2", 1, newest(robot))
    assert {item["epoch"] for item in found["items"]} == {"run1", "run2"}


@pytest.mark.parametrize(
    ("query", "kinds"),
    [
        ({"kind": "*.succeeded"}, {"change.succeeded"}),
        ({"kind": "change.*ed", "part": "actuation"}, {"change.requested", "change.succeeded"}),
        ({"part": "drive_base", "kind": "change"}, {"change.step_started", "change.step_ended"}),
        ({"actor": "operator", "kind": "change.requested"}, {"change.requested"}),
        ({"actor": "nobody"}, set()),
        ({"part": "elsewhere"}, set()),
        ({"to_at": "2026-01-01T00:00:00Z", "kind": "change.requested"}, {"change.requested"}),
        ({"from_at": "2026-01-01T00:00:30+00:00", "kind": "service"}, {"service.restored"}),
    ],
)
async def test_events_are_chosen_alike_live_and_after_the_restart(
    before: Robot, robot: Robot, query: dict[str, str], kinds: set[str]
) -> None:
    told = await robot.events(**query, limit=1_000)

    assert {item["kind"] for item in told["items"]} == kinds
    if "from_at" not in query:
        live = await before.events(**query, limit=1_000)
        assert live["items"] == told["items"]


async def test_the_time_that_an_event_shows_finds_it(before: Robot, robot: Robot) -> None:
    for item in (await robot.events(limit=1_000))["items"]:
        found = await robot.events(from_at=item["at"], to_at=item["at"], limit=1_000)

        assert item in found["items"]


@pytest.mark.parametrize(
    ("query", "reason"),
    [
        ({"from_at": "2026-01-02T00:00:00Z", "to_at": "2026-01-01T00:00:00Z"}, "is later than"),
        ({"from_at": "yesterday"}, "query from_at: no time 'yesterday'"),
        ({"to_at": "2026-01-01T00:00:00"}, "query to_at: a time needs an offset"),
        ({"to_at": "1767225600"}, "query to_at: no time"),
        ({"from_at": ""}, "query from_at: no time ''"),
        ({"from_at": "2026-13-01T00:00:00Z"}, "no time"),
        ({"after": 7, "before": 6}, "query after: 7 is above before 6"),
        ({"before": -1}, "query before"),
        ({"kind": "k" * 101}, "query kind"),
        ({"part": "p" * 257}, "query part"),
        ({"actor": "a" * 513}, "query actor"),
    ],
)
async def test_nonsense_is_rejected_with_the_reason(
    robot: Robot, query: dict[str, Any], reason: str
) -> None:
    answer = await robot.get("/events", **query)

    assert answer.status_code == 422
    assert reason in answer.json()["detail"]


@pytest.mark.parametrize("edge", ["0001-01-01T00:00:00+14:00", "9999-12-31T23:59:59.999-14:00"])
async def test_the_ends_of_the_calendar_are_times_too(robot: Robot, edge: str) -> None:
    assert (await robot.get("/events", from_at=edge)).status_code == 200
    assert (await robot.get("/events", to_at=edge)).status_code == 200


async def test_a_broken_disk_is_told_only_where_it_is_needed(disk: Disk, robot: Robot) -> None:
    disk.failure = StorageDegradedError("disk I/O error")

    answer = await robot.get("/events", after=0)
    assert (answer.status_code, answer.json()["code"]) == (503, "STORAGE_DEGRADED")
    assert answer.json()["detail"] == "earlier events cannot be read: disk I/O error"
    assert (await robot.get("/events/1/causes")).status_code == 503
    assert (await robot.get("/events", limit=1)).status_code == 200


async def test_causes_lead_to_the_person_who_asked(before: Robot, robot: Robot) -> None:
    (end,) = (await robot.events(kind="change.succeeded"))["items"]

    chain = (await robot.get(f"/events/{end['id']}/causes")).json()["items"]

    assert chain[0] == end
    assert (chain[-1]["kind"], chain[-1]["actor"]) == ("change.requested", "operator")
    assert [item["cause"] for item in chain] == [*(item["id"] for item in chain[1:]), None]
    assert await before.get(f"/events/{end['id']}/causes") is not None


@pytest.mark.parametrize(("event", "status"), [("0", 404), ("99999", 404), ("x", 422), ("-1", 422)])
async def test_causes_of_no_event_are_refused(robot: Robot, event: str, status: int) -> None:
    answer = await robot.get(f"/events/{event}/causes")

    assert answer.status_code == status
    if status == 404:
        assert answer.json()["code"] == "UNKNOWN_EVENT"


async def test_the_greeting_counts_the_runs(before: Robot, robot: Robot) -> None:
    async with WebSocketClient(robot.app) as client:
        hello = await client.frame("hello")

    assert (hello["boot"], hello["epoch"]) == (2, "run2")


async def told_after(app: FastAPI, last: int, after: int, epoch: str) -> list[dict[str, Any]]:
    """Return what a client is told up to an event."""
    found: list[dict[str, Any]] = []
    async with WebSocketClient(app, topics="events", after=after, epoch=epoch) as client:
        await client.frame("hello")
        while not found or found[-1].get("id") != last:
            found.append(await client.frame())
    return found


async def test_a_stream_of_the_earlier_run_goes_on_without_a_hole(
    before: Robot, robot: Robot
) -> None:
    known = newest(before) - 5
    robot.press_and_release_the_stop(3)

    told = await told_after(robot.app, newest(robot), after=known, epoch="run1")

    first = newest(before) + 21
    assert [frame["id"] for frame in told if frame["type"] == "event"] == [
        *range(known + 1, newest(before) + 1),
        *range(first, newest(robot) + 1),
    ]
    assert [frame for frame in told if frame["type"] == "gap"] == [
        {"type": "gap", "from": newest(before) + 1, "to": first - 1, "epoch": "run1"}
    ]


async def test_a_stream_of_an_unknown_run_begins_with_this_one(robot: Robot) -> None:
    told = await told_after(robot.app, newest(robot), after=7, epoch="unknown")

    assert told[0] == {"type": "gap", "from": 8, "to": None, "epoch": "unknown"}
    assert told[1]["epoch"] == "run2"


async def test_a_client_that_falls_behind_memory_loses_nothing(
    disk: Disk, clock: ManualClock
) -> None:
    robot = Robot(disk, clock, capacity=20)
    async with running(robot.supervisor), WebSocketClient(robot.app, topics="events") as client:
        await client.frame("hello")
        begin = newest(robot)
        client.stop_reading()
        for _ in range(30):
            robot.press_and_release_the_stop(10)
            await settle()
        client.go_on_reading()
        await clock.advance(0.5)
        ids = [frame["id"] for frame in client.frames()]

    assert ids == list(range(begin + 1, newest(robot) + 1))
    assert len(ids) > 600


async def test_more_at_once_than_memory_keeps_reaches_all_clients(
    disk: Disk, clock: ManualClock
) -> None:
    robot = Robot(disk, clock, capacity=20)
    async with running(robot.supervisor), WebSocketClient(robot.app, topics="events") as client:
        await client.frame("hello")
        await clock.advance(0.2)
        begin = newest(robot)
        robot.press_and_release_the_stop(100)
        await clock.advance(0.5)
        ids = [frame["id"] for frame in client.frames() if frame["type"] == "event"]

    assert ids[-200:] == list(range(newest(robot) - 199, newest(robot) + 1))
    assert set(range(begin + 1, newest(robot) + 1)) <= set(ids)


async def test_many_clients_that_come_back_share_the_disk(
    before: Robot, robot: Robot, disk: Disk
) -> None:
    last = newest(robot)
    disk.reads = 0

    for _ in range(20):
        assert json.dumps(await told_after(robot.app, last, after=0, epoch="run1"))

    assert disk.reads <= 20
