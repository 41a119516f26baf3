"""Signals and readings for tests of their history."""

from array import array
from collections.abc import Iterable

from domain.health.signals import Bound, Comparison, SignalKind, SignalSettings, SignalSpec
from domain.timebase import Duration, Instant, seconds
from service.storage.trends.rows import NO_ERROR, RANKS, TIMES, VALUES, Rows
from service.storage.trends.tiers import Tier

START: Instant = 1_767_225_600_000_000_000
"""2026-01-01T00:00:00Z."""

SMALL_TIERS = (
    Tier(0, 0, seconds(1e9), 10**9),
    Tier(seconds(1.0), seconds(3.0), seconds(1e9), 10**9),
    Tier(seconds(10.0), seconds(20.0), seconds(1e9), 10**9),
    Tier(seconds(60.0), seconds(120.0), seconds(1e9), 10**9),
)
"""Whose blocks are soon full."""


def load(name: str = "load", unit: str = "kg") -> SignalSettings:
    """Return a number with two errors: OVERLOAD is worse than HEAVY."""
    spec = SignalSpec(name, SignalKind.NUMBER, unit)
    above = Comparison.ABOVE
    bounds = (
        Bound(f"{name.upper()}_OVERLOAD", above, 1500.0, key="overload"),
        Bound(f"{name.upper()}_HEAVY", above, 1000.0, key="heavy"),
    )
    return SignalSettings(spec, bounds)


def readings(
    values: Iterable[float],
    start: Instant = START,
    every: Duration = seconds(0.05),
    errors: Iterable[int] | None = None,
) -> Rows:
    """Return readings of one signal at equal distances."""
    value = array(VALUES, values)
    at = array(TIMES, [start + every * number for number in range(len(value))])
    ranks = [NO_ERROR] * len(value) if errors is None else errors
    return Rows.of_readings(at, value, array(RANKS, ranks))
