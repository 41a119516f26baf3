"""Rows of one signal, each of which summarises readings; rows merge into coarser ones.

Merging is exact for minimum, maximum, count, worst error and the last value, in any order and
however often: a spike of one reading is in every tier.

The columns are arrays of the standard library. A robot at rest has a history, too, and does
without numpy (decision 64).
"""

from array import array
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, compress, groupby, pairwise, repeat
from operator import le, mul, truediv
from typing import Any, Final, TypeAlias

from domain.timebase import Duration, Instant

Integers: TypeAlias = "array[int]"
Floats: TypeAlias = "array[float]"

TIMES: Final = "q"
VALUES: Final = "d"
RANKS: Final = "h"
COUNTS: Final = "q"

NO_ERROR = -(2**15)
"""Rank of readings without an error, below that of each error."""


@dataclass(frozen=True, slots=True)
class Rows:
    """Columns of the same length."""

    first: Integers
    """Time of the first reading."""
    last: Integers
    """Time of the last reading."""
    low: Floats
    high: Floats
    mean: Floats
    final: Floats
    """The last reading, by its time."""
    count: Integers
    """How many readings there were."""
    error: Integers
    """Rank of the worst error in force."""

    def __len__(self) -> int:
        return len(self.first)

    @classmethod
    def of_readings(cls, at: Integers, value: Floats, error: Integers) -> "Rows":
        """Return a row per reading, in the order of arrival."""
        return cls(at, at, value, value, value, value, array(COUNTS, [1]) * len(at), error)

    @classmethod
    def joined(cls, parts: Sequence["Rows"]) -> "Rows":
        """Return all rows of several parts, in their order."""
        if len(parts) == 1:
            return parts[0]
        if not parts:
            return cls.of_readings(array(TIMES), array(VALUES), array(RANKS))
        columns = zip(*(part.columns() for part in parts), strict=True)
        return cls(*map(_joined, columns))

    def columns(self) -> "tuple[array[Any], ...]":
        """Return all columns."""
        return (
            self.first,
            self.last,
            self.low,
            self.high,
            self.mean,
            self.final,
            self.count,
            self.error,
        )

    def overlapping(self, from_at: Instant, to_at: Instant) -> "Rows":
        """Return the rows that overlap a time."""
        is_seen = [
            last >= from_at and first <= to_at
            for first, last in zip(self.first, self.last, strict=True)
        ]
        return self if all(is_seen) else self._each(lambda column: compress(column, is_seen))

    def in_order(self) -> "Rows":
        """Return the rows by their first reading."""
        return self if _is_rising(self.first) else self._sorted(self.first)

    def in_buckets(self, width: Duration) -> "Rows":
        """Return the rows by time, merged to one per bucket.

        Args:
            width: Of the buckets, which begin at multiples of it; 0: the rows are only sorted.
        """
        if not width:
            return self.in_order()
        return self.merged([first // width for first in self.first])

    def merged(self, buckets: Sequence[int]) -> "Rows":
        """Return one row per bucket, by bucket.

        Args:
            buckets: That of each row.
        """
        # By time also within a bucket: after the clock was set back, the last ones to arrive are
        # not the last ones.
        if _is_rising(buckets) and _is_rising(self.last):
            return _with_runs_merged(self, buckets)
        rows = self._sorted([*zip(buckets, self.last, strict=True)])
        return _with_runs_merged(rows, sorted(buckets))

    def _sorted(self, keys: Sequence[Instant | tuple[int, Instant]]) -> "Rows":
        order = sorted(range(len(self)), key=keys.__getitem__)
        return self._each(lambda column: map(column.__getitem__, order))

    def _each(self, picked: "Callable[[array[Any]], Iterable[Any]]") -> "Rows":
        """Return the rows that are picked from each column."""
        return Rows(*(array(column.typecode, picked(column)) for column in self.columns()))


RowsBySignal: TypeAlias = Mapping[int, Rows]
"""The rows of several signals, at least one of each, by the number of the signal."""


def row_count(rows: RowsBySignal) -> int:
    """Return how many rows there are of all signals."""
    return sum(map(len, rows.values()))


def _with_runs_merged(rows: Rows, buckets: Sequence[int]) -> Rows:
    """Return one row for each run of rows in the same bucket, within which they are by time."""
    lengths = [len([*run]) for _, run in groupby(buckets)]
    if len(lengths) == len(rows):
        return rows
    spans = [slice(*ends) for ends in pairwise(accumulate(lengths, initial=0))]
    low = array(VALUES, [min(rows.low[span]) for span in spans])
    high = array(VALUES, [max(rows.high[span]) for span in spans])
    means = [_mean(rows.mean[span], rows.count[span]) for span in spans]
    return Rows(
        array(TIMES, [min(rows.first[span]) for span in spans]),
        array(TIMES, [max(rows.last[span]) for span in spans]),
        low,
        high,
        # By rounding, a mean may lie beside all that it is the mean of.
        array(VALUES, map(max, low, map(min, high, means))),
        array(VALUES, [rows.final[span.stop - 1] for span in spans]),
        array(COUNTS, [sum(rows.count[span]) for span in spans]),
        array(RANKS, [max(rows.error[span]) for span in spans]),
    )


def _joined(parts: "Sequence[array[Any]]") -> "array[Any]":
    whole = array(parts[0].typecode)
    for part in parts:
        whole.extend(part)
    return whole


def _is_rising(numbers: Sequence[int]) -> bool:
    return all(map(le, numbers, numbers[1:]))


def _mean(means: Floats, counts: Integers) -> float:
    # Each is weighted before it is added, since a sum of large numbers would overflow. By rounding,
    # that of the largest ones still can.
    shares = map(truediv, counts, repeat(sum(counts)))
    mean: float = sum(map(mul, means, shares))
    return mean
