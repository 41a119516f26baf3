"""Whatever readings come, and however often the service ends: each tier agrees with all of them."""

import os
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby
from math import fsum
from pathlib import Path

import hypothesis.strategies as st
from hypothesis import event, given, settings

from domain.timebase import Duration, Instant, seconds
from service.storage.trends.history import trend_of
from service.storage.trends.known_signals import KnownSignals
from service.storage.trends.recorder import Recorder
from service.storage.trends.rows import NO_ERROR, Rows
from service.storage.trends.tiers import MILLISECOND, Tier
from tests.support.trend_readings import SMALL_TIERS, START, load, readings

SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
ERRORS = (None, "LOAD_HEAVY", "LOAD_OVERLOAD")
SIGNALS = ("load", "speed")


@dataclass(frozen=True, slots=True)
class _Reading:
    signal: str
    after: Duration
    value: float
    error: int
    """Place in `ERRORS`."""


@dataclass(frozen=True, slots=True)
class _Pause:
    elapsed: Duration
    """The readings are written after this time."""
    restart: bool
    clock_step: Duration
    """Of the clock at the restart."""


_values = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 1e308, -1e308]),
    st.floats(allow_nan=False, allow_infinity=False),
)
_readings = st.builds(
    _Reading,
    st.sampled_from(SIGNALS),
    st.one_of(st.integers(0, seconds(0.2)), st.integers(0, seconds(40.0))),
    _values,
    st.integers(0, 2),
)
_pauses = st.builds(
    _Pause,
    st.integers(0, seconds(30.0)),
    st.booleans(),
    st.integers(-seconds(100.0), seconds(100.0)),
)
_stories = st.lists(st.one_of(_readings, _readings, _readings, _pauses), max_size=120)
_Noted = tuple[Instant, float, int]


class _Story:
    """Gives readings to the recorder, and remembers them."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.noted: dict[str, list[_Noted]] = {name: [] for name in SIGNALS}
        self._at = START
        self._elapsed: Duration = 0
        self._start()

    def _start(self) -> None:
        self.known = KnownSignals(map(load, SIGNALS))
        self.recorder = Recorder(self.known, self.path, SMALL_TIERS)
        self._elapsed = 0

    def read(self, reading: _Reading) -> None:
        self._at += reading.after
        self.noted[reading.signal].append((self._at, reading.value, reading.error))
        known = self.known.by_name[reading.signal]
        error = ERRORS[reading.error]
        name = error and error.replace("LOAD_", f"{reading.signal.upper()}_")
        self.recorder.add(
            {known.number: readings([reading.value], self._at, errors=[known.rank_of(name)])},
            self._elapsed,
        )

    def pause(self, pause: _Pause) -> None:
        self._elapsed += pause.elapsed
        self.recorder.settle(self._elapsed)
        if pause.restart:
            # As by `kill -9`: only what was written is there.
            event("restart")
            self._at += pause.clock_step
            self._start()

    def rows(self, tier: int, signal: str) -> Rows:
        return self.recorder.rows(tier, self.known.by_name[signal], -(2**62), 2**62)


@settings(max_examples=500 if SOAK else 60)
@given(_stories, st.integers(2, 50))
def test_no_tier_loses_a_reading(story: list[_Reading | _Pause], points: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        told = _Story(str(Path(folder) / "trends.db"))
        for step in story:
            if isinstance(step, _Reading):
                told.read(step)
            else:
                told.pause(step)
        told.pause(_Pause(0, restart=False, clock_step=0))
        for signal in SIGNALS:
            for index, tier in enumerate(SMALL_TIERS):
                rows = told.rows(index, signal)
                _agrees(rows, told.noted[signal], tier)
                _chart_agrees(told, rows, signal, tier, points)
        told.recorder.close(0)


def _agrees(rows: Rows, noted: list[_Noted], tier: Tier) -> None:
    """Compare the rows of a tier, merged to its buckets, with all readings."""
    width = tier.width or 1_000
    merged = rows.in_buckets(width)
    expected = dict(_buckets(noted, width))
    buckets = [at // width for at in merged.first]
    assert buckets == sorted(expected)
    for place, bucket in enumerate(buckets):
        values = [value for _, value, _ in expected[bucket]]
        low, high = min(values), max(values)
        assert (merged.low[place], merged.high[place]) == (low, high)
        assert merged.count[place] == len(values)
        assert merged.final[place] in _latest(expected[bucket])
        assert max(merged.error[place], -1) == max(rank for _, _, rank in expected[bucket]) - 1
        assert (merged.error[place] == NO_ERROR) is (merged.error[place] < 0)
        mean = fsum(value / len(values) for value in values)
        # By packing, up to a 65,535th in each tier.
        assert (
            abs(merged.mean[place] / 2 - mean / 2) <= (high / 2 - low / 2) * 1e-4 + abs(mean) / 1e9
        )


def _chart_agrees(told: _Story, rows: Rows, signal: str, tier: Tier, points: int) -> None:
    """Compare a chart of all time with all readings."""
    noted = told.noted[signal]
    begin = min((at for at, _, _ in noted), default=START)
    end = max((at for at, _, _ in noted), default=START) + 1
    chart = trend_of(rows, told.known.by_name[signal], tier, begin, end, points).points
    assert len(chart) <= points
    assert bool(chart) is bool(noted)
    if noted:
        assert min(float(point.low) for point in chart) == min(value for _, value, _ in noted)
        assert max(float(point.high) for point in chart) == max(value for _, value, _ in noted)
        assert any(point.error for point in chart) is any(rank for _, _, rank in noted)
        assert [point.at for point in chart] == sorted(point.at for point in chart)


def _latest(noted: list[_Noted]) -> set[float]:
    """Return the values of the last millisecond; runs whose clocks differ may overlap there."""
    end = max(at for at, _, _ in noted) // MILLISECOND
    return {value for at, value, _ in noted if at // MILLISECOND == end}


def _buckets(noted: list[_Noted], width: Duration) -> Iterable[tuple[int, list[_Noted]]]:
    """Return the readings of each bucket, in the order of arrival."""
    ordered = sorted(noted, key=lambda reading: reading[0] // width)
    return ((key, [*group]) for key, group in groupby(ordered, lambda one: one[0] // width))
