"""Rows of numbers, each of which summarises readings of one signal; rows merge into coarser ones.

Merging is exact for minimum, maximum, count, worst error and the last value, in any order and
however often: a spike of one reading is in every tier.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from domain.timebase import Duration

Integers = NDArray[np.int64]
Floats = NDArray[np.float64]

NO_ERROR = -(2**15)
"""Rank of readings without an error, below that of each error."""


@dataclass(frozen=True, slots=True)
class Rows:
    """Columns of the same length."""

    signal: Integers
    """Number of the signal."""
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
    def of_readings(cls, signal: Integers, at: Integers, value: Floats, error: Integers) -> "Rows":
        """Return a row per reading, in the order of arrival."""
        return cls(signal, at, at, value, value, value, value, np.ones(len(at), np.int64), error)

    @classmethod
    def joined(cls, parts: Sequence["Rows"]) -> "Rows":
        """Return all rows of several parts, in their order."""
        if len(parts) == 1:
            return parts[0]
        if not parts:
            integers, floats = np.empty(0, np.int64), np.empty(0)
            return cls.of_readings(integers, integers, floats, integers)
        columns = zip(*(part.columns() for part in parts), strict=True)
        return cls(*map(np.concatenate, columns))

    def columns(self) -> tuple[NDArray[Any], ...]:
        """Return all columns."""
        return (
            self.signal,
            self.first,
            self.last,
            self.low,
            self.high,
            self.mean,
            self.final,
            self.count,
            self.error,
        )

    def taken(self, which: slice | NDArray[np.bool_] | Integers) -> "Rows":
        """Return the rows of a slice, of a mask, or at indices."""
        return Rows(*(column[which] for column in self.columns()))

    def of_signal(self, number: int) -> "Rows":
        """Return the rows of one signal."""
        return self.taken(self.signal == number)

    def in_buckets(self, width: Duration) -> "Rows":
        """Return the rows by signal and time, merged to one per signal and bucket.

        Args:
            width: Of the buckets, which begin at multiples of it; 0: the rows are only sorted.
        """
        if not width:
            return self.taken(np.lexsort((self.first, self.signal)))
        bucket = self.first // width
        # By time also within a bucket: after the clock was set back, the last ones to arrive are
        # not the last ones.
        order = np.lexsort((self.last, bucket, self.signal))
        return self.taken(order).merged(self.signal[order], bucket[order])

    def merged(self, *keys: Integers) -> "Rows":
        """Return one row for each run of equal keys.

        Args:
            keys: Columns by which the rows are sorted, and by time where these are equal.
        """
        if not len(self):
            return self
        is_new = np.zeros(len(self), np.bool_)
        is_new[0] = True
        for key in keys:
            is_new[1:] |= key[1:] != key[:-1]
        starts = np.flatnonzero(is_new)
        if len(starts) == len(self):
            return self
        return self._reduced(starts)

    def _reduced(self, starts: Integers) -> "Rows":
        ends = np.append(starts[1:], len(self))
        count = np.add.reduceat(self.count, starts)
        low = np.minimum.reduceat(self.low, starts)
        high = np.maximum.reduceat(self.high, starts)
        # Each is weighted before it is added, since a sum of large numbers would overflow. By
        # rounding, that of the largest ones still can.
        share = self.count / np.repeat(count, ends - starts)
        with np.errstate(over="ignore"):
            mean = np.clip(np.add.reduceat(self.mean * share, starts), low, high)
        return Rows(
            self.signal[starts],
            np.minimum.reduceat(self.first, starts),
            np.maximum.reduceat(self.last, starts),
            low,
            high,
            mean,
            self.final[ends - 1],
            count,
            np.maximum.reduceat(self.error, starts),
        )

    def by_signal(self) -> Iterator[tuple[int, "Rows"]]:
        """Yield each signal with its rows, which have to be sorted by it."""
        if not len(self):
            return
        starts = np.flatnonzero(np.diff(self.signal, prepend=self.signal[0] - 1))
        ends = np.append(starts[1:], len(self))
        for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
            yield int(self.signal[start]), self.taken(slice(start, end))
