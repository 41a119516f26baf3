"""A folder of data with runs that a service recorded."""

import asyncio
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from api.distribution import installed_version
from service.checkpoint import checkpoint_of
from service.replay import core_of_boot, replay_step
from service.storage.journal import Boot
from service.storage.sqlite.journal import SqliteJournal
from service.storage.sqlite.opening import StoreSettings
from tests.support.good import GOOD
from tests.support.manual_clock import ManualClock
from tests.support.recorded_robot import BOOT, RecordedRobot


def boot_of(number: int) -> Boot:
    """Return a run of this release."""
    return replace(BOOT, epoch=f"run-{number}", version=installed_version())


def held_on_its_way() -> RecordedRobot:
    """Return a robot that drove, was held, and drives again."""
    robot = RecordedRobot()
    robot.read(**GOOD)
    robot.submit_task()
    robot.advance(1)
    robot.hold("gate", "closed")
    robot.advance(2)
    robot.release("gate")
    robot.advance(1)
    return robot


def store(folder: Path, *robots: RecordedRobot, checkpoints: Sequence[int] = ()) -> None:
    """Write runs into a folder, one after the other.

    Args:
        folder: Of the robot.
        robots: One for each run.
        checkpoints: Numbers of steps of the first run after which a checkpoint is written.
    """

    async def write() -> None:
        for number, robot in enumerate(robots, 1):
            boot = boot_of(number)
            settings = StoreSettings(folder, "robot")
            journal = await SqliteJournal.open(settings, boot, ManualClock(boot.started_at))
            core = core_of_boot(boot)
            for place, (step, recorded) in enumerate(
                zip(robot.taken, robot.recorded(), strict=True), 1
            ):
                journal.note(step)
                if number == 1 and checkpoints:
                    assert replay_step(core, recorded, place) is None
                    if place in checkpoints:
                        state = checkpoint_of(core, boot.version)
                        journal.checkpoint(journal.last_step, step.at, state)
            await journal.close()

    asyncio.run(write())
