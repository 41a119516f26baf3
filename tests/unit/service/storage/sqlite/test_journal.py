import asyncio
import errno
import os
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from domain.actor import Actor
from domain.errors import StorageDegradedError
from domain.inputs import HoldRequest
from domain.outbox import NOTHING
from service.codec.codec import STEPS
from service.storage.journal import ANNOUNCED, EventQuery, Step
from service.storage.sqlite import announced_file
from service.storage.sqlite import journal as sqlite_journal
from service.storage.sqlite.batch import Flight
from service.storage.sqlite.folder import Folder, Report, Retention
from service.storage.sqlite.recorded_log import RecordedLog
from service.storage.sqlite.state_file import StateFile
from tests.support.folder_robot import ENOUGH_S, as_a_kill_leaves, found_in, holds, started
from tests.support.noted_robot import NotedRobot


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "robot"


class Disk:
    """Stands between the journal and its folder: fails or waits as the test says."""

    def __init__(self) -> None:
        self.error: Exception | None = None
        self.gate = threading.Event()
        self.gate.set()
        self.flights: list[int] = []
        """Number of steps of each flight that was written."""

    def around(self, write: Callable[..., None]) -> Callable[..., None]:
        def guarded(folder: Folder, flight: Flight) -> None:
            self.gate.wait(ENOUGH_S)
            if self.error is not None:
                raise self.error
            write(folder, flight)
            self.flights.append(sum(len(batch.steps) for batch in flight.batches))

        return guarded


@pytest.fixture
def disk(monkeypatch: pytest.MonkeyPatch) -> Iterator[Disk]:
    disk = Disk()
    monkeypatch.setattr(Folder, "write", disk.around(Folder.write))
    monkeypatch.setattr(Folder, "recover", disk.around(Folder.recover))
    monkeypatch.setattr(sqlite_journal, "RETRY_S", 0.01)
    yield disk
    disk.gate.set()


