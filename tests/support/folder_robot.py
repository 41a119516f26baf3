"""A robot with a folder, whose service is started, ended, killed and started again."""

import shutil
from contextlib import suppress
from pathlib import Path

from domain.kept import KeptHold
from service.storage.journal import Found
from service.storage.sqlite.folder import DEFAULT_RETENTION, Retention
from service.storage.sqlite.journal import SqliteJournal
from service.storage.sqlite.opening import StoreSettings
from tests.support.manual_clock import ManualClock
from tests.support.noted_robot import NotedRobot, boot

ENOUGH_S = 20.0


async def started(
    folder: Path,
    run: int = 1,
    retention: Retention = DEFAULT_RETENTION,
    robot: str = "robot",
    backlog_bytes: int = 2**20,
) -> NotedRobot:
    """Start the service of a robot on a folder."""
    settings = StoreSettings(folder, robot, retention, backlog_bytes)
    return NotedRobot(await SqliteJournal.open(settings, boot(run), ManualClock()))


async def found_in(folder: Path, run: int = 99) -> Found:
    """Start once more, and return what is found."""
    robot = await started(folder, run)
    await robot.journal.close()
    return robot.journal.found


def holds(found: Found) -> dict[str, str]:
    """Return the holds that were restored: who set them, and why."""
    kept = found.restored.kept
    return {value.owner: value.reason for value in kept if isinstance(value, KeptHold)}


def as_a_kill_leaves(folder: Path) -> Path:
    """Return a copy of a folder that is in use, as whoever starts after a kill finds it."""
    copy = folder.with_name(f"{folder.name}-after-a-kill")
    before = None
    # A kill stops all at one moment; a copy of files that change meanwhile is of several.
    while before is None or _stamps(folder) != before:
        before = _stamps(folder)
        shutil.rmtree(copy, ignore_errors=True)
        with suppress(shutil.Error):
            shutil.copytree(folder, copy)
    return copy


def _stamps(folder: Path) -> list[tuple[str, int, int]]:
    found = []
    for path in sorted(folder.rglob("*")):
        with suppress(FileNotFoundError):
            stat = path.stat()
            found.append((str(path), stat.st_size, stat.st_mtime_ns))
    return found


def spoil(path: Path, at: int = 100, text: bytes = b"spoilt" * 2_000) -> None:
    """Overwrite a piece of a file that nobody has open."""
    with path.open("r+b") as file:
        file.seek(at)
        file.write(text)
