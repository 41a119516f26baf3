"""A disk that is full or read-only for real: a small file system, mounted for the test."""

import asyncio
import subprocess
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from domain.errors import StorageDegradedError
from service.storage.journal import EventQuery
from service.storage.sqlite import journal as sqlite_journal
from tests.support.folder_robot import ENOUGH_S, as_a_kill_leaves, found_in, holds, started
from tests.support.noted_robot import NotedRobot

SIZE = 2 * 2**20


def mount(*words: str) -> bool:
    done = subprocess.run(["mount", *words], capture_output=True, check=False)
    return done.returncode == 0


@pytest.fixture
def disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return the folder of a file system of 2 MiB."""
    monkeypatch.setattr(sqlite_journal, "RETRY_S", 0.02)
    folder = tmp_path / "disk"
    folder.mkdir()
    if not mount("-t", "tmpfs", "-o", f"size={SIZE}", "none", str(folder)):
        pytest.skip("no file system can be mounted here")
    yield folder
    subprocess.run(["umount", "-l", str(folder)], check=True)


def fill(disk: Path) -> Path:
    """Leave no room at all, and return the file that takes it."""
    ballast = disk / "ballast"
    try:
        with ballast.open("wb", buffering=0) as file:
            while True:
                file.write(b"x" * 4_096)
    except OSError:
        return ballast


async def until(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(ENOUGH_S):
        while not condition():  # noqa: ASYNC110  # what it waits for is in another thread
            await asyncio.sleep(0.005)


async def fails(robot: NotedRobot) -> None:
    """Note steps until none can be written any more."""
    with suppress(StorageDegradedError):
        for number in range(10_000):
            robot.holds("operator", f"reason {number} " * 20)
            await robot.journal.commit(ENOUGH_S)
        pytest.fail("the disk did not fill up")


async def test_a_full_disk_is_told_and_nothing_is_lost_once_there_is_room(disk: Path) -> None:
    robot = await started(disk / "robot")
    robot.holds("winter")
    await robot.journal.commit(ENOUGH_S)
    ballast = fill(disk)

    await fails(robot)
    assert "full" in (robot.journal.status().reason or "")
    robot.holds("spring")
    for _ in range(100):
        robot.reads()
    ballast.unlink()
    await until(lambda: robot.journal.status().reason is None)

    assert await robot.journal.commit(ENOUGH_S)
    events = await robot.journal.events(EventQuery(after=0, limit=20_000))
    assert [event.id for event in events] == list(range(1, robot.next_event))
    assert robot.journal.status().lost_inputs == 0
    await robot.journal.close()
    assert set(holds(await found_in(disk / "robot"))) == {"winter", "operator", "spring"}


async def test_what_was_answered_is_there_though_the_disk_stayed_full(disk: Path) -> None:
    robot = await started(disk / "robot")
    robot.holds("winter")
    await robot.journal.commit(ENOUGH_S)
    ballast = fill(disk)
    await fails(robot)
    await robot.journal.close()
    ballast.unlink()

    assert {"winter"} <= set(holds(await found_in(disk / "robot")))


async def test_a_service_starts_on_a_full_disk_and_knows_what_was_kept(
    disk: Path, tmp_path: Path
) -> None:
    robot = await started(disk / "robot")
    robot.holds("winter")
    await robot.journal.commit(ENOUGH_S)
    left = as_a_kill_leaves(disk / "robot")
    await robot.journal.close()
    ballast = fill(disk)

    robot = await started(left, 2)
    assert set(holds(robot.journal.found)) == {"winter"}
    assert robot.journal.found.restored.stop_because == ""
    await fails(robot)
    robot.holds("spring")
    ballast.unlink()
    await until(lambda: robot.journal.status().reason is None)
    await robot.journal.close()

    assert set(holds(await found_in(left, 3))) == {"winter", "operator", "spring"}


async def test_a_service_starts_on_a_disk_that_is_read_only(disk: Path) -> None:
    robot = await started(disk / "robot")
    robot.holds("winter")
    await robot.journal.commit(ENOUGH_S)
    left = as_a_kill_leaves(disk / "robot")
    await robot.journal.close()
    assert mount("-o", "remount,ro", str(disk))

    robot = await started(left, 2)
    assert set(holds(robot.journal.found)) == {"winter"}
    assert robot.journal.found.restored.stop_because == ""
    assert robot.journal.status().reason is not None
    robot.holds("spring")
    with pytest.raises(StorageDegradedError):
        await robot.journal.commit(ENOUGH_S)
    assert mount("-o", "remount,rw", str(disk))
    await until(lambda: robot.journal.status().reason is None)
    await robot.journal.close()

    found = await found_in(left, 3)
    assert set(holds(found)) == {"winter", "spring"}
    assert found.restored.boot == 3
