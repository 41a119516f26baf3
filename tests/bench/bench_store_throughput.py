"""Thousands of inputs a second through the live supervisor, all of which are written down."""

import asyncio
import gc
import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

import pytest
import uvloop

from api.serving.garbage import Heap
from domain.inputs import Reading, Readings
from service.clock import MonotonicClock
from service.storage.sqlite.journal import SqliteJournal
from service.storage.sqlite.opening import StoreSettings
from service.storage.sqlite.recorded_log import RecordedLog
from service.supervisor import Supervisor
from tests.support.bench import Row, quantiles, report
from tests.support.live_robot import make_supervisor
from tests.support.noted_robot import boot

pytestmark = pytest.mark.bench

PER_S = 5_000
SECONDS = 60.0
CONTROL_S = 20.0
WARM_S = 2.0
PERIOD_S = 0.05
EARLY_S = 10.0
"""When memory is looked at first."""
AT_ONCE = 10
"""Readings in one turn of the loop; a tick waits for as many."""
SOURCE = "load"


@dataclass
class Load:
    """What was asked of a supervisor, and how it went."""

    submitted: int = 0
    ticks: list[float] = field(default_factory=list)
    """Times between two ticks, s."""
    early_mb: float = 0.0
    late_mb: float = 0.0
    elapsed_s: float = 0.0
    loop_s: float = 0.0
    """Processor time of the event loop."""
    cpu_s: float = 0.0
    """Of all threads."""

    @property
    def row(self) -> Row:
        """Return what is reported of it."""
        errors = [abs(each - PERIOD_S) for each in self.ticks]
        rate = self.submitted / self.elapsed_s
        return {
            **quantiles(errors),
            "ticks": len(errors),
            "inputs_per_s": round(rate),
            "loop_percent": round(100 * self.loop_s / self.elapsed_s),
            "CPU_percent": round(100 * self.cpu_s / self.elapsed_s),
        }


def test_all_is_written_down_while_the_tick_goes_on(tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
        control = runner.run(_loaded(None, CONTROL_S))
        journaled = runner.run(_loaded(folder, SECONDS))
    read = _read_back(folder)
    report(
        "store_throughput",
        f"{PER_S} inputs per second, written down",
        f"Readings of one signal are submitted to a live supervisor of the example robot, {PER_S} "
        f"per second for {SECONDS:g} s, with a journal in a folder; before, {CONTROL_S:g} s of the "
        "same without a journal as reference. Deviation of the periods of its tick from 50 ms; "
        f"memory of the process after {EARLY_S:g} s and at the end; and how many of the readings "
        "the log of the folder has afterwards.",
        {
            "without a journal": control.row,
            "with a journal": {
                **journaled.row,
                "early_mb": journaled.early_mb,
                "late_mb": journaled.late_mb,
                "inputs": journaled.submitted,
                "in the log": read,
                "lost": journaled.submitted - read,
            },
        },
        asked="none lost, p99 of the tick below 5 ms, memory does not grow.",
    )
    assert read == journaled.submitted


async def _loaded(folder: Path | None, duration_s: float) -> Load:
    """Run a supervisor under load."""
    clock = MonotonicClock()
    journal = None
    if folder is not None:
        settings = StoreSettings(folder, "robot")
        journal = await SqliteJournal.open(settings, boot(1, clock.now()), clock)
    supervisor = make_supervisor(clock, journal=journal)
    run = asyncio.create_task(supervisor.run())
    await asyncio.sleep(WARM_S)
    load = Load()
    supervisor.publisher.on_tick.append(load.ticks.append)
    with _garbage_as_served(supervisor):
        await _submit(supervisor, load, duration_s)
    run.cancel()
    with suppress(asyncio.CancelledError):
        await run
    if journal is not None:
        await journal.close()
    return load


@contextmanager
def _garbage_as_served(supervisor: Supervisor) -> Iterator[None]:
    """Collect garbage as `pilothouse serve` does: a collection of all takes 0.1 s in a test."""
    before = gc.get_threshold()
    heap = Heap()
    heap.settle()
    supervisor.publisher.on_tick.append(heap.note_tick)
    try:
        yield
    finally:
        gc.callbacks.remove(heap.follow)
        gc.set_threshold(*before)
        gc.unfreeze()


async def _submit(supervisor: Supervisor, load: Load, duration_s: float) -> None:
    """Submit readings at an even rate; what is late is made up for."""
    begin, loop, cpu = time.perf_counter(), time.thread_time(), time.process_time()
    while (elapsed := time.perf_counter() - begin) < duration_s:
        behind = int(elapsed * PER_S) - load.submitted
        for _ in range(min(AT_ONCE, behind)):
            value = 0.6 + load.submitted % 1_000 / 10_000
            supervisor.submit(Readings((Reading("battery_level", value),), SOURCE))
            load.submitted += 1
        if not load.early_mb and elapsed > min(EARLY_S, duration_s / 2):
            load.early_mb = _memory_mb()
        await asyncio.sleep(0.0 if behind > AT_ONCE else 0.001)
    load.elapsed_s = elapsed
    load.loop_s, load.cpu_s = time.thread_time() - loop, time.process_time() - cpu
    load.late_mb = _memory_mb()


def _read_back(folder: Path) -> int:
    """Return how many of the readings are in the log, whose steps follow each other."""
    log = RecordedLog(folder)
    assert log.holes() == []
    mine = f'"{SOURCE}"'.encode()
    numbers: list[int] = []
    found = 0
    for number, line in log.lines(1):
        numbers.append(number)
        found += mine in line
    assert _follow(numbers)
    return found


def _follow(numbers: Sequence[int]) -> bool:
    return list(numbers) == list(range(numbers[0], numbers[0] + len(numbers)))


def _memory_mb() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return round(pages * os.sysconf("SC_PAGE_SIZE") / 1e6, 1)
