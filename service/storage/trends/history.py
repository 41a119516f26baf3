"""The history of a signal as the points of a chart."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import repeat

from domain.timebase import Duration, Instant
from service.storage.trends.known_signals import KnownSignal
from service.storage.trends.rows import Rows
from service.storage.trends.tiers import Tier


@dataclass(frozen=True, slots=True)
class TrendPoint:
    """What a signal was in one piece of time."""

    at: Instant
    """Time of its first reading."""
    low: float | str
    """The least value; of an enumeration, the best member."""
    high: float | str
    """The greatest value; of an enumeration, the worst member."""
    mean: float | None
    """Mean of all readings; None: it is an enumeration."""
    last: float | str
    error: str | None
    """The worst error in force at a reading."""


@dataclass(frozen=True, slots=True)
class Trend:
    """The points of a chart; there is none where there was no reading."""

    points: Sequence[TrendPoint]
    width: Duration
    """Of the buckets that they are made of; 0: of single readings."""


def trend_of(
    rows: Rows, signal: KnownSignal, tier: Tier, from_at: Instant, to_at: Instant, points: int
) -> Trend:
    """Return rows as points.

    Args:
        rows: Of one signal, in the order of arrival; a bucket may be in several of them.
        signal: That signal.
        tier: Whose rows they are.
        from_at: Begin of the chart; a bucket that begins earlier counts as a whole.
        to_at: End of the chart.
        points: Most points, at least 2.
    """
    rows = rows.overlapping(from_at - tier.unit + 1, to_at)
    rows = _merged(rows, tier.width, from_at) if tier.width else rows.in_order()
    if len(rows) > points:
        unit = tier.width or tier.unit
        # Bins begin at multiples of their width, so that a chart that moves on does not flicker;
        # so the first and the last one may be cut.
        rows = _merged(rows, -((from_at - to_at) // (unit * (points - 1))) * unit, from_at)
    return Trend([*_points(rows, signal, from_at)], tier.width)


def _merged(rows: Rows, width: Duration, from_at: Instant) -> Rows:
    return rows.merged([max(first, from_at) // width for first in rows.first])


def _points(rows: Rows, signal: KnownSignal, from_at: Instant) -> list[TrendPoint]:
    names = {rank: error for error, rank in signal.ranks.items()}
    errors = map(names.get, rows.error)
    low, high, last = (map(signal.value_of, codes) for codes in (rows.low, rows.high, rows.final))
    mean = repeat(None) if signal.codes else rows.mean
    at = [max(first, from_at) for first in rows.first]
    return [*map(TrendPoint, at, low, high, mean, last, errors)]
