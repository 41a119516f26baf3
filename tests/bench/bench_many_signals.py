"""What a reading costs on a robot with hundreds of signals and monitors."""

import asyncio
import gc
import random
import time
from collections.abc import Iterator

import pytest

from domain.inputs import Reading, Readings
from domain.simulation.robot import SimulatedRobot
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from service.clock import continuous_clock
from service.files.model_file import LoadedModel
from service.simulation.simulated import SimulatedBackend
from service.supervisor import Supervisor
from tests.support.bench import quantile, quantiles, report
from tests.support.good import GOOD
from tests.support.live_robot import make_onboard, running
from tests.support.many_signals import batches, many_signals
from tests.support.models import actuation_model

COUNTS = (5, 200, 1_000)
ROUNDS, PER_ROUND = 40, 200
SIGNALS, MONITORS, BATCH = 200, 500, 50
BATCHES_PER_S = 200
SECONDS = 10.0
SETTLE_S = 6.0
"""Longer than the windows, so that they are full."""
MESSAGES = round(BATCHES_PER_S * (SETTLE_S + SECONDS + 1.0))
PERIOD_MS = 50.0


@pytest.mark.bench
def test_a_reading_costs_the_same_with_five_and_with_a_thousand_signals() -> None:
    robots = {count: _core(count) for count in COUNTS}
    took: dict[int, list[float]] = {count: [] for count in COUNTS}
    gc.collect()
    gc.disable()
    for number in range(ROUNDS):
        # In turns, so that what else the machine does meets all of them.
        for count, core in robots.items():
            begin = time.perf_counter()
            for step in range(PER_ROUND):
                at = seconds(1) + (number * PER_ROUND + step) * 100_000
                core.handle(Readings((Reading("battery_level", 0.9 - step % 2 / 10),), "bench"), at)
            took[count].append((time.perf_counter() - begin) / PER_ROUND)
    gc.enable()
    rows = {f"{count:,} signals": quantiles(took[count]) for count in COUNTS}
    few, many = (quantile(took[count], 0.5) for count in (COUNTS[0], COUNTS[-1]))
    report(
        "many_signals",
        "A reading among many signals",
        f"The core takes readings of one of so many signals, each with an error; {ROUNDS} rounds "
        f"of {PER_ROUND} readings, in turns; the time of one reading.",
        rows,
        asked="a ratio of 1,000 signals to 5 of at most 1.3.",
        notes=[f"The ratio is {many / few:.2f}."],
    )


@pytest.mark.bench
async def test_ten_thousand_readings_a_second_with_five_hundred_monitors() -> None:
    rows = {}
    for name, mixed in (("same statistics", False), ("different statistics", True)):
        supervisor = _supervisor(
            SupervisionSettings(many_signals(SIGNALS + 5, MONITORS, mixed=mixed))
        )
        # Made beforehand: what the bench itself does is not what is measured.
        load = iter(tuple(batches(SIGNALS, MESSAGES, BATCH, random.Random(1))))
        async with running(supervisor):
            rows[f"{name}, control"] = await _watched(supervisor, iter(()))
            gc.freeze()
            await _fed(supervisor, load, SETTLE_S)
            rows[f"{name}, 10,000 readings/s"] = await _watched(supervisor, load)
            gc.unfreeze()
        assert next(load, None) is not None
    report(
        "many_monitors",
        "10,000 readings a second with 500 monitors",
        f"A service in process with {SIGNALS} signals and {MONITORS} monitors over 5 s (mean, max, "
        f"rate, gap, std; all of one signal with the same or with different ones) takes "
        f"{BATCHES_PER_S} messages of {BATCH} readings a second, which were made before, for "
        f"{SECONDS:g} s; CPU time of the process, and the deviation of the period of the tick from "
        "50 ms. Beside it, the same service without readings.",
        rows,
        asked="at most 25 % of a core, and 5 ms at the 99th percentile.",
    )


def _supervisor(settings: SupervisionSettings) -> Supervisor:
    clock = continuous_clock()
    backend = SimulatedBackend(SimulatedRobot(actuation_model(), clock.now(), mock=False), clock)
    return Supervisor(
        LoadedModel(actuation_model(), (), ""),
        make_onboard(actuation_model(), clock.now(), settings),
        clock,
        backend,
        backend.readings,
    )


def _core(count: int) -> Supervision:
    core = Supervision(actuation_model(), SupervisionSettings(many_signals(count)), 0)
    names = [*GOOD.items(), *((f"signal_{number}", 1.0) for number in range(count - len(GOOD)))]
    core.handle(Readings(tuple(Reading(name, value) for name, value in names), "bench"), 1)
    return core


async def _fed(supervisor: Supervisor, load: Iterator[Readings], for_s: float) -> None:
    """Submit messages evenly; one that is late is made up for."""
    begin, number = time.perf_counter(), 0
    while (elapsed := time.perf_counter() - begin) < for_s:
        while number < elapsed * BATCHES_PER_S:
            number += 1
            if (given := next(load, None)) is not None:
                supervisor.submit(given)
            await asyncio.sleep(0)
        await asyncio.sleep(1 / BATCHES_PER_S / 2)


async def _watched(supervisor: Supervisor, load: Iterator[Readings]) -> dict[str, float]:
    periods: list[float] = []
    supervisor.publisher.on_tick.append(periods.append)
    gc.collect()
    begin, spent = time.perf_counter(), time.process_time()
    await _fed(supervisor, load, SECONDS)
    cpu = (time.process_time() - spent) / (time.perf_counter() - begin)
    supervisor.publisher.on_tick.remove(periods.append)
    errors = [abs(1_000 * period - PERIOD_MS) for period in periods]
    return {
        "cpu_percent": round(100 * cpu, 1),
        "tick_p50_ms": round(quantile(errors, 0.5), 2),
        "tick_p99_ms": round(quantile(errors, 0.99), 2),
        "ticks": len(periods),
    }
