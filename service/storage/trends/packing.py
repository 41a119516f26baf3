"""Rows of one signal as bytes: columns of differences, byte planes, compressed.

The bytes of a column are sorted by their place in the number: all highest bytes come first, then
all second ones. Those are nearly the same in each row, and so they take almost no space.

Times are rounded down to the unit of the tier. Values are exact, but for the mean: it is kept as a
65,535th of the way from the minimum to the maximum.
"""

import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from domain.timebase import Duration, Instant
from service.storage.trends.rows import NO_ERROR, Floats, Integers, Rows

_LEVEL = 1
"""Of compression: higher levels save 1 % of such columns, for several times the work."""

_MEAN_STEPS = 65_535


def pack(rows: Rows, errors: Sequence[int], unit: Duration, *, is_raw: bool) -> bytes:
    """Return rows as bytes.

    Args:
        rows: Of one signal; at least one.
        errors: The ranks of errors in them, without `NO_ERROR`; at most 255.
        unit: To which times are rounded down.
        is_raw: Whether each row is a single reading.
    """
    first = rows.first // unit
    steps = np.zeros(len(rows), np.int64)
    np.subtract(first[1:], first[:-1], out=steps[1:])
    columns: list[NDArray[np.generic]] = [steps]
    if is_raw:
        columns.append(rows.low)
    else:
        columns += [rows.last // unit - first, rows.low, rows.high, rows.final]
        columns += [_mean_steps(rows), rows.count]
    if errors:
        places = {rank: place for place, rank in enumerate(errors, 1)}
        ranks = rows.error.tolist()
        columns.append(np.array([places.get(rank, 0) for rank in ranks], np.uint8))
    return zlib.compress(b"".join(map(_planes, columns)), _LEVEL)


def unpack(
    data: bytes,
    length: int,
    first_at: Instant,
    errors: Sequence[int],
    unit: Duration,
    *,
    is_raw: bool,
    signal: int,
) -> Rows:
    """Return the rows that `pack` made bytes of.

    Args:
        data: The bytes.
        length: Number of rows.
        first_at: Time of the first row.
        errors: The ranks of errors, in the order given to `pack`.
        unit: To which times were rounded down.
        is_raw: Whether each row is a single reading.
        signal: Number of the signal.

    Raises:
        ValueError: These are not such bytes.
        zlib.error: They cannot be decompressed.
    """
    columns = _Columns(zlib.decompress(data), length)
    first = (np.cumsum(columns.integers()) + first_at // unit) * unit
    number = np.full(length, signal)
    if is_raw:
        value = columns.floats()
        return Rows.of_readings(number, first, value, columns.ranks(errors))
    last = first + columns.integers() * unit
    low, high, final = columns.floats(), columns.floats(), columns.floats()
    share = columns.take(np.uint16) / _MEAN_STEPS
    mean = np.clip(low * (1.0 - share) + high * share, low, high)
    count = columns.integers()
    error = columns.ranks(errors)
    return Rows(number, first, last, low, high, mean, final, count, error)


def _mean_steps(rows: Rows) -> NDArray[np.uint16]:
    # Halved, since the difference of large numbers would overflow.
    span = rows.high / 2 - rows.low / 2
    above = rows.mean / 2 - rows.low / 2
    share = np.divide(above, span, out=np.zeros(len(rows)), where=span > 0)
    steps: NDArray[np.uint16] = np.rint(np.clip(share, 0.0, 1.0) * _MEAN_STEPS).astype(np.uint16)
    return steps


def _planes(column: NDArray[np.generic]) -> bytes:
    little = np.ascontiguousarray(column, column.dtype.newbyteorder("<"))
    return little.view(np.uint8).reshape(len(column), -1).T.tobytes()


class _Columns:
    """Takes one column after the other."""

    def __init__(self, data: bytes, length: int) -> None:
        self._data = np.frombuffer(data, np.uint8)
        self._length = length
        self._at = 0

    def take(self, kind: type[np.generic]) -> NDArray[Any]:
        dtype = np.dtype(kind).newbyteorder("<")
        end = self._at + self._length * dtype.itemsize
        planes = self._data[self._at : end].reshape(dtype.itemsize, self._length)
        self._at = end
        return np.ascontiguousarray(planes.T).view(dtype).reshape(self._length)

    def integers(self) -> Integers:
        return self.take(np.int64).astype(np.int64, copy=False)

    def floats(self) -> Floats:
        return self.take(np.float64).astype(np.float64, copy=False)

    def ranks(self, errors: Sequence[int]) -> Integers:
        if not errors:
            return np.full(self._length, NO_ERROR)
        return np.array([NO_ERROR, *errors])[self.take(np.uint8).astype(np.int64)]
