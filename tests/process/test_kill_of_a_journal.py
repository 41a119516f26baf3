"""A process that writes is killed at any moment: what it answered as durable is there."""

import os
import random
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from domain.kept import KeptHold
from service.storage.journal import EventQuery, Found
from service.storage.sqlite.journal import SqliteJournal
from service.storage.sqlite.opening import StoreSettings
from tests.support.journal_writer import SETTINGS
from tests.support.manual_clock import ManualClock
from tests.support.noted_robot import boot

ROUNDS = 200 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 10
PROJECT = Path(__file__).resolve().parents[2]


@dataclass
class Answers:
    """What the process said before it was killed."""

    hold: int
    """Number of the last hold that is durable."""
    event: int
    """Id of the last event that is durable."""


def write_until_killed(folder: Path, run: int, after_s: float) -> Answers:
    """Let a process write for a while after its first answer, and kill it."""
    command = [sys.executable, "-m", "tests.support.journal_writer", str(folder), str(run)]
    with subprocess.Popen(command, cwd=PROJECT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        lines = [process.stdout.readline()]
        time.sleep(after_s)
        process.kill()
        # A line that was cut off was not answered.
        lines += [line for line in process.stdout.read().splitlines(True) if line.endswith("\n")]
    hold, event = lines[-1].split()
    return Answers(int(hold), int(event))


async def found_after(folder: Path, run: int) -> tuple[Found, list[int]]:
    """Start on what is left, and return it with the ids of all events."""
    settings = StoreSettings(folder, "robot", SETTINGS)
    journal = await SqliteJournal.open(settings, boot(run), ManualClock())
    events = await journal.events(EventQuery(after=0, limit=10**6))
    await journal.close()
    return journal.found, [event.id for event in events]


async def test_what_was_answered_as_durable_outlives_the_process(tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    chance = random.Random(13)
    run = 0
    for _ in range(ROUNDS):
        run += 1
        answers = write_until_killed(folder, run, chance.uniform(0.0, 0.3))
        found, events = await found_after(folder, run + 1)
        (hold,) = (kept for kept in found.restored.kept if isinstance(kept, KeptHold))
        of_run, number = hold.reason.split(".")
        run += 1

        assert found.restored.stop_because == ""
        assert (int(of_run), int(number) >= answers.hold) == (run - 1, True)
        assert answers.event in events
        assert events == sorted(set(events))
        assert found.restored.next_event > events[-1]
        assert found.restored.boot == run
