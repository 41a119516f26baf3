"""What every journal must keep, told by an operator whose service is restarted."""

from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from domain.errors import StorageDegradedError
from domain.kept import KeptHold
from domain.state_and_mode import PartName
from service.storage.journal import ANNOUNCED, EventQuery, Journal
from service.storage.memory import MemoryJournal, MemoryStore
from service.storage.sqlite.journal import SqliteJournal
from service.storage.sqlite.opening import StoreSettings
from tests.support.manual_clock import ManualClock
from tests.support.noted_robot import NotedRobot, boot, wall

ENOUGH_S = 20.0
STARTED_AT = ManualClock().from_wall(wall("08:00:00"))


@dataclass
class Service:
    """A service that is started again and again with the same data."""

    open: Callable[[int], Awaitable[Journal]]
    starts: int = 0

    async def start(self) -> NotedRobot:
        self.starts += 1
        return NotedRobot(await self.open(self.starts))


@pytest.fixture(params=["memory", "sqlite"])
async def service(request: pytest.FixtureRequest, tmp_path: Path) -> AsyncIterator[Service]:
    opened: list[Journal] = []
    store = MemoryStore()

    async def open_memory(number: int) -> Journal:
        journal = MemoryJournal(boot(number, STARTED_AT), ManualClock(), store)
        opened.append(journal)
        return journal

    async def open_sqlite(number: int) -> Journal:
        settings = StoreSettings(tmp_path / "robot", "robot")
        journal = await SqliteJournal.open(settings, boot(number, STARTED_AT), ManualClock())
        opened.append(journal)
        return journal

    yield Service(open_memory if request.param == "memory" else open_sqlite)
    for journal in opened:
        await journal.close()


async def restarted(service: Service, robot: NotedRobot) -> NotedRobot:
    await robot.journal.close()
    return await service.start()


def holds(journal: Journal) -> dict[str, str]:
    """Return the holds that were restored: who set them, and why."""
    kept = journal.found.restored.kept
    return {value.owner: value.reason for value in kept if isinstance(value, KeptHold)}


async def kinds(journal: Journal, query: EventQuery) -> list[tuple[int, str]]:
    return [(event.id, event.kind) for event in await journal.events(query)]


async def test_the_first_start_finds_nothing(service: Service) -> None:
    found = (await service.start()).journal.found

    assert found.is_new
    assert found.restored.kept == ()
    assert (found.restored.boot, found.restored.next_event) == (1, 1)
    assert (found.restored.next_change, found.restored.next_task) == (1, 1)
    assert found.restored.stop_because == ""
    assert found.ended_at is None


async def test_what_was_committed_is_there_after_a_restart(service: Service) -> None:
    robot = await service.start()
    robot.holds("operator", "lunch")
    robot.holds("planner", "no route")
    robot.holds("operator", "still lunch")

    assert await robot.journal.commit(ENOUGH_S)

    journal = (await restarted(service, robot)).journal
    assert not journal.found.is_new
    assert holds(journal) == {"operator": "still lunch", "planner": "no route"}


async def test_what_is_kept_no_longer_does_not_come_back(service: Service) -> None:
    robot = await service.start()
    robot.holds("operator")
    robot.holds("planner")
    robot.releases("operator")

    robot = await restarted(service, robot)
    assert set(holds(robot.journal)) == {"planner"}

    robot.releases("planner")
    assert holds((await restarted(service, robot)).journal) == {}


async def test_what_nobody_touches_is_kept_over_many_restarts(service: Service) -> None:
    robot = await service.start()
    robot.holds("operator", "winter")
    for _ in range(3):
        robot = await restarted(service, robot)

    assert holds(robot.journal) == {"operator": "winter"}
    assert robot.journal.found.restored.boot == 4


async def test_the_service_keeps_values_of_its_own(service: Service) -> None:
    robot = await service.start()
    robot.journal.keep("simulation", {"pose": [1.0, 2.5, 0.0], "nodes": {"lidar": "active"}})
    robot.journal.keep("page", None)
    robot.journal.keep("simulation", {"pose": [3.0, 2.5, 0.0], "nodes": {}})

    own = (await restarted(service, robot)).journal.found.own

    assert own == {"simulation": {"pose": [3.0, 2.5, 0.0], "nodes": {}}, "page": None}


async def test_what_was_announced_last_is_known_after_a_restart(service: Service) -> None:
    robot = await service.start()
    assert (robot.journal.found.own or {}).get(ANNOUNCED) is None
    for number in (1, 2, 3):
        assert await robot.journal.announce([number, "ReleaseRequest"], ENOUGH_S)

    robot = await restarted(service, robot)

    assert (robot.journal.found.own or {})[ANNOUNCED] == [[3, "ReleaseRequest"]]
    await robot.journal.close()
    with pytest.raises(StorageDegradedError):
        await robot.journal.announce([4, "ReleaseRequest"], ENOUGH_S)


async def test_ids_go_on_where_a_run_ended(service: Service) -> None:
    robot = await service.start()
    assert robot.changes("actuation", "FAST") == "c1"
    robot.holds("operator")

    robot = await restarted(service, robot)

    assert robot.journal.found.restored.next_event == 4
    assert robot.changes("actuation", "SLOW") == "c2"


