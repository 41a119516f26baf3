"""Readers that follow the log from far behind, also over restarts."""

import asyncio
import random

import pytest

from domain.errors import StorageDegradedError
from service.event_log import EventLog, Gap
from service.history.event_history import EventHistory
from service.history.event_pages import EVENTS_PER_PAGE, EventPages, HistoryReader, Told
from tests.support.frames import event
from tests.support.kept_events import Disk, Run
from tests.support.manual_clock import ManualClock


def ids(items: list[Told]) -> list[int]:
    return [item.id for item in items if not isinstance(item, Gap)]


def gaps(items: list[Told]) -> list[Gap]:
    return [item for item in items if isinstance(item, Gap)]


async def read_all(reader: HistoryReader, limit: int = 100) -> list[Told]:
    found: list[Told] = []
    while reader.is_behind or reader.needs_page:
        if reader.needs_page:
            await reader.load()
        found += reader.take(limit)
    return found


async def test_a_reader_from_before_a_restart_gets_every_event_of_both_runs() -> None:
    disk = Disk()
    first = Run(disk)
    first.tell(400)
    first.journal.write_down()
    second = Run(disk)
    second.tell(300)

    found = await read_all(HistoryReader(EventPages(second.history), 150, "run1"))

    assert ids(found) == [*range(151, 401), *range(421, 721)]
    assert gaps(found) == [Gap(401, 420, "run1")]


async def test_nothing_is_loaded_that_memory_has() -> None:
    disk = Disk()
    run = Run(disk)
    run.tell(25)
    reader = HistoryReader(EventPages(run.history), 15)

    assert not reader.needs_page
    assert ids(await read_all(reader)) == list(range(16, 26))
    assert disk.reads == 0


async def test_nothing_more_is_taken_until_the_page_is_loaded() -> None:
    run = Run(Disk())
    run.tell(25)
    reader = HistoryReader(EventPages(run.history), 3)

    assert reader.needs_page
    assert not reader.is_behind
    assert reader.take(100) == []
    await reader.load()
    assert ids(list(reader.take(5))) == [4, 5, 6, 7, 8]
    assert reader.position == (8, None)
    assert reader.is_behind


async def test_a_reader_that_falls_behind_again_loses_nothing() -> None:
    run = Run(Disk())
    run.tell(12)
    reader = HistoryReader(EventPages(run.history), 0)
    await reader.load()
    found = list(reader.take(1))
    run.tell(500)
    found += await read_all(reader)
    run.tell(30)
    found += await read_all(reader)

    assert ids(found) == list(range(1, 543))
    assert gaps(found) == []


async def test_readers_at_different_places_soon_share_pages() -> None:
    disk = Disk()
    run = Run(disk)
    run.tell(5 * EVENTS_PER_PAGE)
    pages = EventPages(run.history)
    await read_all(HistoryReader(pages, 3))
    alone = disk.reads

    for after in range(4, 24):
        assert len(ids(await read_all(HistoryReader(pages, after)))) == 5 * EVENTS_PER_PAGE - after

    # Each reads its own first page, and the last one, which ends where memory begins.
    assert disk.reads - alone == 2 * 20


async def test_an_old_cursor_is_led_over_a_large_gap_at_once() -> None:
    disk = Disk()
    run = Run(disk)
    run.tell(5_000)
    run.journal.write_down()
    disk.forget(4_900)

    found = await read_all(HistoryReader(EventPages(run.history), 7))

    assert found[0] == Gap(8, 4_899, "run1")
    assert ids(found) == list(range(4_900, 5_001))
    assert disk.reads <= 3


async def test_an_unreadable_journal_is_tried_again_or_skipped_with_a_gap() -> None:
    disk = Disk()
    run = Run(disk)
    run.tell(25)
    reader = HistoryReader(EventPages(run.history), 3)
    disk.failure = StorageDegradedError("disk I/O error")

    with pytest.raises(StorageDegradedError):
        await reader.load()
    reader.skip()

    found = await read_all(reader)
    assert found[0] == Gap(4, 15, "run1")
    assert ids(found) == list(range(16, 26))


async def test_a_cursor_of_an_unknown_run_is_told_so_before_the_events_of_this_run() -> None:
    disk = Disk()
    Run(disk).tell(1)
    run = Run(disk)
    run.tell(25)

    found = await read_all(HistoryReader(EventPages(run.history), 9, "unknown"))

    assert found[0] == Gap(10, None, "unknown")
    assert ids(found) == list(range(1, 26))


async def test_a_copy_goes_its_own_way() -> None:
    run = Run(Disk())
    run.tell(25)
    reader = HistoryReader(EventPages(run.history), 3)
    await reader.load()
    copy = reader.copy()

    assert ids(await read_all(reader)) == ids(await read_all(copy)) == list(range(4, 26))


async def test_without_a_journal_the_gap_is_told_as_ever() -> None:
    log = EventLog(10, "E1")
    log.append(*map(event, range(1, 26)))
    reader = HistoryReader(EventPages(EventHistory(log, None, ManualClock())), 3)

    assert not reader.needs_page
    assert reader.take(1) == [Gap(4, 15, "E1"), log.between(15)[0]]


@pytest.mark.parametrize("seed", range(15))
async def test_a_reader_cut_off_again_and_again_gets_exactly_the_log(seed: int) -> None:
    """It resumes by the id it saw last, also after restarts, and whatever the pace."""
    draw = random.Random(seed)
    disk = Disk()
    run = Run(disk, capacity=draw.choice([1, 7, 50]))
    happened: list[int] = []
    known: list[int] = []
    lost: list[int] = []
    cursor, epoch = 0, run.log.epoch
    for _ in range(50):
        if draw.random() < 0.2:
            run.journal.write_down()
            run = Run(disk, capacity=draw.choice([1, 7, 50]))
        happened += run.tell(draw.randrange(60))
        reader = HistoryReader(EventPages(run.history), cursor, epoch)
        for _ in range(draw.randrange(20)):
            if reader.needs_page:
                await reader.load()
            for item in reader.take(draw.randrange(1, 30)):
                if isinstance(item, Gap):
                    assert item.last is not None
                    lost += range(item.first, item.last + 1)
                    cursor, epoch = item.last, item.epoch
                else:
                    known.append(item.id)
                    cursor, epoch = item.id, run.log.epoch_of(item.id)
            happened += run.tell(draw.randrange(5))
            await asyncio.sleep(0)
    known += ids(await read_all(HistoryReader(EventPages(run.history), cursor, epoch)))

    assert known == happened
    assert not set(lost) & set(happened)
