"""Readings that several statistics are made of."""

import pickle

from domain.timebase import seconds
from domain.windows.peaks import Largest
from domain.windows.settings import LEAST_R2, Statistic
from domain.windows.span import Span
from domain.windows.values import Mean

LENGTH = seconds(5.0)
MEAN = (Statistic.MEAN, None, None, LEAST_R2)
LARGEST = (Statistic.MAX, None, None, LEAST_R2)


def test_readings_are_taken_over_when_somebody_asks() -> None:
    span = Span(LENGTH, 10, start=0)
    mean = span.measure(MEAN, Mean)
    largest = span.measure(LARGEST, Largest)
    for at_s, value in ((1.0, 10.0), (2.0, 20.0), (6.5, 30.0)):
        span.add(seconds(at_s), value)
    span.catch_up(seconds(6.5))

    assert len(span.contents) == 2, "the first has left"
    assert mean.value(span.contents, seconds(6.5)) == 25.0
    assert largest.value(span.contents, seconds(6.5)) == 30.0


def test_the_same_statistic_is_kept_once() -> None:
    span = Span(LENGTH, 10, start=0)

    assert span.measure(MEAN, Mean) is span.measure(MEAN, Mean)
    assert span.measure(LARGEST, Largest) is not span.measure(MEAN, Mean)


def test_newer_readings_take_the_place_of_as_many_others() -> None:
    span = Span(None, 2, start=0)
    mean = span.measure(MEAN, Mean)
    for number in range(5):
        span.add(number, float(number))
    span.catch_up(5)

    assert len(span.contents) == 2
    assert mean.value(span.contents, 5) == 3.5


def test_a_reading_that_goes_before_its_time_is_missing_until_then() -> None:
    span = Span(LENGTH, 2, start=0)
    for at_s in (1.0, 1.5, 7.0, 7.5, 8.0):
        span.add(seconds(at_s), at_s)
    span.catch_up(seconds(8.0))

    assert len(span.contents) == 2
    assert not span.contents.is_complete(seconds(12.0) - 1), "7.0 had to go for 8.0"
    assert span.contents.is_complete(seconds(12.0))


def test_nobody_who_asks_is_needed_to_bound_the_memory() -> None:
    span = Span(None, 2, start=0)
    for number in range(100_000):
        span.add(number, 0.0)

    assert len(pickle.dumps(span)) < 10_000
    assert len(span.contents) == 2
