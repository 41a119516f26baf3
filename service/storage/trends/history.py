"""The history of a signal as the points of a chart."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

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
    is_seen = (rows.last >= from_at - tier.unit + 1) & (rows.first <= to_at)
    rows = rows.taken(is_seen)
    rows = _merged(rows, tier.width, from_at) if tier.width else _in_order(rows)
    if len(rows) > points:
        unit = tier.width or tier.unit
        # Bins begin at multiples of their width, so that a chart that moves on does not flicker;
        # so the first and the last one may be cut.
        rows = _merged(rows, -((from_at - to_at) // (unit * (points - 1))) * unit, from_at)
    return Trend([*_points(rows, signal, from_at)], tier.width)


def _merged(rows: Rows, width: Duration, from_at: Instant) -> Rows:
    bucket = np.maximum(rows.first, from_at) // width
    order = np.lexsort((rows.last, bucket))
    return rows.taken(order).merged(bucket[order])


def _in_order(rows: Rows) -> Rows:
    return rows.taken(np.argsort(rows.first, kind="stable"))


def _points(rows: Rows, signal: KnownSignal, from_at: Instant) -> list[TrendPoint]:
    names = {rank: error for error, rank in signal.ranks.items()}
    errors = [names.get(rank) for rank in rows.error.tolist()]
    low, high, last = (column.tolist() for column in (rows.low, rows.high, rows.final))
    mean: Sequence[float | None] = rows.mean.tolist()
    if signal.codes:
        low, high, last = ([signal.value_of(code) for code in codes] for codes in (low, high, last))
        mean = [None] * len(rows)
    at = np.maximum(rows.first, from_at).tolist()
    return [*map(TrendPoint, at, low, high, mean, last, errors)]
