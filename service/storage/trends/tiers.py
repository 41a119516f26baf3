"""The tiers in which signals are kept: how fine, how long, and which one answers a question."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from domain.timebase import Duration, Instant, seconds

MILLISECOND: Duration = seconds(0.001)

_MINUTE, _HOUR, _DAY = 60.0, 3_600.0, 86_400.0
_MIB = 1024 * 1024

_ROWS = 16_000
_ROWS_PER_POINT = 16
"""A chart is merged from at most so many rows, or so many per point: a finer tier would take longer
to read, and could not be seen."""

_RAW_PER_S = 16
"""Single readings are read for a chart as if there were so many in a second."""


@dataclass(frozen=True, slots=True)
class Tier:
    """One resolution."""

    width: Duration
    """Of a bucket; 0: single readings."""
    block: Duration
    """Running time after which the rows that have gathered are packed and written; 0: as soon as
    the thread gets them."""
    keep_for: Duration
    """Recorded running time after which a block is deleted."""
    keep_bytes: int
    """Size from which the oldest blocks are deleted earlier."""

    @property
    def name(self) -> str:
        """Return its name in the file."""
        return f"tier_{self.width // MILLISECOND}_ms" if self.width else "tier_raw"

    @property
    def unit(self) -> Duration:
        """Return the resolution of times in its blocks."""
        return MILLISECOND if self.width else MILLISECOND // 1_000


TIERS = (
    Tier(0, 0, seconds(10 * _MINUTE), 32 * _MIB),
    Tier(seconds(1.0), seconds(_MINUTE), seconds(4 * _HOUR), 96 * _MIB),
    Tier(seconds(10.0), seconds(10 * _MINUTE), seconds(2 * _DAY), 112 * _MIB),
    Tier(seconds(_MINUTE), seconds(_HOUR), seconds(14 * _DAY), 128 * _MIB),
    Tier(seconds(10 * _MINUTE), seconds(10 * _HOUR), seconds(400 * _DAY), 352 * _MIB),
)
"""200 signals at 20 Hz fill each tier almost up to its size; see docs/benchmarks.md."""

MEMORY_TIERS = tuple(replace(tier, keep_bytes=tier.keep_bytes // 32) for tier in TIERS)
"""For a history that is only in memory: at most 23 MB."""


def pick_tier(
    tiers: Sequence[Tier],
    oldest: Sequence[Instant | None],
    from_at: Instant,
    to_at: Instant,
    points: int,
) -> int:
    """Return the index of the finest tier that can be read quickly and reaches back to `from_at`.

    Args:
        tiers: From fine to coarse.
        oldest: By tier, the time of the oldest row of the signal; None: there is none.
        from_at: Begin of the chart.
        to_at: End of the chart.
        points: Most points of the chart.
    """
    quick = [index for index, tier in enumerate(tiers) if _is_quick(tier, to_at - from_at, points)]
    quick = quick or [len(tiers) - 1]
    reached = [at for at in oldest if at is not None]
    if not reached:
        return quick[0]
    start = max(from_at, min(reached))
    for index in quick:
        at = oldest[index]
        # The times of coarse tiers are rounded down to milliseconds.
        if at is not None and at <= start + MILLISECOND:
            return index
    return min(quick, key=lambda index: (oldest[index] is None, oldest[index] or 0))


def _is_quick(tier: Tier, span: Duration, points: int) -> bool:
    rows = span // tier.width if tier.width else span * _RAW_PER_S // seconds(1.0)
    return rows <= max(_ROWS, _ROWS_PER_POINT * points)
