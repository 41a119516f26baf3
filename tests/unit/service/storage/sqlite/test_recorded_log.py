from pathlib import Path

import apsw
import pytest

from service.codec.codec import STEPS
from service.storage.errors import UnusableFolderError
from service.storage.journal import EventQuery
from service.storage.sqlite.folder import Retention
from service.storage.sqlite.recorded_log import RecordedLog
from tests.support.folder_robot import ENOUGH_S, as_a_kill_leaves, started


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "robot"


async def test_each_run_is_read_with_what_its_core_was_made_of(folder: Path) -> None:
    for run in (1, 2):
        robot = await started(folder, run)
        robot.holds("operator")
        robot.reads()
        await robot.journal.close()

    first, second = RecordedLog(folder).runs()

    assert (first.number, first.first_step, first.boot.epoch) == (1, 1, "epoch-1")
    assert (second.number, second.first_step, second.boot.version) == (2, 3, "1.2.3")
    assert (second.boot.model, second.boot.robot) == ("model: text", "name: robot")
    assert first.ended_at is not None


async def test_steps_are_read_over_all_files_and_from_any_on(folder: Path) -> None:
    robot = await started(folder, retention=Retention(file_bytes=1))
    for number in range(5):
        robot.reads(number)
        robot.reads(number + 0.5)
        await robot.journal.commit(ENOUGH_S)
    log = RecordedLog(folder)

    assert len(log.runs()) == 1
    assert [number for number, _ in log.lines(1)] == list(range(1, 11))
    assert [number for number, _ in log.lines(1, after_step=4)] == list(range(5, 11))
    assert list(log.lines(2)) == []
    inputs = [STEPS.decode(line).given for _, line in log.lines(1)]
    assert [given.items[0].value for given in inputs[:3]] == [0, 0.5, 1]  # type: ignore[union-attr]
    await robot.journal.close()


async def test_a_folder_is_read_as_a_kill_left_it(folder: Path) -> None:
    robot = await started(folder)
    robot.holds("operator")
    await robot.journal.commit(ENOUGH_S)
    left = as_a_kill_leaves(folder)
    await robot.journal.close()

    log = RecordedLog(left)

    (run,) = log.runs()
    assert run.ended_at is None
    assert [event.id for event in log.events(EventQuery())] == [1]


async def test_a_state_that_was_dropped_is_said(folder: Path) -> None:
    robot = await started(folder)
    robot.reads()
    robot.journal.checkpoint(robot.journal.last_step, robot.now, b"state")
    await robot.journal.close()
    log = RecordedLog(folder)
    (checkpoint,) = log.checkpoints()
    connection = apsw.Connection(str(folder / "log" / "000001.db"))
    connection.execute("DELETE FROM checkpoints")
    connection.close()

    with pytest.raises(UnusableFolderError, match="no longer holds that checkpoint"):
        log.state(checkpoint)


def test_a_folder_without_a_log_is_said(folder: Path) -> None:
    with pytest.raises(UnusableFolderError, match="holds no log"):
        RecordedLog(folder)


def test_a_log_that_is_no_database_is_said(folder: Path) -> None:
    (folder / "log").mkdir(parents=True)
    (folder / "log" / "000001.db").write_text("Dear diary," * 1_000)

    with pytest.raises(UnusableFolderError, match="not a database"):
        RecordedLog(folder)


async def test_a_log_of_another_version_is_said(folder: Path) -> None:
    robot = await started(folder)
    await robot.journal.close()
    connection = apsw.Connection(str(folder / "log" / "000001.db"))
    connection.pragma("user_version", 7)
    connection.close()

    with pytest.raises(UnusableFolderError, match="has version 7, this release reads 1"):
        RecordedLog(folder)
