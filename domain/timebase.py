"""Time as the core sees it: whole nanoseconds of a monotonic clock that somebody else reads.

Integers, because the core promises the same outputs for the same inputs: "15 s after the last good
reading" is then exact, at every time of day, and never a rounding error early or late.
"""

from typing import TypeAlias

Instant: TypeAlias = int
"""Nanoseconds of a monotonic clock; only differences mean anything."""

Duration: TypeAlias = int
"""Nanoseconds."""

NANOSECONDS_PER_SECOND = 1_000_000_000


def seconds(value: float) -> Duration:
    """Return `value` seconds as a duration, rounded to the nearest nanosecond."""
    return round(value * NANOSECONDS_PER_SECOND)


def to_seconds(value: Duration) -> float:
    """Return a duration in seconds."""
    return value / NANOSECONDS_PER_SECOND
