"""What a reading costs in a window, by how many readings the window holds."""

import gc
import random
import time
from collections.abc import Sequence

import pytest

from domain.timebase import Duration, seconds
from domain.windows.settings import MAX_RANKED, Statistic, WindowSettings
from domain.windows.window import Window
from tests.support.bench import report
from tests.support.windows import START, below

SIZES = (10, 100, 1_000, 10_000, 100_000)
RANKED = (10, 100, 1_000, 10_000, MAX_RANKED)
PERIOD: Duration = seconds(0.01)
ROUNDS = 40
READINGS = 250
MOST_RATIO = 1.5


@pytest.mark.bench
def test_a_reading_costs_the_same_however_many_readings_the_window_holds() -> None:
    rng = random.Random(1)
    values = [round(24.0 + rng.gauss(0.0, 0.5), 3) for _ in range(997)]
    rows = {str(statistic): _measure(statistic, values) for statistic in Statistic}
    report(
        "windows",
        "Windows",
        "A reading arrives, the oldest leaves, and the value is asked for; the same with windows "
        f"of {SIZES[0]} to {SIZES[-1]:,} readings of 100 per second, percentiles up to "
        f"{MAX_RANKED:,}. The best of {ROUNDS} rounds of {READINGS} readings, in which the sizes "
        "take turns.",
        rows,
        asked=f"a ratio of at most {MOST_RATIO} between the largest window and the smallest; for a "
        "percentile, the logarithm.",
    )
    for statistic, row in rows.items():
        assert statistic == Statistic.PERCENTILE or row["ratio"] <= MOST_RATIO, statistic


def _measure(statistic: Statistic, values: Sequence[float]) -> dict[str, float]:
    """Return microseconds per reading by number of readings, and the ratio of both ends."""
    sizes = RANKED if statistic is Statistic.PERCENTILE else SIZES
    windows = [_full(statistic, size, values) for size in sizes]
    best = [float("inf")] * len(sizes)
    gc.collect()
    gc.disable()
    for at_round in range(ROUNDS):
        for place, (window, filled) in enumerate(zip(windows, sizes, strict=True)):
            took = _run(window, filled + at_round * READINGS, values)
            best[place] = min(best[place], took)
    gc.enable()
    row = {
        f"of_{size:,}_us": round(took * 1e6 / READINGS, 2)
        for size, took in zip(sizes, best, strict=True)
    }
    return row | {"ratio": round(best[-1] / best[0], 2)}


def _full(statistic: Statistic, size: int, values: Sequence[float]) -> Window:
    settings = WindowSettings(
        statistic=statistic,
        length=size * PERIOD,
        q=95.0 if statistic is Statistic.PERCENTILE else None,
        limit=below(0.0) if statistic is Statistic.TIME_TO_LIMIT else None,
    )
    window = Window(settings, START)
    for number in range(size):
        window.add(START + number * PERIOD, values[number % len(values)])
    return window


def _run(window: Window, first: int, values: Sequence[float]) -> float:
    readings = [
        (START + number * PERIOD, values[number % len(values)])
        for number in range(first, first + READINGS)
    ]
    begin = time.perf_counter()
    for at, value in readings:
        window.add(at, value)
        window.value(at)
    return time.perf_counter() - begin
