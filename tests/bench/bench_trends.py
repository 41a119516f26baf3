"""What the history of signals costs: on the event loop, on the disk, and for a chart."""

import os
import time
from array import array
from collections.abc import Callable, Iterator
from pathlib import Path

import apsw
import numpy as np
import pytest
from numpy.typing import NDArray

from domain.health.signals import SignalKind, SignalSettings, SignalSpec
from domain.snapshot import SignalView
from domain.timebase import NANOSECONDS_PER_SECOND, Instant, seconds
from service.storage.trends.block_file import BlockFile
from service.storage.trends.known_signals import KnownSignals
from service.storage.trends.recorder import Recorder
from service.storage.trends.rows import (
    NO_ERROR,
    RANKS,
    TIMES,
    VALUES,
    Rows,
    RowsBySignal,
    row_count,
)
from service.storage.trends.sampling import Sampling
from service.storage.trends.tiers import TIERS
from service.storage.trends.trends import HAND_OVER, Trends
from tests.support.bench import quantile, report
from tests.support.trend_readings import START

pytestmark = pytest.mark.bench

SIGNALS = 200
RATE_HZ = 20
DAY_S = int(os.environ.get("PILOTHOUSE_BENCH_DAY_S", "86400"))
CHARTS = 50
ROUNDS = 100
SPIKES = 500
MB = 1_000_000
PACE_S = HAND_OVER // NANOSECONDS_PER_SECOND


def _signals() -> list[SignalSettings]:
    return [
        SignalSettings(SignalSpec(f"signal_{number}", SignalKind.NUMBER))
        for number in range(SIGNALS)
    ]


