"""Readings are merged to rows, and rows to coarser ones."""

import sys

import pytest

from domain.timebase import seconds
from service.storage.trends.rows import NO_ERROR, Rows
from tests.support.trend_readings import START, readings


def test_a_spike_of_one_reading_is_in_its_bucket() -> None:
    second = readings([1.0] * 7 + [99.0] + [2.0] * 12).in_buckets(seconds(1.0))

    assert (second.low.tolist(), second.high.tolist()) == ([1.0], [99.0])
    assert (second.final.tolist(), second.count.tolist()) == ([2.0], [20])
    assert second.mean.tolist() == pytest.approx([(7 + 99 + 24) / 20])
    assert second.last[0] - second.first[0] == seconds(0.95)


def test_buckets_begin_at_multiples_of_their_width() -> None:
    rows = readings([1.0] * 40, START + seconds(0.5)).in_buckets(seconds(1.0))

    assert rows.count.tolist() == [10, 20, 10]


def test_the_worst_error_counts() -> None:
    (error,) = readings([1.0] * 4, errors=[NO_ERROR, 0, 1, NO_ERROR]).in_buckets(10**10).error

    assert error == 1


def test_the_last_reading_is_the_last_by_time_not_by_arrival() -> None:
    late, early = readings([5.0], START + seconds(0.9)), readings([1.0, 2.0])

    assert Rows.joined([late, early]).in_buckets(seconds(1.0)).final.tolist() == [5.0]


def test_in_buckets_of_no_width_readings_are_only_sorted() -> None:
    mixed = Rows.joined([readings([8.0], START + seconds(1.0)), readings([1.0, 2.0])])

    assert mixed.in_buckets(0).low.tolist() == [1.0, 2.0, 8.0]


def test_the_mean_of_the_largest_numbers_is_one() -> None:
    largest = sys.float_info.max

    rows = readings([largest] * 20).in_buckets(seconds(1.0))

    assert rows.mean.tolist() == [largest]


def test_the_mean_of_rows_is_that_of_all_their_readings() -> None:
    seconds_ = readings([0.0] * 20 + [10.0] * 5).in_buckets(seconds(1.0))

    assert seconds_.in_buckets(seconds(60.0)).mean.tolist() == pytest.approx([2.0])


def test_nothing_is_merged_of_nothing() -> None:
    assert len(Rows.joined([]).in_buckets(seconds(1.0))) == 0


def test_rows_that_overlap_a_time_are_seen_as_a_whole() -> None:
    rows = readings(range(100)).in_buckets(seconds(1.0))

    seen = rows.overlapping(START + seconds(1.5), START + seconds(3.0))

    assert [first - START for first in seen.first] == [seconds(1.0), seconds(2.0), seconds(3.0)]
    assert seen.count.tolist() == [20, 20, 20]
