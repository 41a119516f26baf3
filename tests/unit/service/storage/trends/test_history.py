"""Rows as points of a chart."""

import pytest

from domain.health.signals import default_signals
from domain.timebase import seconds
from service.storage.trends.history import trend_of
from service.storage.trends.known_signals import KnownSignals
from service.storage.trends.rows import Rows
from service.storage.trends.tiers import TIERS
from tests.support.trend_readings import START, load, readings

RAW, SECOND = TIERS[0], TIERS[1]
LOAD = KnownSignals([load()]).by_name["load"]
MINUTE = seconds(60.0)


def test_a_few_readings_are_points_of_their_own() -> None:
    trend = trend_of(readings([1.0, 2.0]), LOAD, RAW, START, START + MINUTE, 1_000)

    assert [(point.at - START, point.low, point.high) for point in trend.points] == [
        (0, 1.0, 1.0),
        (seconds(0.05), 2.0, 2.0),
    ]
    assert trend.width == 0


@pytest.mark.parametrize("points", [2, 3, 10, 59, 60, 1_000])
@pytest.mark.parametrize("shift", [0, 1, seconds(0.7)])
def test_there_are_at_most_as_many_points_as_were_asked_for(points: int, shift: int) -> None:
    values = [0.0] * 1_200
    values[777] = 99.0
    rows = readings(values, START + shift)

    trend = trend_of(rows, LOAD, RAW, START, START + 2 * MINUTE, points)

    assert points / 2 - 1 <= len(trend.points) <= points
    assert max(point.high for point in trend.points) == 99.0


def test_parts_of_one_bucket_are_one_point() -> None:
    early = readings([1.0, 9.0]).in_buckets(seconds(1.0))
    late = readings([2.0, 3.0], START + seconds(0.5))

    trend = trend_of(Rows.joined([early, late]), LOAD, SECOND, START, START + MINUTE, 1_000)

    ((low, high, last),) = [(point.low, point.high, point.last) for point in trend.points]
    assert (low, high, last) == (1.0, 9.0, 3.0)


def test_silence_is_no_point() -> None:
    rows = Rows.joined([readings([1.0]), readings([2.0], START + seconds(30.0))])

    trend = trend_of(rows, LOAD, SECOND, START, START + MINUTE, 1_000)

    assert [point.at - START for point in trend.points] == [0, seconds(30.0)]


def test_only_what_was_asked_for_is_shown_and_a_bucket_at_its_begin_as_a_whole() -> None:
    rows = readings(range(100)).in_buckets(seconds(1.0))

    begin = START + seconds(2.5)
    trend = trend_of(rows, LOAD, SECOND, begin, START + seconds(3.5), 1_000)

    assert [(p.at - begin, p.low) for p in trend.points] == [(0, 40.0), (seconds(0.5), 60.0)]


def test_a_reading_at_the_very_end_is_shown() -> None:
    trend = trend_of(readings([1.0]), LOAD, RAW, START - MINUTE, START, 1_000)

    assert len(trend.points) == 1


def test_the_errors_are_named() -> None:
    ranks = [LOAD.rank_of(name) for name in (None, "LOAD_HEAVY", "LOAD_OVERLOAD", None)]

    trend = trend_of(
        readings([1.0] * 4, errors=ranks).in_buckets(seconds(0.1)),
        LOAD,
        TIERS[0],
        START,
        START + MINUTE,
        1_000,
    )

    assert [point.error for point in trend.points] == ["LOAD_HEAVY", "LOAD_OVERLOAD"]


def test_an_enumeration_shows_its_best_and_its_worst_member() -> None:
    strength = KnownSignals(default_signals()).by_name["signal_strength"]
    rows = readings([0.0, 2.0, 1.0]).in_buckets(seconds(1.0))

    (point,) = trend_of(rows, strength, SECOND, START, START + MINUTE, 1_000).points

    assert (point.low, point.high) == ("CONNECTED", "NOT_CONNECTED")
    assert (point.mean, point.last) == (None, "LOW_SIGNAL")


def test_bins_stay_where_they_are_when_the_chart_moves_on() -> None:
    rows = readings(range(2_000))

    charts = [
        trend_of(rows, LOAD, RAW, START + shift, START + MINUTE + shift, 100).points
        for shift in (0, seconds(1.0))
    ]

    early, late = ({point.at: point.high for point in points} for points in charts)
    shared = sorted(early.keys() & late.keys())
    assert len(shared) > 90
    assert all(early[at] == late[at] for at in shared[1:-1])
