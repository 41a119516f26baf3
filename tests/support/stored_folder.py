"""Makes the folder that `tests/data/store` has of each version of the stored files.

Run once before a version changes: python -m tests.support.stored_folder tests/data/store/v1
"""

import asyncio
import sys
from pathlib import Path

from tests.support.folder_robot import started


async def make(folder: Path) -> None:
    """Let two runs of a service use a folder and end."""
    for run in (1, 2):
        robot = await started(folder, run)
        journal = robot.journal
        robot.changes("left/arm", "FAST")
        robot.holds("operator", "winter")
        robot.reads(0.5)
        journal.checkpoint(journal.last_step, robot.now, b"state of run %d" % run)
        journal.keep("simulation", {"pose": [1.0, 2.5, 0.0]})
        if run > 1:
            robot.holds("planner", "no route")
            robot.releases("operator")
        await journal.close()
    (folder / "lock").unlink()


if __name__ == "__main__":
    asyncio.run(make(Path(sys.argv[1])))
