"""Each operation on the disk fails in turn: afterwards the old or the new state, never neither."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.storage.sqlite import journal as sqlite_journal
from tests.support.disk_story import check, fresh, tell
from tests.support.faulty_disk import Fault, FaultyDisk

SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
POINTS = 12
"""Of each fault, without soak: spread evenly over the story."""
IN_MEMORY = Path("/dev/shm")


@pytest.fixture
def folder(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.setattr(sqlite_journal, "RETRY_S", 0.005)
    # Each commit is followed by all that can wait, so that each of its operations fails as well.
    monkeypatch.setattr(sqlite_journal, "FOLLOW_EVERY_S", 0.0)
    # What a sync does is up to the faults; a real one would only take time.
    base = tempfile.mkdtemp(dir=IN_MEMORY if IN_MEMORY.is_dir() else None)
    yield Path(base) / "robot"
    shutil.rmtree(base)


async def operations(folder: Path) -> int:
    """Return how many operations the story takes, after checking it on a disk that works."""
    disk = FaultyDisk(fresh(folder))
    told = await tell(disk)
    assert told.durable == len(told.reasons) - 1
    await check(folder, told)
    return disk.count


@pytest.mark.parametrize(
    ("fault", "lasts"),
    [
        ("fails", 1),
        ("fails", 40),
        ("full", 1),
        ("full", 40),
        ("is short", 1),
        ("is slow", 1),
        ("dies", 1),
        ("loses power", 1),
    ],
)
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
async def test_afterwards_there_is_the_old_or_the_new_state(
    folder: Path, fault: Fault, lasts: int
) -> None:
    count = await operations(folder)
    stride = 1 if SOAK else max(1, count // POINTS)
    wrong: list[str] = []
    for at in range(1, count + 1, stride):
        disk = FaultyDisk(fresh(folder), fault, at, lasts, slow_s=0.02)
        try:
            told = await tell(disk)
            await check(disk.left or folder, told)
        except AssertionError as error:
            wrong.append(f"{fault} at {at}: {error}")

    assert wrong == []


async def test_what_was_answered_as_durable_is_synced(folder: Path) -> None:
    # Loss of power right before the last operation of a story, all of which was durable.
    count = await operations(folder)
    disk = FaultyDisk(fresh(folder), "loses power", count)

    told = await tell(disk)

    assert disk.left is not None
    assert told.durable == len(told.reasons) - 1
    await check(disk.left, told)
