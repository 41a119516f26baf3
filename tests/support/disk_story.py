"""One recorded story of two runs on a disk that may fail, and what must be true afterwards."""

import shutil
from dataclasses import dataclass, field
from pathlib import Path

from pydantic_core import from_json

from domain.errors import StorageDegradedError
from domain.events.event import RecordedEvent
from domain.inputs import Restored
from domain.kept import KeptHold
from service.codec.codec import STEPS
from service.storage.journal import EventQuery
from service.storage.sqlite.announced_file import last_text
from service.storage.sqlite.folder import Retention
from service.storage.sqlite.journal import SqliteJournal
from service.storage.sqlite.opening import StoreSettings
from service.storage.sqlite.places import Places
from service.storage.sqlite.recorded_log import RecordedLog
from tests.support.faulty_disk import FaultyDisk, faulty
from tests.support.manual_clock import ManualClock
from tests.support.noted_robot import NotedRobot, boot

LENGTH = 5
SMALL = Retention(file_bytes=60_000, total_bytes=10**9)
"""A file of the log is full after two or three steps."""


@dataclass
class Told:
    """What the story did, as those who got its answers know it."""

    reasons: list[str] = field(default_factory=lambda: [""])
    """Reason of the one hold after each step; empty: no hold."""
    durable: int = 0
    """How many steps were answered as durable."""
    events: list[int] = field(default_factory=list)
    """Ids of the events that were published."""
    announced: int = 0
    """How many steps were tried to be announced, before they were done."""
    promised: int = 0
    """Number of the last one of which that was known to be on disk; 0: none."""


async def tell(disk: FaultyDisk) -> Told:
    """Let two runs of a service use a disk; none of them must notice more than it is told."""
    told = Told()
    with faulty(disk):
        for number in (1, 2):
            await _run(disk, number, told)
    return told


async def _run(disk: FaultyDisk, number: int, told: Told) -> None:
    settings = StoreSettings(disk.folder, "robot", SMALL)
    journal = await SqliteJournal.open(settings, boot(number), ManualClock())
    robot = NotedRobot(journal)
    for step in range(LENGTH):
        if disk.left is not None:
            # Whoever is dead tells nobody anything.
            break
        reason = f"{number}.{step}"
        told.announced += 1
        try:
            if await journal.announce(told.announced, 5.0):
                told.promised = told.announced
        except StorageDegradedError:
            pass
        robot.holds("operator", reason)
        told.reasons.append(reason)
        told.events.append(robot.next_event - 1)
        robot.reads()
        if step == 1:
            journal.checkpoint(journal.last_step, robot.now, b"state" * 2_000)
        try:
            if await journal.commit(5.0):
                told.durable = len(told.reasons) - 1
        except StorageDegradedError:
            pass
    await journal.close()


async def check(folder: Path, told: Told) -> None:
    """Start twice on a disk that works, and look whether all is there that must be."""
    settings = StoreSettings(folder, "robot", SMALL)
    first, second = [await _restored(settings, number) for number in (8, 9)]
    last = last_text(Places(folder).announced)
    announced = 0 if last is None else from_json(last)[-1]

    assert told.promised <= announced <= told.announced, (announced, told)
    assert first.stop_because == "", first.stop_because
    assert _reason(first) in told.reasons[told.durable :], (first, told)
    assert _reason(second) == _reason(first)
    next_ids = range(first.next_event, first.next_event + 1_000)
    assert not [used for used in told.events if used in next_ids], (first, told)
    assert len(told.events) == len(set(told.events)), told
    _check_log(folder, told)


async def _restored(settings: StoreSettings, number: int) -> Restored:
    journal = await SqliteJournal.open(settings, boot(number), ManualClock())
    await journal.close()
    return journal.found.restored


def _reason(found: Restored) -> str:
    reasons = [hold.reason for hold in found.kept if isinstance(hold, KeptHold)]
    return reasons[0] if reasons else ""


def _check_log(folder: Path, told: Told) -> None:
    """Check that each step is there once with its event, or not at all."""
    log = RecordedLog(folder)
    events = [event.id for event in log.events(EventQuery(after=0, limit=1_000))]
    assert events == sorted(set(events))
    in_steps: list[RecordedEvent] = []
    for run in log.runs():
        numbers = []
        for number, line in log.lines(run.number):
            numbers.append(number)
            in_steps += STEPS.decode(line).events
        assert numbers == sorted(set(numbers))
    assert [event.id for event in in_steps] == events


def fresh(folder: Path) -> Path:
    """Return a folder that is not there yet."""
    for path in (folder, folder.with_name(f"{folder.name}-left")):
        shutil.rmtree(path, ignore_errors=True)
    return folder
