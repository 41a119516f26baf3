"""Whatever readings arrive: each statistic equals numpy on the same window.

`make soak` plays 10,000 streams, `make test` 300. They have jitter, gaps, readings at one instant
and repeated values; in some the values lie near 1e6 with a spread of 1.
"""

import os
import pickle
import random
from collections.abc import Callable, Iterator, Mapping

import numpy as np
import numpy.typing as npt
import pytest

from domain.timebase import Duration, Instant, seconds, to_seconds
from domain.windows.settings import Statistic, Threshold, WindowSettings
from domain.windows.window import Window
from tests.support.windows import START, below

STREAMS = 10_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 300
WITHIN = 1e-9
"""Of the largest magnitude in the window."""
ARRIVALS = (Statistic.COUNT, Statistic.RATE, Statistic.GAP, Statistic.AGE)
OF_NUMPY: Mapping[Statistic, Callable[[npt.NDArray[np.float64]], float]] = {
    Statistic.MEAN: np.mean,
    Statistic.MIN: np.min,
    Statistic.MAX: np.max,
    Statistic.STD: np.std,
    Statistic.RANGE: np.ptp,
}
Reading = tuple[Instant, float]


def _stream(rng: random.Random) -> Iterator[Reading]:
    """Yield readings as a robot delivers them on a bad day."""
    middle = rng.choice([0.0, 1.0, 1e6, 1e6, -1e6, 1e-3, 1e12])
    spread, period = rng.choice([1e-3, 1.0, 1.0, 100.0]), rng.choice([0.01, 0.05, 0.3])
    at, value = START, middle
    for _ in range(rng.choice([3, 30, 80])):
        luck = rng.random()
        if luck < 0.03:
            at += seconds(rng.uniform(1.0, 8.0))
        elif luck < 0.9:
            at += seconds(max(0.0, rng.gauss(period, period / 3)))
        if rng.random() > 0.1:
            value = middle + rng.gauss(0.0, spread)
        yield at, value


def _settings(rng: random.Random, statistic: Statistic) -> WindowSettings:
    of_a_time = rng.random() < 0.7
    return WindowSettings(
        statistic=statistic,
        length=seconds(rng.choice([0.1, 0.5, 2.0])) if of_a_time else None,
        size=None if of_a_time else rng.choice([2, 5, 20]),
        q=rng.choice([0.0, 50.0, 95.0, 100.0, rng.uniform(0.0, 100.0)])
        if statistic is Statistic.PERCENTILE
        else None,
        limit=below(0.0) if statistic is Statistic.TIME_TO_LIMIT else None,
    )


def _held(readings: list[Reading], settings: WindowSettings, now: Instant) -> list[Reading]:
    if settings.length is None:
        return readings[-(settings.size or 0) :]
    return [reading for reading in readings if now - settings.length < reading[0] <= now]


def _expected(readings: list[Reading], settings: WindowSettings, now: Instant) -> float | None:
    """Return what numpy makes of a window; None: it is unknown."""
    held = _held(readings, settings, now)
    if settings.statistic in ARRIVALS:
        return _of_arrivals([at for at, _ in held], readings, settings, now)
    if len(held) < settings.min_n:
        return None
    values = np.array([value for _, value in held])
    match settings.statistic:
        case Statistic.PERCENTILE:
            return float(np.percentile(values, settings.q or 0.0))
        case Statistic.SLOPE:
            return _slope(np.array([at for at, _ in held]), values)
        case Statistic.STUCK_FOR:
            every = [value for _, value in readings]
            changed = max(i for i in range(len(every)) if i == 0 or every[i] != every[i - 1])
            return to_seconds(now - readings[changed][0])
    return float(OF_NUMPY[settings.statistic](values))


def _of_arrivals(
    times: list[Instant], readings: list[Reading], settings: WindowSettings, now: Instant
) -> float | None:
    heard_at = readings[-1][0] if readings else START
    if settings.length is None and len(times) < (settings.size or 0):
        return None
    if settings.length is not None and now < START + settings.length:
        return None
    match settings.statistic:
        case Statistic.COUNT:
            return len(times)
        case Statistic.RATE if settings.length is not None:
            return len(times) / to_seconds(settings.length)
        case Statistic.RATE:
            elapsed: Duration = now - times[0]
            return (len(times) - 1) / to_seconds(elapsed) if elapsed else None
        case Statistic.GAP:
            return to_seconds(max(now - heard_at, int(np.max(np.diff(times), initial=0))))
    return to_seconds(now - heard_at)