async def test_events_of_earlier_runs_are_read_together_with_those_of_this_one(
    service: Service,
) -> None:
    robot = await service.start()
    robot.changes("actuation", "FAST")
    robot = await restarted(service, robot)
    robot.holds("operator")

    events = await robot.journal.events(EventQuery())

    assert [(event.id, event.boot, event.epoch) for event in events] == [
        (1, 1, "epoch-1"),
        (2, 1, "epoch-1"),
        (3, 2, "epoch-2"),
    ]
    assert [event.words for event in events] == [
        "actuation: FAST requested",
        "actuation: configure",
        "hold operator set: lunch",
    ]
    assert events[1].cause == 1
    assert events[1].data == {"change": "c1", "node": "actuation", "action": "configure"}
    assert events[2].wall_at == wall("08:00:00.05")


async def test_it_is_known_which_runs_there_were(service: Service) -> None:
    robot = await service.start()
    robot.holds("operator")
    robot = await restarted(service, robot)
    robot = await restarted(service, robot)

    found = robot.journal.found

    assert found.epochs is not None
    assert found.epochs["epoch-1"] == 1
    assert found.ended_at == wall("08:00:00.05")


async def test_the_newest_events_are_returned_or_those_after_an_id(service: Service) -> None:
    robot = await service.start()
    for _ in range(6):
        robot.holds("operator")
    journal = robot.journal

    assert [event.id for event in await journal.events(EventQuery(limit=2))] == [5, 6]
    assert [event.id for event in await journal.events(EventQuery(after=1, limit=2))] == [2, 3]
    assert [event.id for event in await journal.events(EventQuery(before=4, limit=2))] == [2, 3]
    assert [event.id for event in await journal.events(EventQuery(after=2, before=5))] == [3, 4]
    assert await journal.events(EventQuery(after=6)) == []
    assert await journal.events(EventQuery(after=10**30)) == []
    assert await journal.events(EventQuery(before=-(10**30))) == []


@pytest.mark.parametrize(
    ("kind", "found"),
    [
        ("hold.set", {"hold.set"}),
        ("change", {"change.requested", "change.step_started"}),
        ("hold", {"hold.set", "hold.released"}),
        ("chan", set()),
        ("*", {"change.requested", "change.step_started", "hold.set", "hold.released"}),
        ("*e*d", {"change.requested", "change.step_started", "hold.released"}),
        ("hold.*", {"hold.set", "hold.released"}),
        ("hold._et", set()),
        ("hold.se%", set()),
        ("hold.[s]et", set()),
        ("HOLD", set()),
        ("", set()),
    ],
)
async def test_events_are_found_by_kind(service: Service, kind: str, found: set[str]) -> None:
    robot = await service.start()
    robot.changes("actuation", "FAST")
    robot.holds("operator")
    robot.releases("operator")

    events = await robot.journal.events(EventQuery(kind=kind))

    assert {event.kind for event in events} == found


async def test_events_are_found_by_part_actor_and_time(service: Service) -> None:
    robot = await service.start()
    robot.changes("left/arm", "FAST")
    robot.changes("drive_base", "SLOW")
    robot.holds("left/arm")
    journal = robot.journal

    assert await kinds(journal, EventQuery(part=PartName("left/arm"))) == [
        (1, "change.requested"),
        (2, "change.step_started"),
    ]
    assert await kinds(journal, EventQuery(part=PartName("arm"))) == []
    assert await kinds(journal, EventQuery(actor="ada")) == [(5, "hold.set")]
    nobodys = await kinds(journal, EventQuery(actor=""))
    assert [number for number, _ in nobodys] == [1, 2, 3, 4]
    assert await kinds(journal, EventQuery(from_at=wall("08:00:00.12"), to_at=wall("09:00"))) == [
        (5, "hold.set")
    ]
    assert await kinds(journal, EventQuery(to_at=wall("08:00:00.05"), kind="change", limit=1)) == [
        (2, "change.step_started")
    ]


async def test_nothing_is_written_after_the_end(service: Service) -> None:
    robot = await service.start()
    robot.holds("operator")
    await robot.journal.close()
    await robot.journal.close()

    robot.holds("planner")
    robot.journal.keep("page", 1)
    robot.journal.checkpoint(0, robot.now, b"state")
    with pytest.raises(StorageDegradedError):
        await robot.journal.commit(ENOUGH_S)

    journal = (await service.start()).journal
    assert set(holds(journal)) == {"operator"}
    assert journal.found.own == {}


async def test_the_status_tells_how_storage_is_doing(service: Service) -> None:
    robot = await service.start()
    robot.holds("operator")
    await robot.journal.commit(ENOUGH_S)
    robot = await restarted(service, robot)

    status = robot.journal.status()

    assert status.reason is None
    assert status.boot == 2
    assert set(status.logs) == {"inputs", "events"}
    assert status.logs["events"].from_at == wall("08:00:00.05")
    assert status.logs["events"].to_at == wall("08:00:00.05")
    assert (status.lost_inputs, status.lost_events) == (0, 0)


async def test_whoever_commits_with_nothing_noted_is_answered(service: Service) -> None:
    robot = await service.start()

    assert await robot.journal.commit(ENOUGH_S)
    assert await robot.journal.commit(ENOUGH_S)
