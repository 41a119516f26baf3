"""Time in the core: integer nanoseconds of a monotonic clock that the caller reads.

Integers, so that the same inputs give the same outputs: "15 s after the last good reading" is
exact at every time of day, without rounding errors.
"""

from typing import TypeAlias

Instant: TypeAlias = int
"""Nanoseconds of a monotonic clock; only differences are meaningful."""

Duration: TypeAlias = int
"""Nanoseconds."""

NANOSECONDS_PER_SECOND = 1_000_000_000


def seconds(value: float) -> Duration:
    """Return `value` seconds as a duration, rounded to the nearest nanosecond."""
    return round(value * NANOSECONDS_PER_SECOND)


def to_seconds(value: Duration) -> float:
    """Return a duration in seconds."""
    return value / NANOSECONDS_PER_SECOND
