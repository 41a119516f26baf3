"""A process that sets one hold after the other, and says on standard output which are durable.

Run with the folder and the number of the run; it goes on until it is killed.
"""

import asyncio
import sys
from pathlib import Path

from service.clock import MonotonicClock
from service.storage.sqlite.folder import Retention
from service.storage.sqlite.journal import SqliteJournal
from service.storage.sqlite.opening import StoreSettings
from tests.support.noted_robot import NotedRobot, boot

SETTINGS = Retention(file_bytes=200_000)


async def write(folder: Path, run: int) -> None:
    clock = MonotonicClock()
    settings = StoreSettings(folder, "robot", SETTINGS)
    journal = await SqliteJournal.open(settings, boot(run, clock.now()), clock)
    robot = NotedRobot(journal)
    number = 0
    while True:
        number += 1
        robot.holds("operator", f"{run}.{number}")
        for _ in range(20):
            robot.reads()
        if await journal.commit(10.0):
            print(number, robot.next_event - 1, flush=True)


if __name__ == "__main__":
    asyncio.run(write(Path(sys.argv[1]), int(sys.argv[2])))