def _slope(times: npt.NDArray[np.int64], values: npt.NDArray[np.float64]) -> float | None:
    if times[0] == times[-1]:
        return None
    # Differences first: no digit of either is lost to their mean.
    since = (times - times[0]) / 1e9
    since -= since.mean()
    offsets = values - values[0]
    return float(since @ (offsets - offsets.mean()) / (since @ since))


@pytest.mark.parametrize("part", range(10))
def test_each_statistic_equals_numpy(part: int) -> None:
    for seed in range(part, STREAMS, 10):
        rng = random.Random(seed)
        statistics = [each for each in Statistic if each is not Statistic.TIME_TO_LIMIT]
        windows = [Window(_settings(rng, statistic), START) for statistic in statistics]
        readings: list[Reading] = []
        for at, value in _stream(rng):
            now = at if rng.random() < 0.5 else (readings[-1][0] if readings else START)
            now = rng.randint(now, at)
            for window in windows if rng.random() < 0.3 else ():
                _check(window, readings, now, seed)
            readings.append((at, value))
            for window in windows:
                window.add(at, value)
        for window in windows:
            _check(window, readings, now=readings[-1][0], seed=seed)


def _check(window: Window, readings: list[Reading], now: Instant, seed: int) -> None:
    settings = window.settings
    expected = _expected(readings, settings, now)
    value = window.value(now)
    largest = max((abs(number) for _, number in _held(readings, settings, now)), default=0.0)
    # Seconds and readings per second have a magnitude of their own.
    scale = max(largest, abs(expected or 0.0))
    story = f"stream {seed}, {settings}, at {now}: {value}, not {expected}"
    assert (value is None) is (expected is None), story
    if value is not None and expected is not None:
        assert abs(value - expected) <= WITHIN * scale, story


@pytest.mark.parametrize("part", range(10))
def test_no_threshold_is_crossed_before_the_instant_that_was_told(part: int) -> None:
    for seed in range(part, STREAMS, 10):
        rng = random.Random(seed)
        window = Window(_settings(rng, rng.choice(list(Statistic))), START)
        now = START
        for at, value in _stream(rng):
            now = at
            window.add(at, value)
        _watch(window, now + rng.choice([0, seconds(rng.uniform(0.0, 1.0))]), rng, seed)


def _watch(window: Window, now: Instant, rng: random.Random, seed: int) -> None:
    """Look at a window now and then, and compare with when it said that it may change."""
    value = window.value(now)
    near = rng.choice([0.0, 1.0, 2.0]) if value is None else value * rng.choice([0.5, 1.0, 1.5, 3])
    threshold = Threshold(near, rng.random() < 0.5)
    changes_at, crosses_at = window.changes_at(now), window.crosses_at(threshold, now)
    assert crosses_at is None or crosses_at > now
    story = f"stream {seed}, {window.settings}, {threshold}, at {now}, crosses at {crosses_at}"
    for then in sorted(_instants(now, changes_at, crosses_at, rng)):
        if changes_at is None or then < changes_at:
            assert _at(window, then) == value, f"{story}: changed at {then}"
        if crosses_at is None or then < crosses_at:
            assert _side(threshold, _at(window, then)) == _side(threshold, value), story


def _instants(
    now: Instant, changes_at: Instant | None, crosses_at: Instant | None, rng: random.Random
) -> Iterator[Instant]:
    for at in (changes_at, crosses_at):
        if at is not None and at > now:
            yield from (at - 1, rng.randint(now, at - 1))
    yield now + seconds(rng.uniform(0.0, 10.0))


def _at(window: Window, then: Instant) -> float | None:
    copy: Window = pickle.loads(pickle.dumps(window))
    return copy.value(then)


def _side(threshold: Threshold, value: float | None) -> bool | None:
    return None if value is None else threshold.is_passed_by(value)
