"""Rows of one signal as bytes: columns of differences, byte planes, compressed.

The bytes of a column are sorted by their place in the number: all highest bytes come first, then
all second ones. Those are nearly the same in each row, and so they take almost no space.

Times are rounded down to the unit of the tier. Values are exact, but for the mean: it is kept as a
65,535th of the way from the minimum to the maximum.
"""

import sys
import zlib
from array import array
from collections.abc import Iterator, Sequence
from itertools import accumulate, repeat
from operator import add, mul, sub
from typing import Any, Final

from domain.timebase import Duration, Instant
from service.storage.trends.rows import COUNTS, NO_ERROR, RANKS, TIMES, VALUES, Rows

_LEVEL = 1
"""Of compression: higher levels save 1 % of such columns, for several times the work."""

_MEAN_STEPS = 65_535
_SHARES: Final = "H"
_PLACES: Final = "B"


def pack(rows: Rows, errors: Sequence[int], unit: Duration, *, is_raw: bool) -> bytes:
    """Return rows as bytes.

    Args:
        rows: Of one signal; at least one.
        errors: The ranks of errors in them, without `NO_ERROR`; at most 255.
        unit: To which times are rounded down.
        is_raw: Whether each row is a single reading.
    """
    first = [at // unit for at in rows.first]
    columns: list[array[Any]] = [array(TIMES, [0, *map(sub, first[1:], first)])]
    if is_raw:
        columns.append(rows.low)
    else:
        last = [at // unit for at in rows.last]
        columns += [array(TIMES, map(sub, last, first)), rows.low, rows.high, rows.final]
        columns += [array(_SHARES, _mean_steps(rows)), rows.count]
    if errors:
        places = {rank: place for place, rank in enumerate(errors, 1)}
        columns.append(array(_PLACES, [places.get(rank, 0) for rank in rows.error]))
    return zlib.compress(b"".join(map(_planes, columns)), _LEVEL)


def unpack(
    data: bytes,
    length: int,
    first_at: Instant,
    errors: Sequence[int],
    unit: Duration,
    *,
    is_raw: bool,
) -> Rows:
    """Return the rows that `pack` made bytes of.

    Args:
        data: The bytes.
        length: Number of rows.
        first_at: Time of the first row.
        errors: The ranks of errors, in the order given to `pack`.
        unit: To which times were rounded down.
        is_raw: Whether each row is a single reading.

    Raises:
        ValueError: These are not such bytes.
        zlib.error: They cannot be decompressed.
    """
    columns = _Columns(zlib.decompress(data), length)
    try:
        return _unpacked(columns, first_at, errors, unit, is_raw=is_raw)
    except (IndexError, OverflowError) as error:
        raise ValueError(f"not rows that were packed: {error}") from error


def _unpacked(
    columns: "_Columns", first_at: Instant, errors: Sequence[int], unit: Duration, *, is_raw: bool
) -> Rows:
    steps = columns.take(TIMES)
    steps[0] += first_at // unit
    first = array(TIMES, map(mul, accumulate(steps), repeat(unit)))
    if is_raw:
        return Rows.of_readings(first, columns.take(VALUES), columns.ranks(errors))
    last = array(TIMES, map(add, first, map(mul, columns.take(TIMES), repeat(unit))))
    low, high, final = columns.take(VALUES), columns.take(VALUES), columns.take(VALUES)
    mean = array(VALUES, map(_mean, low, high, columns.take(_SHARES)))
    count = columns.take(COUNTS)
    if min(count) < 1:
        raise IndexError("a row is of no reading")
    return Rows(first, last, low, high, mean, final, count, columns.ranks(errors))


def _mean_steps(rows: Rows) -> Iterator[int]:
    for low, high, mean in zip(rows.low, rows.high, rows.mean, strict=True):
        # Halved, since the difference of large numbers would overflow.
        span = high / 2 - low / 2
        share = (mean / 2 - low / 2) / span if span > 0 else 0.0
        yield round(min(max(share, 0.0), 1.0) * _MEAN_STEPS)


def _mean(low: float, high: float, step: int) -> float:
    share = step / _MEAN_STEPS
    return min(max(low * (1.0 - share) + high * share, low), high)


def _planes(column: "array[Any]") -> bytes:
    data = _little(column).tobytes()
    return b"".join(data[place :: column.itemsize] for place in range(column.itemsize))


def _little(column: "array[Any]") -> "array[Any]":
    """Return a column with its bytes in the order of the file, or one of the file in our order."""
    if sys.byteorder == "little":
        return column
    swapped = column[:]
    swapped.byteswap()
    return swapped


class _Columns:
    """Takes one column after the other."""

    def __init__(self, data: bytes, length: int) -> None:
        self._data = data
        self._length = length
        self._at = 0

    def take(self, kind: str) -> "array[Any]":
        column = array(kind)
        end = self._at + self._length * column.itemsize
        if end > len(self._data):
            raise ValueError(f"{self._length} rows do not fit into {len(self._data)} bytes")
        whole = bytearray(end - self._at)
        for place in range(column.itemsize):
            begin = self._at + place * self._length
            whole[place :: column.itemsize] = self._data[begin : begin + self._length]
        self._at = end
        column.frombytes(whole)
        return _little(column)

    def ranks(self, errors: Sequence[int]) -> "array[int]":
        if not errors:
            return array(RANKS, [NO_ERROR]) * self._length
        ranks = (NO_ERROR, *errors)
        return array(RANKS, map(ranks.__getitem__, self.take(_PLACES)))
