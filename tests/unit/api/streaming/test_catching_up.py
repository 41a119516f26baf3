"""Clients that wait for earlier events get them in fair turns."""

import logging

import pytest

from api.streaming.catching_up import CatchingUp
from domain.errors import StorageDegradedError
from service.event_log import Gap
from service.history.event_pages import EventPages, HistoryReader
from tests.support.kept_events import Disk, Run
from tests.support.manual_clock import ManualClock, settle


class Readers:
    """Readers that want everything, each asking again once it has read its page."""

    def __init__(self, run: Run, clock: ManualClock, count: int) -> None:
        pages = EventPages(run.history)
        self.loaded = 0
        self.catching_up = CatchingUp(clock, self._note)
        self.readers = [HistoryReader(pages, 0) for _ in range(count)]

    def ask(self) -> None:
        for reader in self.readers:
            if reader.needs_page:
                self.catching_up.ask(reader)

    def positions(self) -> list[int]:
        return [reader.position[0] for reader in self.readers]

    def take(self) -> None:
        for reader in self.readers:
            reader.take(1_000)

    def _note(self) -> None:
        self.loaded += 1


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def disk() -> Disk:
    return Disk()


@pytest.fixture
def run(disk: Disk, clock: ManualClock) -> Run:
    run = Run(disk, clock)
    run.tell(1_000)
    return run


async def test_each_gets_one_page_in_turn(run: Run, clock: ManualClock) -> None:
    readers = Readers(run, clock, 3)
    readers.ask()
    readers.ask()
    await settle()
    assert readers.loaded == 3

    readers.take()
    assert readers.positions() == [256, 256, 256]
    readers.ask()
    await settle()
    readers.take()
    assert readers.positions() == [512, 512, 512]


async def test_the_disk_is_read_once_for_those_who_come_back_together(
    run: Run, disk: Disk, clock: ManualClock
) -> None:
    readers = Readers(run, clock, 200)
    for _ in range(3):
        readers.ask()
        await settle()
        readers.take()

    assert set(readers.positions()) == {768}
    assert disk.reads == 3


async def test_nothing_is_read_for_who_has_gone(run: Run, disk: Disk, clock: ManualClock) -> None:
    readers = Readers(run, clock, 2)
    readers.ask()
    for reader in readers.readers:
        readers.catching_up.forget(reader)
    await settle()

    assert disk.reads == 0


async def test_whoever_asks_later_is_served_too(run: Run, clock: ManualClock) -> None:
    readers = Readers(run, clock, 1)
    for _ in range(4):
        readers.ask()
        await settle()
        readers.take()

    assert readers.positions() == [990]


async def test_a_journal_that_fails_for_a_moment_is_read_again(
    run: Run, disk: Disk, clock: ManualClock
) -> None:
    readers = Readers(run, clock, 1)
    disk.failure = StorageDegradedError("disk I/O error")
    readers.ask()
    await settle()
    assert readers.loaded == 0

    disk.failure = None
    await clock.advance(1)

    assert readers.loaded == 1
    assert not any(isinstance(item, Gap) for item in readers.readers[0].take(300))


async def test_if_it_stays_unreadable_all_go_on_with_what_memory_has(
    run: Run, disk: Disk, clock: ManualClock, caplog: pytest.LogCaptureFixture
) -> None:
    readers = Readers(run, clock, 100)
    disk.failure = StorageDegradedError("disk I/O error")
    with caplog.at_level(logging.WARNING):
        readers.ask()
        await clock.advance(3)

    assert all(reader.take(1) == [Gap(1, 990, "run1")] for reader in readers.readers)
    assert [reader.needs_page for reader in readers.readers] == [False] * 100
    assert "clients go on without earlier events" in caplog.text
    assert disk.reads == 3


async def test_a_fault_of_the_program_leaves_nobody_waiting(
    run: Run, clock: ManualClock, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    readers = Readers(run, clock, 2)

    async def fails(query: object) -> None:
        raise RuntimeError("a fault")

    monkeypatch.setattr(run.journal, "events", fails)
    readers.ask()
    await settle()

    assert all(reader.take(1) == [Gap(1, 990, "run1")] for reader in readers.readers)
    assert "earlier events cannot be loaded" in caplog.text