class _Readings:
    """Five seconds of all signals at a time, as the thread gets them."""

    def __init__(self) -> None:
        self._random = np.random.default_rng(7)
        self._level = self._random.uniform(-100.0, 100.0, SIGNALS)
        self.spikes = {
            (int(signal), int(second)): 1_000.0 + place
            for place, (signal, second) in enumerate(
                zip(
                    self._random.integers(0, SIGNALS, SPIKES),
                    self._random.integers(0, DAY_S, SPIKES),
                    strict=True,
                )
            )
        }
        """Values of single readings, by signal and second."""

    def pieces(self) -> Iterator[tuple[int, RowsBySignal]]:
        """Yield each piece with the second at which it begins."""
        turns = PACE_S * RATE_HZ
        turn = np.repeat(np.arange(turns), SIGNALS) * (NANOSECONDS_PER_SECOND // RATE_HZ)
        by_piece: dict[int, list[tuple[int, int, float]]] = {}
        for (signal, second), value in self.spikes.items():
            by_piece.setdefault(second // PACE_S, []).append((signal, second % PACE_S, value))
        for piece in range(DAY_S // PACE_S):
            # Of full precision, so that hardly a bit can be compressed.
            self._level += self._random.normal(0.0, 0.1, SIGNALS)
            levels = np.tile(self._level, turns)
            values = levels + self._random.standard_normal(len(turn))
            for signal, second, spike in by_piece.get(piece, ()):
                values[second * RATE_HZ * SIGNALS + signal] = spike
            late = self._random.integers(0, 1_000_000, turns).repeat(SIGNALS)
            at = START + piece * HAND_OVER + turn + late
            yield piece * PACE_S, {number: _rows(number, at, values) for number in range(SIGNALS)}


def _rows(number: int, at: NDArray[np.int64], values: NDArray[np.float64]) -> Rows:
    """Return those of one signal of readings in which the signals take turns."""
    own = slice(number, None, SIGNALS)
    return Rows.of_readings(
        array(TIMES, at[own].tobytes()),
        array(VALUES, values[own].tobytes()),
        array(RANKS, [NO_ERROR]) * (len(at) // SIGNALS),
    )


def test_a_day_of_two_hundred_signals(tmp_path: Path) -> None:
    path = tmp_path / "trends.db"
    known = KnownSignals(_signals())
    recorder = Recorder(known, str(path), TIERS)
    made, readings, spent = _Readings(), 0, []
    for second, rows in made.pieces():
        start = time.perf_counter()
        recorder.add(rows, seconds(second))
        recorder.settle(seconds(second + PACE_S))
        spent.append(time.perf_counter() - start)
        readings += row_count(rows)
    recorder.close(seconds(DAY_S))
    size = sum(entry.stat().st_size for entry in tmp_path.iterdir())
    start = time.perf_counter()
    again = Recorder(known, str(path), TIERS)
    again.settle(0)
    opened = time.perf_counter() - start
    end = START + seconds(DAY_S)
    day, year = (
        _charts(again, known, end - seconds(span), end) for span in (DAY_S, 366 * 86_400.0)
    )
    missing = _missing(again, known, made.spikes, end)
    again.close(0)
    report(
        "trends",
        "A day of 200 signals at 20 Hz",
        "Readings of full precision, made by numpy in virtual time and given to the thread's"
        f" part of the history as it gets them, {PACE_S} s at a time; then charts of 1,000 points"
        " of different signals from the file, opened anew. What the event loop does for a reading"
        " is measured below.",
        {
            "one day": {
                "readings": readings,
                "size_mb": round(size / MB, 1),
                "thread_us_per_reading": round(1e6 * sum(spent) / readings, 3),
                "slowest_5_s_piece_ms": round(1_000 * max(spent), 1),
                "opening_ms": round(1_000 * opened, 1),
                "spikes": SPIKES,
                "spikes_missing": missing,
            },
            "chart of a day": day,
            "chart of a year": year,
        },
        asked="less than 300 MB, a chart of a day in less than 200 ms, no spike lost.",
        notes=_year(path),
    )
    assert missing == 0
    assert size < 300 * MB
    assert day["max_ms"] < 200


def test_what_a_reading_costs_on_the_event_loop() -> None:
    trends = Trends(_signals())
    values = np.random.default_rng(1).standard_normal(100_003).tolist()
    names = [f"signal_{number}" for number in range(SIGNALS)]
    views = [_view(name, value) for name, value in zip(names * 10, values, strict=False)]
    at = iter(range(START, START + 10**15, 250_000))

    def noting() -> None:
        for name, value in zip(names * 10, values, strict=False):
            trends.note(name, next(at), value, None)

    current: dict[str, SignalView] = {}
    # A new one, since the first one has no room left for so many.
    sampling = Sampling(Trends(_signals()), current.__getitem__)

    def sampled() -> None:
        for view in views:
            current[view.signal] = view
            sampling.note((view.signal,), START)

    rows = {
        label: {"us": round(min(_seconds(work) for _ in range(ROUNDS)) / len(views) * 1e6, 2)}
        for label, work in (("noting a value", noting), ("from a changed view", sampled))
    }
    report(
        "trends_loop",
        "The history of signals on the event loop",
        f"CPU time for one reading, the best of {ROUNDS} rounds of 2,000.",
        rows,
        asked="2 to 3 us for a reading.",
    )
    assert rows["from a changed view"]["us"] < 3


def _charts(
    recorder: Recorder, known: KnownSignals, begin: Instant, end: Instant
) -> dict[str, float]:
    times, points = [], 0
    for number in range(CHARTS):
        start = time.perf_counter()
        trend = recorder.trend(known[number * SIGNALS // CHARTS], begin, end, 1_000)
        times.append(time.perf_counter() - start)
        points = len(trend.points)
    return {
        "points": points,
        "p50_ms": round(1_000 * quantile(times, 0.5), 1),
        "max_ms": round(1_000 * max(times), 1),
    }


def _missing(
    recorder: Recorder, known: KnownSignals, spikes: dict[tuple[int, int], float], end: Instant
) -> int:
    """Return how many spikes are not in a chart of ten minutes around them."""
    missing = 0
    for (signal, second), value in spikes.items():
        at = START + seconds(second)
        trend = recorder.trend(
            known[signal], at - seconds(300.0), min(at + seconds(300.0), end), 1_000
        )
        missing += not any(point.high == value for point in trend.points)
    return missing


def _year(path: Path) -> list[str]:
    """Return what a year takes, by the bytes that a row took here."""

    lines, total = [], 0.0
    for tier, per_row in zip(TIERS, _bytes_per_row(path), strict=True):
        kept = min(tier.keep_for / NANOSECONDS_PER_SECOND, 365 * 86_400)
        per_second = RATE_HZ if not tier.width else NANOSECONDS_PER_SECOND / tier.width
        size = min(SIGNALS * kept * per_second * per_row, tier.keep_bytes)
        total += size
        lines.append(
            f"{tier.name}: {SIGNALS} signals * {kept:,.0f} s * {per_second:g} rows/s"
            f" * {per_row:.1f} bytes = {size / MB:.0f} MB (at most {tier.keep_bytes / MB:.0f} MB)."
        )

    # Blocks do not fill the pages of the file.
    share = _bytes_of_blocks(path) / path.stat().st_size
    return [
        *lines,
        f"A year, by calculation: one file of {total / share / MB:.0f} MB, of which blocks take"
        f" {100 * share:.0f} %, and its WAL of 5 MB.",
    ]


def _bytes_of_blocks(path: Path) -> int:
    file = BlockFile(str(path), TIERS)
    size = file.size
    file.close()
    return size


def _seconds(work: Callable[[], None]) -> float:
    """Return the time of this thread alone, whatever else the machine does."""
    start = time.thread_time()
    work()
    return time.thread_time() - start


def _view(name: str, value: float) -> SignalView:
    return SignalView(
        signal=name,
        value=value,
        unit="",
        source="bench",
        received_at=START,
        stamp=None,
        stale=False,
        error=None,
        pending_error=None,
        pending_since=None,
        pending_needs=None,
        skewed=False,
        needs_acknowledgement=False,
        settings={},
    )


def _bytes_per_row(path: Path) -> list[float]:
    """Return by tier what a row takes, with its share of the block's; 0: there was none."""
    connection = apsw.Connection(str(path))
    found = [
        next(iter(connection.execute(f"SELECT sum(bytes) * 1.0 / sum(rows) FROM {tier.name}")))[0]
        for tier in TIERS
    ]
    connection.close()
    return [size or 0.0 for size in found]
