"""What it costs to forget nothing: of the loop, of an answer that waits, and of a start."""

import asyncio
import os
import resource
import shutil
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from domain.inputs import Reading, Readings
from domain.outbox import NOTHING
from service.clock import MonotonicClock
from service.storage.journal import Journal, Step
from service.storage.sqlite.batch import Batch
from service.storage.sqlite.journal import SqliteJournal
from service.storage.sqlite.log_file import LogFile
from service.storage.sqlite.opening import StoreSettings
from tests.support.bench import quantiles, report
from tests.support.log_files import flight, row, run
from tests.support.noted_robot import NotedRobot, boot

pytestmark = pytest.mark.bench

READINGS = Readings((Reading("battery_level", 0.5),), "battery")
TICK_S = 0.05
LOAD_PER_S = 5_000
LOAD_S = 20.0
COMMITS = 500
FILES, FILE_BYTES = 30, 60 * 2**20


async def opened(folder: Path, number: int = 1) -> SqliteJournal:
    clock = MonotonicClock()
    settings = StoreSettings(folder, "robot")
    return await SqliteJournal.open(settings, boot(number, clock.now()), clock)


async def test_what_a_step_costs_the_loop(tmp_path: Path) -> None:
    journal = await opened(tmp_path / "robot")
    start = journal.boot.started_at
    costs_us = []
    for turn in range(100):
        steps = [Step(start + 100 * turn + n, READINGS, False, NOTHING) for n in range(100)]
        began = time.process_time_ns()
        for step in steps:
            journal.note(step)
        costs_us.append((time.process_time_ns() - began) / 100_000)
        await journal.commit(10.0)
    await journal.close()

    ordered = sorted(costs_us)
    row_ = {"p50_us": round(ordered[50], 2), "p90_us": round(ordered[90], 2)}
    report(
        "journal_note",
        "Noting a step",
        "CPU time of `note` on the loop for a step of one reading; means of 100 steps.",
        {"note": row_},
        asked="about 10 us",
    )


async def test_an_answer_that_waits_for_the_disk(tmp_path: Path) -> None:
    journal = await opened(tmp_path / "robot")
    robot = NotedRobot(journal)
    bare, committed = [], []
    fd = os.open(tmp_path / "bare", os.O_CREAT | os.O_RDWR)
    os.write(fd, bytes(8_192 * COMMITS))
    os.fsync(fd)
    for number in range(COMMITS):
        began = time.perf_counter()
        os.pwrite(fd, b"x" * 8_192, 8_192 * number)
        os.fdatasync(fd)
        bare.append(time.perf_counter() - began)
        robot.holds("operator")
        began = time.perf_counter()
        assert await journal.commit(10.0)
        committed.append(time.perf_counter() - began)
        await asyncio.sleep(0.01)
    os.close(fd)
    await journal.close()

    report(
        "journal_commit",
        "Waiting for a commit",
        f"{COMMITS} times in turn: 8 KiB of a file that is there are written and synced, and a "
        "step with an event and a kept value is committed, nobody else waiting.",
        {"bare sync": quantiles(bare), "commit": quantiles(committed)},
        asked="p99 at most 5 ms more than a bare sync",
    )


async def _ticks(duration_s: float) -> Sequence[float]:
    """Return by how much each tick of 20 Hz was late, in s."""
    loop = asyncio.get_running_loop()
    start, late = loop.time(), []
    for number in range(1, int(duration_s / TICK_S)):
        due = start + number * TICK_S
        await asyncio.sleep(due - loop.time())
        late.append(loop.time() - due)
    return late


async def _load(journal: Journal | None, duration_s: float) -> int:
    """Note steps at an even rate, and return how many."""
    loop, clock, done = asyncio.get_running_loop(), MonotonicClock(), 0
    start = loop.time()
    while (elapsed := loop.time() - start) < duration_s:
        for _ in range(min(50, int(elapsed * LOAD_PER_S) - done)):
            step = Step(clock.now(), READINGS, False, NOTHING)
            done += 1
            if journal is not None:
                journal.note(step)
        await asyncio.sleep(0.001)
    return done


