"""Robots with hundreds of signals and monitors, and what is read of them."""

import random
from collections.abc import Iterator
from dataclasses import replace

from domain.health.signals import (
    Bound,
    Comparison,
    MonitorSettings,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.inputs import Reading, Readings
from domain.timebase import seconds
from domain.windows.settings import Statistic, WindowSettings

WINDOW = seconds(5)
_STATISTICS = (Statistic.MEAN, Statistic.MAX, Statistic.RATE, Statistic.GAP, Statistic.STD)


def many_signals(
    count: int, monitors: int = 0, *, mixed: bool = False
) -> tuple[SignalSettings, ...]:
    """Return the usual signals and further ones, each with an error, and monitors of them.

    Args:
        count: Of the signals.
        monitors: How many there are of the first 200 of the further signals, in turn.
        mixed: All monitors of a signal have different statistics, instead of the same.
    """
    usual = (replace(item, stale_after=0) for item in default_signals())
    further = (_signal(f"signal_{number}") for number in range(count - len(default_signals())))
    computed = (
        _monitor(number, f"signal_{number % 200}", number + mixed * (number // 200))
        for number in range(monitors)
    )
    return (*usual, *further, *computed)


def batches(first: int, count: int, size: int, rng: random.Random) -> Iterator[Readings]:
    """Yield messages of good readings, each of the next signals of `first`."""
    at = 0
    for _ in range(count):
        names = [f"signal_{(at + step) % first}" for step in range(size)]
        at += size
        yield Readings(tuple(Reading(name, rng.random()) for name in names), "bench")


def _signal(name: str, **settings: MonitorSettings | int) -> SignalSettings:
    bound = Bound(f"{name.upper()}_HIGH", Comparison.ABOVE, 10.0)
    made = SignalSettings(SignalSpec(name, SignalKind.NUMBER), (bound,))
    return replace(made, **settings)  # type: ignore[arg-type]  # as the caller says


def _monitor(number: int, of: str, turn: int) -> SignalSettings:
    statistic = _STATISTICS[turn % len(_STATISTICS)]
    monitor = MonitorSettings(of, WindowSettings(statistic=statistic, length=WINDOW))
    made = _signal(f"monitor_{number}", monitor=monitor, stale_after=0)
    if statistic is Statistic.RATE:
        return replace(made, bounds=(replace(made.bounds[0], comparison=Comparison.BELOW),))
    return made
