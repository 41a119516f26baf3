import asyncio
import shutil
from pathlib import Path

import apsw
import pytest

from domain.errors import StorageDegradedError
from domain.timebase import seconds
from service.storage.journal import EventQuery
from service.storage.sqlite import journal as sqlite_journal
from service.storage.sqlite.folder import Retention
from service.storage.sqlite.log_file import LogFile
from service.storage.sqlite.places import Places
from service.storage.sqlite.recorded_log import RecordedLog
from service.storage.sqlite.state_file import StateFile
from tests.support.folder_robot import ENOUGH_S, as_a_kill_leaves, found_in, holds, spoil, started
from tests.support.noted_robot import NotedRobot

EACH_ITS_OWN_FILE = 1
"""Bytes of a file after which the next one is begun: fewer than any file has."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "robot"


@pytest.fixture(autouse=True)
def _at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let what can wait follow each commit."""
    monkeypatch.setattr(sqlite_journal, "FOLLOW_EVERY_S", 0.0)


def numbers(folder: Path) -> list[int]:
    return Places(folder).log_numbers()


async def holds_and_commits(robot: NotedRobot, times: int, apart_s: float = 0.0) -> None:
    for _ in range(times):
        robot.now += seconds(apart_s)
        robot.holds("operator")
        assert await robot.journal.commit(ENOUGH_S)


async def test_the_log_goes_on_in_a_new_file_when_one_is_large(folder: Path) -> None:
    robot = await started(folder, retention=Retention(file_bytes=EACH_ITS_OWN_FILE))
    await holds_and_commits(robot, 3)
    events = await robot.journal.events(EventQuery(after=0))
    await robot.journal.close()

    assert len(numbers(folder)) > 3
    assert [event.id for event in events] == [1, 2, 3]
    assert set(holds(await found_in(folder))) == {"operator"}


async def test_the_log_goes_on_in_a_new_file_after_a_day_of_running(folder: Path) -> None:
    robot = await started(folder, retention=Retention(file_running=seconds(100.0)))
    await holds_and_commits(robot, 2, apart_s=60.0)
    assert numbers(folder) == [1]
    await holds_and_commits(robot, 2, apart_s=60.0)
    await robot.journal.close()

    assert numbers(folder) == [1, 2]


async def test_each_file_has_all_that_is_kept(folder: Path) -> None:
    robot = await started(folder, retention=Retention(file_bytes=EACH_ITS_OWN_FILE))
    robot.holds("winter")
    await holds_and_commits(robot, 3)
    robot.releases("winter")
    robot.holds("spring")
    await robot.journal.close()
    for number in numbers(folder)[:-1]:
        Places(folder).log(number).unlink()
    Places(folder).state.unlink()

    found = await found_in(folder)

    assert set(holds(found)) == {"operator", "spring"}
    assert found.restored.next_event == 7


async def test_much_that_is_kept_does_not_make_a_file_of_each_commit(folder: Path) -> None:
    robot = await started(folder, retention=Retention(file_bytes=2_000_000))
    robot.journal.keep("map", "x" * 3_000_000)
    await holds_and_commits(robot, 10)
    await robot.journal.close()

    assert numbers(folder) == [1, 2]


async def test_the_oldest_files_go_when_the_log_is_too_large(folder: Path) -> None:
    keep = Retention(file_bytes=EACH_ITS_OWN_FILE, total_bytes=160_000)
    robot = await started(folder, retention=keep)
    robot.holds("winter")
    await holds_and_commits(robot, 10)
    events = await robot.journal.events(EventQuery(after=0))
    await robot.journal.close()

    assert 1 < len(numbers(folder)) < 5
    assert numbers(folder)[-1] == 13
    assert events[0].id > 1
    assert [event.id for event in events] == list(range(events[0].id, 12))
    assert set(holds(await found_in(folder))) == {"winter", "operator"}


async def test_the_oldest_files_go_when_enough_running_time_is_recorded(folder: Path) -> None:
    keep = Retention(file_running=seconds(100.0), total_running=seconds(250.0))
    robot = await started(folder, retention=keep)
    await holds_and_commits(robot, 20, apart_s=60.0)
    await robot.journal.close()

    recorded_s = 60.05 * len(list(RecordedLog(folder).lines(1)))
    assert numbers(folder)[0] > 1
    assert 250.0 <= recorded_s < 500.0


async def test_time_while_nothing_runs_drops_nothing(folder: Path) -> None:
    # Each run is a day after the one before; by running time they are seconds.
    keep = Retention(total_running=seconds(3_600.0))
    for run in range(1, 6):
        robot = await started(folder, run, keep)
        await holds_and_commits(robot, 1)
        await robot.journal.close()

    assert len(RecordedLog(folder).runs()) == 5


async def test_the_file_that_is_written_is_never_dropped(folder: Path) -> None:
    robot = await started(folder, retention=Retention(total_bytes=1, total_running=1))
    await holds_and_commits(robot, 3)
    await robot.journal.close()

    assert numbers(folder) == [1]


async def until_durable(robot: NotedRobot) -> bool:
    async with asyncio.timeout(ENOUGH_S):
        while True:
            try:
                return await robot.journal.commit(ENOUGH_S)
            except StorageDegradedError:
                await asyncio.sleep(0.01)


async def test_a_log_that_breaks_while_storage_fails_is_put_aside(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sqlite_journal, "RETRY_S", 0.01)
    robot = await started(folder)
    robot.holds("winter")
    await robot.journal.commit(ENOUGH_S)

    def break_and_fail(file: LogFile, *_: object) -> None:
        file.close()
        spoil(file.path)
        raise apsw.IOError("disk I/O error")

    with monkeypatch.context() as patch:
        patch.setattr(LogFile, "write", break_and_fail)
        robot.holds("spring")
        with pytest.raises(StorageDegradedError):
            await robot.journal.commit(ENOUGH_S)
    assert await until_durable(robot)

    assert numbers(folder)[0] > 1
    assert set(holds(await found_in(as_a_kill_leaves(folder)))) == {"winter", "spring"}
    await robot.journal.close()


async def test_a_folder_that_somebody_deleted_is_made_again(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sqlite_journal, "RETRY_S", 0.01)
    robot = await started(folder)
    robot.holds("winter")
    await robot.journal.commit(ENOUGH_S)
    # Moved away at once: the journal may write into it while it is emptied.
    shutil.move(folder, folder.with_name("deleted"))
    shutil.rmtree(folder.with_name("deleted"))
    robot.holds("spring")
    with pytest.raises(StorageDegradedError):
        await robot.journal.commit(ENOUGH_S)
    robot.holds("summer")
    assert await until_durable(robot)
    await robot.journal.close()

    assert set(holds(await found_in(folder))) == {"winter", "spring", "summer"}


async def test_a_state_that_cannot_be_written_is_told_and_made_anew(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = await started(folder)

    def fail(*_: object) -> None:
        raise apsw.IOError("disk I/O error")

    with monkeypatch.context() as patch:
        patch.setattr(StateFile, "apply", fail)
        robot.holds("winter")
        assert await robot.journal.commit(ENOUGH_S)
        await robot.journal.events(EventQuery())
        assert await robot.journal.commit(ENOUGH_S)
    robot.holds("spring")
    await robot.journal.commit(ENOUGH_S)
    await robot.journal.commit(ENOUGH_S)

    assert robot.journal.status().reason is None
    await robot.journal.close()
    state = StateFile.open(Places(folder).state)
    assert {name for kind, name in state.kept() if kind == "kept_hold"} == {"winter", "spring"}
    state.close()
