"""Rows come back from bytes as they were."""

import hypothesis.extra.numpy as stn
import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given
from numpy.typing import NDArray

from domain.timebase import seconds
from service.storage.trends.packing import pack, unpack
from service.storage.trends.rows import NO_ERROR, Rows
from tests.support.trend_readings import START, readings

MILLISECOND = seconds(0.001)

numbers = st.floats(allow_nan=False, allow_infinity=False)


@given(
    st.lists(st.tuples(numbers, st.sampled_from([NO_ERROR, -1, 0, 7])), min_size=1, max_size=50),
    st.integers(0, 10**9),
)
def test_single_readings_come_back_exactly(found: list[tuple[float, int]], every: int) -> None:
    rows = readings([value for value, _ in found], START, every, errors=[e for _, e in found])

    data = pack(rows, [-1, 0, 7], 1_000, is_raw=True)
    back = unpack(data, len(rows), START, [-1, 0, 7], 1_000, is_raw=True, signal=4)

    assert back.low.tobytes() == rows.low.tobytes()
    assert back.error.tolist() == rows.error.tolist()
    assert back.first.tolist() == (rows.first // 1_000 * 1_000).tolist()
    assert set(back.signal.tolist()) == {4}


@given(stn.arrays(np.float64, st.integers(1, 200), elements=numbers))
def test_rows_come_back_exactly_but_for_the_mean(values: NDArray[np.float64]) -> None:
    rows = readings(values, every=seconds(0.3)).in_buckets(seconds(1.0))

    data = pack(rows, [], MILLISECOND, is_raw=False)
    back = unpack(data, len(rows), START, [], MILLISECOND, is_raw=False, signal=0)

    for column in ("low", "high", "final", "count", "first", "last", "error"):
        assert getattr(back, column).tobytes() == getattr(rows, column).tobytes(), column
    assert np.all((rows.low <= back.mean) & (back.mean <= rows.high))
    # Halved, since the difference of large numbers would overflow.
    assert np.all(np.abs(back.mean / 2 - rows.mean / 2) <= (rows.high / 2 - rows.low / 2) / 65_000)


def test_a_signal_that_hardly_changes_takes_little_space() -> None:
    rows = readings([20.0, 20.5] * 300).in_buckets(seconds(1.0))

    assert len(pack(rows, [], MILLISECOND, is_raw=False)) < 3 * len(rows)


def test_bytes_that_are_cut_are_noticed() -> None:
    data = pack(readings([1.0] * 9), [], 1_000, is_raw=True)

    with pytest.raises(ValueError, match="reshape"):
        unpack(data, 10, START, [], 1_000, is_raw=True, signal=0)


def test_rows_without_errors_have_none() -> None:
    rows = Rows.joined([readings([1.0])])
    data = pack(rows, [], 1_000, is_raw=True)

    back = unpack(data, 1, START, [], 1_000, is_raw=True, signal=0)

    assert back.error.tolist() == [NO_ERROR]
