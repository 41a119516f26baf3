"""What is told of three runs: the second was killed and lost its tail, the third still runs."""

import asyncio
from datetime import timedelta

import pytest

from domain.errors import StorageDegradedError, UnknownEventError
from domain.events.event import RecordedEvent
from service.event_log import EventLog, Gap
from service.history import event_history
from service.history.event_history import MAX_CAUSES, EventHistory, FoundEvents
from service.storage.journal import EventQuery
from tests.support.frames import RareHappened, event
from tests.support.kept_events import Disk, Run
from tests.support.manual_clock import START, ManualClock


@pytest.fixture
def disk() -> Disk:
    disk = Disk()
    first = Run(disk)
    first.tell(20)
    first.journal.write_down()
    second = Run(disk)
    second.tell(4)
    second.tell(1, RareHappened)
    second.journal.write_down()
    second.tell(3)
    return disk


@pytest.fixture
def run(disk: Disk) -> Run:
    """The third run: it has had 15 events, and memory has the 10 newest."""
    run = Run(disk)
    run.tell(15)
    return run


def ids(found: FoundEvents) -> list[int]:
    return [item.id for item in found.items]


async def test_the_runs_of_the_story(run: Run, disk: Disk) -> None:
    assert disk.ids == [*range(1, 21), *range(41, 46)]
    assert (run.log.before, run.log.oldest, run.log.newest) == (65, 71, 80)


async def test_what_memory_has_is_not_read_from_disk(run: Run, disk: Disk) -> None:
    await run.history.find(EventQuery(limit=1))
    disk.reads = 0

    assert ids(await run.history.find(EventQuery(limit=10))) == list(range(71, 81))
    assert ids(await run.history.find(EventQuery(after=70))) == list(range(71, 81))
    assert disk.reads == 0


async def test_the_newest_reach_back_over_a_restart(run: Run) -> None:
    found = await run.history.find(EventQuery(limit=20))

    assert ids(found) == [*range(41, 46), *range(66, 81)]
    assert found.gaps == [Gap(46, 65, "run2")]
    assert (found.oldest, found.newest) == (1, 80)


async def test_an_id_is_followed_through_all_runs(run: Run) -> None:
    found = await run.history.find(EventQuery(after=0, limit=1_000))

    assert ids(found) == [*range(1, 21), *range(41, 46), *range(66, 81)]
    assert found.gaps == [Gap(21, 40, "run1"), Gap(46, 65, "run2")]


async def test_a_page_backwards_ends_before_the_id_that_is_named(run: Run) -> None:
    found = await run.history.find(EventQuery(before=68, limit=4))

    assert ids(found) == [44, 45, 66, 67]
    assert found.gaps == [Gap(46, 65, "run2")]


async def test_what_is_too_old_to_be_kept_is_told_whoever_asks_for_it(run: Run, disk: Disk) -> None:
    disk.forget(10)

    backwards = await run.history.find(EventQuery(before=12))
    forwards = await run.history.find(EventQuery(after=4, before=12))

    assert ids(backwards) == ids(forwards) == [10, 11]
    assert backwards.gaps == [Gap(1, 9, "run1")]
    assert forwards.gaps == [Gap(5, 9, "run1")]
    assert backwards.oldest == 10


async def test_a_rare_kind_is_found_in_an_earlier_run_and_gaps_are_told(run: Run) -> None:
    found = await run.history.find(EventQuery(after=2, kind="test.rare"))

    assert ids(found) == [45]
    assert found.gaps == [Gap(21, 40, "run1"), Gap(46, 65, "run2")]


async def test_of_chosen_events_only_what_is_lost_in_their_range_is_told(run: Run) -> None:
    found = await run.history.find(EventQuery(after=2, kind="test.rare", limit=1))

    assert ids(found) == [45]
    assert found.gaps == [Gap(21, 40, "run1")]


@pytest.mark.parametrize("kind", ["test", "test.happened", "*.happened", "*ppen*"])
async def test_memory_and_disk_choose_alike(run: Run, kind: str) -> None:
    found = await run.history.find(EventQuery(after=0, kind=kind, actor="test"))

    assert len(ids(found)) == 40 - (kind != "test")


async def test_events_between_two_moments_come_from_both(run: Run) -> None:
    begin, end = START + timedelta(seconds=67), START + timedelta(seconds=73)

    found = await run.history.find(EventQuery(from_at=begin, to_at=end))

    assert ids(found) == list(range(67, 74))
    assert found.gaps == []


async def test_what_a_kill_lost_is_told_where_it_may_have_happened(run: Run) -> None:
    begin, end = START + timedelta(seconds=21), START + timedelta(seconds=50)

    found = await run.history.find(EventQuery(from_at=begin, to_at=end))

    assert ids(found) == list(range(41, 46))
    assert found.gaps == [Gap(21, 40, "run1"), Gap(46, 65, "run2")]