async def until(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(ENOUGH_S):
        while not condition():  # noqa: ASYNC110  # what it waits for is in another thread
            await asyncio.sleep(0.005)


async def until_it_works(robot: NotedRobot) -> None:
    await until(lambda: robot.journal.status().reason is None)


async def test_all_who_wait_share_one_flight(folder: Path, disk: Disk) -> None:
    robot = await started(folder)

    async def ask(owner: str) -> bool:
        robot.holds(owner)
        return await robot.journal.commit(ENOUGH_S)

    assert all(await asyncio.gather(*(ask(f"operator {n}") for n in range(32))))

    assert disk.flights == [32]
    await robot.journal.close()


async def test_what_nobody_waits_for_is_written_all_the_same(folder: Path, disk: Disk) -> None:
    robot = await started(folder)
    robot.reads()
    robot.reads()

    await until(lambda: bool(disk.flights))

    assert disk.flights == [2]
    await robot.journal.close()


async def test_the_state_follows_the_log_when_nobody_waits(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sqlite_journal, "FOLLOW_EVERY_S", ENOUGH_S)
    followed: list[int] = []
    follow = Folder.follow

    def counted(folder: Folder) -> Report:
        followed.append(1)
        return follow(folder)

    monkeypatch.setattr(Folder, "follow", counted)
    robot = await started(folder)
    for number in range(10):
        robot.holds(f"operator {number}")
        assert await robot.journal.commit(ENOUGH_S)
    while_asked = len(followed)

    await until(lambda: len(followed) > while_asked)

    assert while_asked <= 1
    state = StateFile.open(as_a_kill_leaves(folder) / "state.db")
    assert ("kept_hold", "operator 9") in state.kept()
    state.close()
    await robot.journal.close()


async def test_whoever_is_not_patient_is_told_that_it_is_not_on_disk_yet(
    folder: Path, disk: Disk
) -> None:
    robot = await started(folder)
    disk.gate.clear()
    robot.holds("operator")

    assert not await robot.journal.commit(0.05)

    disk.gate.set()
    assert await robot.journal.commit(ENOUGH_S)
    await robot.journal.close()
    assert set(holds(await found_in(folder))) == {"operator"}


async def test_a_disk_that_does_not_answer_is_degraded_and_holds_nobody_up(
    folder: Path, disk: Disk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sqlite_journal, "SLOW_S", 0.05)
    robot = await started(folder)
    disk.gate.clear()
    robot.holds("operator")
    await robot.journal.commit(0.1)

    robot.reads()

    assert (robot.journal.status().reason or "").startswith("no answer from the disk for 0.")
    disk.gate.set()
    await robot.journal.commit(ENOUGH_S)
    assert robot.journal.status().reason is None
    await robot.journal.close()


async def test_a_disk_that_fails_is_told_and_nothing_is_lost_when_it_works_again(
    folder: Path, disk: Disk
) -> None:
    robot = await started(folder)
    disk.error = OSError(28, "No space left on device")
    robot.holds("operator")

    with pytest.raises(StorageDegradedError, match="No space left on device"):
        await robot.journal.commit(ENOUGH_S)
    with pytest.raises(StorageDegradedError, match="No space left on device"):
        await robot.journal.commit(ENOUGH_S)
    assert robot.journal.status().reason == "No space left on device"
    robot.holds("planner")
    robot.releases("operator")
    disk.error = None
    await until_it_works(robot)

    assert await robot.journal.commit(ENOUGH_S)
    events = await robot.journal.events(EventQuery())
    assert [event.id for event in events] == [1, 2, 3]
    assert set(holds(await found_in(as_a_kill_leaves(folder)))) == {"planner"}
    assert robot.journal.status().lost_inputs == 0
    await robot.journal.close()


async def test_an_announcement_waits_for_no_commit(folder: Path, disk: Disk) -> None:
    robot = await started(folder)
    disk.gate.clear()
    robot.holds("operator")
    commit = asyncio.create_task(robot.journal.commit(ENOUGH_S))
    await asyncio.sleep(0)

    assert await robot.journal.announce([1, "ReleaseRequest"], ENOUGH_S)
    assert not commit.done()

    disk.gate.set()
    assert await commit
    await robot.journal.close()
    with pytest.raises(StorageDegradedError):
        await robot.journal.announce([2, "ReleaseRequest"], ENOUGH_S)


async def test_what_cannot_be_announced_is_told_until_it_can_be(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sqlite_journal, "RETRY_S", 0.01)
    robot = await started(folder)
    broken = True
    write_all = announced_file.write_synced

    def fails(fd: int, content: bytes, offset: int) -> None:
        if broken:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        write_all(fd, content, offset)

    monkeypatch.setattr(announced_file, "write_synced", fails)
    (folder / "announced").unlink()

    told = await asyncio.gather(
        *(robot.journal.announce(n, ENOUGH_S) for n in range(3)), return_exceptions=True
    )
    assert {type(each) for each in told} == {StorageDegradedError}
    robot.holds("operator")
    with pytest.raises(StorageDegradedError):
        await robot.journal.commit(ENOUGH_S)

    broken = False
    await until_it_works(robot)
    assert await robot.journal.announce([4, "ReleaseRequest"], ENOUGH_S)
    await robot.journal.close()
    found = await found_in(folder)
    assert set(holds(found)) == {"operator"}
    assert found.own == {ANNOUNCED: [[4, "ReleaseRequest"]]}


async def test_an_announcement_that_fails_beside_a_flight_stops_neither_it_nor_the_next(
    folder: Path, disk: Disk
) -> None:
    robot = await started(folder)
    disk.gate.clear()
    robot.holds("operator")
    commit = asyncio.create_task(robot.journal.commit(ENOUGH_S))
    await asyncio.sleep(0.01)
    (folder / "announced").unlink()
    with pytest.raises(StorageDegradedError):
        await robot.journal.announce([1, "ReleaseRequest"], ENOUGH_S)
    assert robot.journal.fault is not None

    disk.gate.set()
    assert await commit
    await until_it_works(robot)

    assert await robot.journal.announce([2, "ReleaseRequest"], ENOUGH_S)
    await robot.journal.close()
    assert set(holds(await found_in(folder))) == {"operator"}


async def test_whoever_is_not_patient_has_announced_nothing(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = await started(folder)
    gate = threading.Event()
    monkeypatch.setattr(announced_file, "write_synced", lambda *_: gate.wait(ENOUGH_S))

    assert not await robot.journal.announce([1, "ReleaseRequest"], 0.02)

    gate.set()
    await robot.journal.close()


async def test_what_does_not_fit_is_lost_and_told_but_values_are_not(
    folder: Path, disk: Disk
) -> None:
    robot = await started(folder, backlog_bytes=20_000)
    robot.journal.checkpoint(robot.journal.last_step, robot.now, b"state")
    disk.error = OSError(5, "Input/output error")
    for number in range(100):
        robot.holds("operator", f"reason {number}")
    with pytest.raises(StorageDegradedError):
        await robot.journal.commit(ENOUGH_S)
    lost = robot.journal.status()
    assert 0 < lost.lost_inputs == lost.lost_events < 100
    assert not robot.journal.wants_checkpoint
    disk.error = None
    await until_it_works(robot)
    robot.holds("planner")
    await robot.journal.commit(ENOUGH_S)

    assert robot.journal.wants_checkpoint
    (hole,) = RecordedLog(folder).holes()
    assert (hole.steps, hole.events) == (lost.lost_inputs, lost.lost_events)
    assert (hole.after_step, hole.reason) == (100 - hole.steps, "the queue is full")
    await robot.journal.close()
    numbers = [number for number, _ in RecordedLog(folder).lines(1)]
    assert numbers == [*range(1, hole.after_step + 1), 101]
    assert holds(await found_in(folder)) == {"operator": "reason 99", "planner": "lunch"}


async def test_a_step_that_cannot_be_written_down_takes_nothing_with_it(folder: Path) -> None:
    robot = await started(folder)
    robot.holds("operator")
    broken = HoldRequest("operator", "half of a letter: \ud83d", Actor("ada"))
    robot.journal.note(Step(robot.now, broken, False, NOTHING))
    robot.holds("planner")

    assert await robot.journal.commit(ENOUGH_S)

    assert robot.journal.status().lost_inputs == 1
    await robot.journal.close()
    assert set(holds(await found_in(folder))) == {"operator", "planner"}


async def test_a_state_of_the_core_is_wanted_at_the_start_now_and_then_and_in_each_file(
    folder: Path,
) -> None:
    robot = await started(folder, retention=Retention(file_bytes=60_000))
    assert robot.journal.wants_checkpoint

    robot.reads()
    robot.journal.checkpoint(robot.journal.last_step, robot.now, b"first state")
    await robot.journal.commit(ENOUGH_S)
    assert not robot.journal.wants_checkpoint

    robot.now += sqlite_journal.CHECKPOINT_EVERY
    robot.reads()
    assert robot.journal.wants_checkpoint

    robot.journal.checkpoint(robot.journal.last_step, robot.now, b"second state" * 2_000)
    while not robot.journal.wants_checkpoint:
        robot.holds("operator")
        await robot.journal.commit(ENOUGH_S)
    await robot.journal.close()

    log = RecordedLog(folder)
    first, second = log.checkpoints()
    assert log.state(first) == b"first state"
    assert log.state(second) == b"second state" * 2_000
    assert (first.step, second.step, second.run, second.version) == (1, 2, 1, "1.2.3")


async def test_steps_are_written_with_all_that_followed(folder: Path) -> None:
    robot = await started(folder)
    robot.changes("actuation", "FAST")
    robot.holds("operator")
    await robot.journal.close()

    first, second = (STEPS.decode(line) for _, line in RecordedLog(folder).lines(1))

    assert [event.kind for event in first.events] == ["change.requested", "change.step_started"]
    assert second.given == HoldRequest("operator", "lunch", Actor("ada", "http", "10.0.0.7"))
    assert [change.name for change in second.kept] == ["operator"]


async def test_closing_gives_up_on_a_disk_that_does_not_answer(
    folder: Path, disk: Disk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sqlite_journal, "CLOSE_PATIENCE_S", 0.05)
    robot = await started(folder)
    disk.gate.clear()
    robot.holds("operator")

    await robot.journal.close()


async def test_whoever_waits_while_it_closes_is_answered(folder: Path) -> None:
    robot = await started(folder)
    robot.holds("operator")
    waiting = asyncio.create_task(robot.journal.commit(ENOUGH_S))
    await asyncio.sleep(0)

    await robot.journal.close()

    assert await waiting


async def test_large_steps_have_turns_of_their_own_and_stay_in_order(folder: Path) -> None:
    robot = await started(folder)
    first = robot.journal.last_step
    robot.steps_into_much(300)
    robot.holds("planner")
    robot.steps_into_much(300)
    robot.holds("operator")

    assert robot.journal.last_step == first + 4
    assert await robot.journal.commit(ENOUGH_S)

    events = await robot.journal.events(EventQuery(after=0, limit=1_000))
    assert [event.id for event in events] == list(range(1, 603))
    assert set(holds(await found_in(as_a_kill_leaves(folder)))) == {"planner", "operator"}
    await robot.journal.close()


async def test_what_waits_for_its_turn_is_there_when_the_service_ends(folder: Path) -> None:
    robot = await started(folder)
    robot.steps_into_much(300)
    robot.holds("planner")
    await robot.journal.close()

    assert set(holds(await found_in(folder))) == {"planner"}


async def test_nothing_takes_off_after_the_end(
    folder: Path, caplog: pytest.LogCaptureFixture
) -> None:
    robot = await started(folder)
    await robot.journal.commit(ENOUGH_S)
    await asyncio.sleep(2 * sqlite_journal.BATCH_S)
    robot.steps_into_much(300)
    await robot.journal.close()

    await asyncio.sleep(2 * sqlite_journal.BATCH_S)

    assert caplog.records == []


async def test_a_promise_that_the_end_overtakes_is_broken_at_once(folder: Path) -> None:
    robot = await started(folder)
    for _ in range(2):
        robot.steps_into_much(300)
    promised = asyncio.create_task(robot.journal.commit(ENOUGH_S))
    await asyncio.sleep(0)
    await robot.journal.close()

    with pytest.raises(StorageDegradedError, match="storage is closed"):
        await promised
