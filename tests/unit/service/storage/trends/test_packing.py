"""Rows come back from bytes as they were."""

import zlib

import hypothesis.strategies as st
import pytest
from hypothesis import given

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
    back = unpack(data, len(rows), START, [-1, 0, 7], 1_000, is_raw=True)

    assert back.low.tobytes() == rows.low.tobytes()
    assert back.error.tolist() == rows.error.tolist()
    assert back.first.tolist() == [at // 1_000 * 1_000 for at in rows.first]


@given(st.lists(numbers, min_size=1, max_size=200))
def test_rows_come_back_exactly_but_for_the_mean(values: list[float]) -> None:
    rows = readings(values, every=seconds(0.3)).in_buckets(seconds(1.0))

    data = pack(rows, [], MILLISECOND, is_raw=False)
    back = unpack(data, len(rows), START, [], MILLISECOND, is_raw=False)

    for column in ("low", "high", "final", "count", "first", "last", "error"):
        assert getattr(back, column).tobytes() == getattr(rows, column).tobytes(), column
    for low, high, mean, before in zip(rows.low, rows.high, back.mean, rows.mean, strict=True):
        assert low <= mean <= high
        # Halved, since the difference of large numbers would overflow.
        assert abs(mean / 2 - before / 2) <= (high / 2 - low / 2) / 65_000


def test_a_signal_that_hardly_changes_takes_little_space() -> None:
    rows = readings([20.0, 20.5] * 300).in_buckets(seconds(1.0))

    assert len(pack(rows, [], MILLISECOND, is_raw=False)) < 3 * len(rows)


def test_bytes_that_are_cut_are_noticed() -> None:
    data = pack(readings([1.0] * 9), [], 1_000, is_raw=True)

    with pytest.raises(ValueError, match="10 rows do not fit into 144 bytes"):
        unpack(data, 10, START, [], 1_000, is_raw=True)


@pytest.mark.parametrize(
    ("data", "errors", "is_raw"),
    [
        pytest.param(b"", [], True, id="no row"),
        pytest.param(b"\x7f" * 16, [], True, id="a time after all time"),
        pytest.param(b"\0" * 16 + b"\2", [7], True, id="an error that there is not"),
        pytest.param(b"\0" * 50, [], False, id="a row of no reading"),
    ],
)
def test_bytes_that_cannot_have_been_packed_are_noticed(
    data: bytes, errors: list[int], *, is_raw: bool
) -> None:
    with pytest.raises(ValueError, match="not rows that were packed"):
        unpack(zlib.compress(data), min(len(data), 1), START, errors, 1_000, is_raw=is_raw)


def test_rows_without_errors_have_none() -> None:
    rows = Rows.joined([readings([1.0])])
    data = pack(rows, [], 1_000, is_raw=True)

    back = unpack(data, 1, START, [], 1_000, is_raw=True)

    assert back.error.tolist() == [NO_ERROR]