async def test_what_memory_dropped_is_waited_for_if_it_is_not_written_yet(run: Run) -> None:
    found = await run.history.find(EventQuery(after=65))

    assert ids(found) == list(range(66, 81))
    assert found.gaps == []


async def test_what_a_full_queue_lost_is_told(run: Run) -> None:
    run.journal.lose()

    found = await run.history.find(EventQuery(after=65))

    assert ids(found) == list(range(71, 81))
    assert found.gaps == [Gap(66, 70, "run3")]


async def test_a_disk_that_takes_no_more_leaves_what_it_has(run: Run) -> None:
    run.journal.writes = False

    found = await run.history.find(EventQuery(after=44))

    assert ids(found) == [45, *range(71, 81)]
    assert found.gaps == [Gap(46, 70, "run2")]


async def test_events_that_happen_while_the_disk_is_read_are_neither_missing_nor_told_twice(
    run: Run, disk: Disk
) -> None:
    def more() -> None:
        run.tell(7)

    disk.on_read = more

    found = await run.history.find(EventQuery(after=0, limit=1_000))

    assert ids(found) == [*range(1, 21), *range(41, 46), *range(66, 81)]
    assert found.newest == 80


@pytest.mark.parametrize("query", [EventQuery(after=0), EventQuery(limit=11), EventQuery(before=9)])
async def test_a_broken_disk_is_told_where_it_is_needed(
    run: Run, disk: Disk, query: EventQuery
) -> None:
    disk.failure = StorageDegradedError("disk I/O error")

    with pytest.raises(StorageDegradedError, match="earlier events cannot be read: disk I/O error"):
        await run.history.find(query)
    assert ids(await run.history.find(EventQuery(limit=10))) == list(range(71, 81))


async def test_a_disk_that_does_not_answer_counts_as_broken(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def never(query: EventQuery) -> list[RecordedEvent]:
        await asyncio.Event().wait()
        return []

    monkeypatch.setattr(event_history, "READ_PATIENCE_S", 0.0)
    monkeypatch.setattr(run.journal, "events", never)

    with pytest.raises(StorageDegradedError, match="the disk takes more than"):
        await run.history.find(EventQuery(after=0))


async def test_one_query_reads_the_disk_at_a_time(
    run: Run, disk: Disk, monkeypatch: pytest.MonkeyPatch
) -> None:
    reading, most = 0, 0
    read = run.history.stored_before

    async def counted(query: EventQuery, end: int) -> object:
        nonlocal reading, most
        reading += 1
        most = max(most, reading)
        try:
            return await read(query, end)
        finally:
            reading -= 1

    monkeypatch.setattr(run.history, "stored_before", counted)

    await asyncio.gather(*(run.history.find(EventQuery(after=0)) for _ in range(5)))

    assert most == 1


async def test_a_cursor_of_an_earlier_run_leads_on(run: Run) -> None:
    found = await run.history.find(EventQuery(after=44, limit=3), "run2")

    assert ids(found) == [45, 66, 67]
    assert found.gaps == [Gap(46, 65, "run2")]


async def test_a_client_that_saw_the_lost_tail_is_told_the_rest_of_it(run: Run) -> None:
    found = await run.history.find(EventQuery(after=48, limit=1), "run2")

    assert ids(found) == [66]
    assert found.gaps == [Gap(49, 65, "run2")]


@pytest.mark.parametrize(("after", "epoch"), [(7, "elsewhere"), (81, None), (70, "run2")])
async def test_a_cursor_that_leads_nowhere_begins_with_this_run(
    run: Run, after: int, epoch: str | None
) -> None:
    found = await run.history.find(EventQuery(after=after, limit=1), epoch)

    assert ids(found) == [66]
    assert found.gaps == [Gap(after + 1, None, epoch or "run3")]


async def test_causes_lead_over_restarts_to_the_origin(run: Run, disk: Disk) -> None:
    run.tell(1)
    chain = await run.history.causes(2)

    assert [(item.id, item.cause) for item in chain] == [(2, 1), (1, None)]
    assert [item.id for item in await run.history.causes(71)] == [71, 70, 69, 68, 67, 66]


async def test_a_chain_of_causes_ends_after_a_hundred() -> None:
    log = EventLog()
    log.append(*map(event, range(1, 301)))
    history = EventHistory(log, None, ManualClock())

    chain = await history.causes(300)

    assert [item.id for item in chain] == list(range(300, 300 - MAX_CAUSES, -1))


@pytest.mark.parametrize("number", [0, 30, 81, 2**62])
async def test_an_event_that_never_was_has_no_causes(run: Run, number: int) -> None:
    with pytest.raises(UnknownEventError):
        await run.history.causes(number)


async def test_without_a_journal_only_memory_is_asked() -> None:
    log = EventLog(10, "E1")
    log.append(*map(event, range(1, 26)))
    history = EventHistory(log, None, ManualClock())

    found = await history.find(EventQuery(after=3, limit=2, from_at=START))

    assert ids(found) == [16, 17]
    assert found.gaps == [Gap(4, 15, "E1")]
    assert not history.reaches_back
