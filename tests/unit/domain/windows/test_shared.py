"""Windows over the same readings."""

import random

from domain.timebase import seconds
from domain.windows.settings import Statistic, WindowSettings
from domain.windows.shared import SharedWindows
from domain.windows.window import Window
from tests.support.windows import START, above


def settings(statistic: Statistic, length_s: float | None, min_n: int = 2) -> WindowSettings:
    return WindowSettings(
        statistic=statistic,
        length=None if length_s is None else seconds(length_s),
        size=7 if length_s is None else None,
        min_n=min_n,
        q=40.0 if statistic is Statistic.PERCENTILE else None,
        limit=above(1.0) if statistic is Statistic.TIME_TO_LIMIT else None,
    )


def test_equal_windows_are_one() -> None:
    windows = SharedWindows(START)
    mean = windows.window(settings(Statistic.MEAN, 5.0))

    assert windows.window(settings(Statistic.MEAN, 5.0)) is mean
    assert windows.window(settings(Statistic.MEAN, 5.0, min_n=3)) is not mean


def test_a_window_says_what_it_says_alone() -> None:
    rng = random.Random(3)
    shared = SharedWindows(START)
    alone = [
        Window(settings(statistic, length_s, min_n), START)
        for statistic in Statistic
        for length_s in (None, 0.3, 1.0)
        for min_n in (2, 4)
    ]
    among = [shared.window(window.settings) for window in alone]
    now = START
    for _ in range(600):
        now += seconds(rng.choice([0.0, 0.001, 0.05, 0.05, 0.05, 0.8]))
        value = rng.gauss(0.0, 1.0)
        shared.add(now, value)
        for window in alone:
            window.add(now, value)
        for one, other in zip(alone, among, strict=True):
            if rng.random() < 0.1:
                then = now + rng.choice([0, seconds(0.01)])
                assert one.value(now) == other.value(now)
                assert one.crosses_at(above(0.5), now) == other.crosses_at(above(0.5), now)
                assert one.changes_at(now) == other.changes_at(now)
                assert one.filled(then) == other.filled(then)
