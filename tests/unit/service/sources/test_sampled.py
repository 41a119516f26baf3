"""A source that is read from time to time; what every source keeps is in tests/conformance."""

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, suppress
from itertools import pairwise

import pytest

from domain.timebase import seconds
from service.sources.sampled import LONGEST_PAUSE, Probe, SampledSource
from tests.support.manual_clock import ManualClock
from tests.support.sources import InlineThread, NotedSink


@pytest.fixture(autouse=True)
def _inline(monkeypatch: pytest.MonkeyPatch) -> None:
    InlineThread.reset()
    monkeypatch.setattr("service.sources.sampled.CallThread", InlineThread)


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@asynccontextmanager
async def running(
    clock: ManualClock, *probes: Probe, close: Callable[[], None] | None = None
) -> AsyncIterator[NotedSink]:
    sink = NotedSink()
    task = asyncio.create_task(SampledSource("bus", probes, clock, close).run(sink))
    try:
        yield sink
    finally:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


def fails() -> object:
    raise OSError(121, "Remote I/O error")


async def test_each_signal_has_its_own_period(clock: ManualClock) -> None:
    fast, slow = (
        Probe("fast", seconds(1), lambda: 1),
        Probe("slow", seconds(10), lambda: 2),
    )
    async with running(clock, fast, slow) as sink:
        await clock.advance(20)

    signals = [signal for signal, _ in sink.taken]
    assert (signals.count("fast"), signals.count("slow")) == (21, 3)


async def test_a_signal_that_fails_does_not_keep_the_others_from_being_read(
    clock: ManualClock,
) -> None:
    good, bad = Probe("good", seconds(1), lambda: 1), Probe("bad", seconds(1), fails)
    async with running(clock, good, bad) as sink:
        await clock.advance(60)

    assert sink.taken == [("good", 1)] * 61
    assert set(sink.failed) == {("bad", "Remote I/O error")}


async def test_what_fails_again_and_again_is_tried_at_least_every_ten_seconds(
    clock: ManualClock,
) -> None:
    tries = []

    def read() -> object:
        tries.append(clock.now())
        return fails()

    async with running(clock, Probe("bad", seconds(1), read)):
        await clock.advance(100)

    pauses = [later - earlier for earlier, later in pairwise(tries)]
    assert pauses[:4] == [seconds(2), seconds(4), seconds(8), LONGEST_PAUSE]
    assert set(pauses[3:]) == {LONGEST_PAUSE}


async def test_a_rate_that_needs_two_looks_does_not_wait_a_long_period_for_the_second(
    clock: ManualClock,
) -> None:
    looks: Iterator[object] = iter([None, 5.0, 6.0])
    async with running(clock, Probe("rate", seconds(10), lambda: next(looks))) as sink:
        await clock.advance(1)
        assert sink.taken == [("rate", 5.0)]
        await clock.advance(10)
        assert sink.taken == [("rate", 5.0), ("rate", 6.0)]


async def test_readings_that_were_missed_are_not_made_up_for(clock: ManualClock) -> None:
    async with running(clock, Probe("a", seconds(1), lambda: 1)) as sink:
        await clock.advance(0)
        clock.stall(10)
        await clock.advance(0.5)

    assert len(sink.taken) == 2


async def test_the_device_is_closed_at_the_end_even_if_that_fails(clock: ManualClock) -> None:
    closed = []

    def close() -> None:
        closed.append(True)
        raise OSError(19, "No such device")

    async with running(clock, Probe("a", seconds(1), lambda: 1), close=close):
        await clock.advance(0)

    assert closed == [True]
    assert InlineThread.ended == 1


async def test_what_a_call_that_hung_returns_at_last_is_discarded(clock: ManualClock) -> None:
    """It was measured at a time that nobody knows."""
    values = iter([1, 2, 3])
    async with running(clock, Probe("a", seconds(1), lambda: next(values))) as sink:
        await clock.advance(0)
        InlineThread.hangs = True
        await clock.advance(100)
        InlineThread.go_on()
        await clock.advance(10)

    assert sink.taken[:2] == [("a", 1), ("a", 3)]