async def test_the_tick_while_thousands_of_steps_are_noted(tmp_path: Path) -> None:
    control, _ = await asyncio.gather(_ticks(LOAD_S), _load(None, LOAD_S))
    journal = await opened(tmp_path / "robot")
    before = resource.getrusage(resource.RUSAGE_SELF)
    noted, count = await asyncio.gather(_ticks(LOAD_S), _load(journal, LOAD_S))
    after = resource.getrusage(resource.RUSAGE_SELF)
    await journal.commit(10.0)
    status = journal.status()
    await journal.close()

    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    report(
        "journal_load",
        f"{LOAD_PER_S} steps per second",
        f"How late a tick of 20 Hz is, in {LOAD_S:g} s with as many steps that are noted, and in "
        "as long without a journal right before; CPU time of all threads.",
        {
            "control": quantiles(control),
            "journal": {
                **quantiles(noted),
                "steps": count,
                "lost": status.lost_inputs,
                "cpu_percent": round(100 * cpu_s / LOAD_S, 1),
                "grown_mb": round((after.ru_maxrss - before.ru_maxrss) / 1024, 1),
                "log_mb": round(status.logs["inputs"].bytes / 2**20, 2),
            },
        },
        asked="p99 below 5 ms beside the control; none lost",
    )


async def test_the_cost_at_rest(tmp_path: Path) -> None:
    journal = await opened(tmp_path / "robot")
    clock, loop = MonotonicClock(), asyncio.get_running_loop()
    began, start = time.process_time(), loop.time()
    for number in range(1, int(LOAD_S / TICK_S)):
        await asyncio.sleep(start + number * TICK_S - loop.time())
        journal.note(Step(clock.now(), READINGS, False, NOTHING))
    cpu_s = time.process_time() - began
    await journal.commit(10.0)
    per_day = journal.status().logs["inputs"].bytes * 86_400 / LOAD_S / 2**20
    await journal.close()

    report(
        "journal_rest",
        "At rest",
        f"One step in each of 20 ticks per second, for {LOAD_S:g} s.",
        {
            "journal": {
                "cpu_percent": round(100 * cpu_s / LOAD_S, 2),
                "steps_mb_per_day": round(per_day, 1),
            }
        },
    )


def _fill(folder: Path) -> None:
    """Let a log be what 30 days leave: files that are full, each with its own steps and events."""
    first = folder / "log" / "000001.db"
    log = LogFile.open(first, 1)
    number = log.summary.next_step
    while log.size() < FILE_BYTES:
        batches = []
        for _ in range(200):
            number += 1
            steps, events = [os.urandom(300).hex().encode()], [row(number)]
            batches.append(Batch(number, number, steps, number, number, number, events))
        log.write(flight(*batches), run(1), {("kept_progress", "t1"): bytes(150)})
    log.finish()
    for copy in range(2, FILES + 1):
        shutil.copy(first, first.with_name(f"{copy:06}.db"))
    (folder / "state.db").unlink()


async def test_a_start_with_the_logs_of_a_month(tmp_path: Path) -> None:
    starts: dict[str, list[float]] = {"none": [], "a month": []}
    for name, taken in starts.items():
        folder = tmp_path / name
        await (await opened(folder)).close()
        if name == "a month":
            _fill(folder)
        for number in range(2, 12):
            began = time.perf_counter()
            journal = await opened(folder, number)
            taken.append(time.perf_counter() - began)
            await journal.close()

    report(
        "journal_start",
        "Start on a log",
        f"Opening the folder: a new one, and one with {FILES} files of {FILE_BYTES >> 20} MiB.",
        {name: quantiles(taken) for name, taken in starts.items()},
        asked="at most 0.5 s more",
    )
