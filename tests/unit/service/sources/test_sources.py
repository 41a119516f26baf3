"""Sources that fail, hang, end or lie: the service goes on, and so do the others."""

import asyncio
import logging
import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

import pytest

from domain.health.signals import SignalKind, SignalSpec, default_signals
from domain.inputs import Reading, Readings, SourceFault
from domain.timebase import Instant, seconds
from service.ports import BackendMessage
from service.sources.source import Sink, Source, SourceError
from service.sources.sources import LONGEST_PAUSE, Sources
from tests.support.manual_clock import ManualClock, settle

SPECS = {signal.spec.name: signal.spec for signal in default_signals()} | {
    name: SignalSpec(name, SignalKind.NUMBER, minimum=-100.0) for name in ("cpu", "disk")
}


class Scripted:
    """A source that does what a test says, as one that is called back by a library does."""

    def __init__(self, name: str, *signals: str) -> None:
        self.name = name
        self.signals = signals
        self.runs = 0
        self.sink: Sink | None = None
        self._ending: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    async def run(self, sink: Sink) -> None:
        self.runs += 1
        self.sink = sink
        self._ending = asyncio.get_running_loop().create_future()
        await self._ending

    def take(self, signal: str, value: object, stamp: Instant | None = None) -> None:
        assert self.sink is not None
        self.sink.take(signal, value, stamp)

    def fail(self, signal: str, why: str) -> None:
        assert self.sink is not None
        self.sink.fail(signal, why)

    def end(self, error: BaseException | None = None) -> None:
        if error is None:
            self._ending.set_result(None)
        elif isinstance(error, asyncio.CancelledError):
            self._ending.cancel()
        else:
            self._ending.set_exception(error)


class Running:
    """Sources that run, and what they delivered."""

    def __init__(self, *sources: Source) -> None:
        self.clock = ManualClock()
        self.sources = Sources(sources, SPECS, self.clock)
        self.delivered: list[BackendMessage] = []

    def readings(self) -> list[tuple[str, object]]:
        return [
            (reading.signal, reading.value)
            for message in self.delivered
            if isinstance(message, Readings)
            for reading in message.items
        ]

    def faults(self) -> list[tuple[str, str]]:
        return [(m.signal, m.reason) for m in self.delivered if isinstance(m, SourceFault)]


@asynccontextmanager
async def running(*sources: Source) -> AsyncIterator[Running]:
    robot = Running(*sources)
    task = asyncio.create_task(robot.sources.run(robot.delivered.append))
    await settle()
    try:
        yield robot
        assert not task.done()
    finally:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


async def test_readings_are_delivered_with_the_name_of_their_source() -> None:
    source = Scripted("os", "cpu")
    async with running(source) as robot:
        source.take("cpu", 12, 7)

    assert robot.delivered == [Readings((Reading("cpu", 12.0, 7),), "os")]
    assert robot.sources.status[0].reads == 1


@pytest.mark.parametrize(
    "lie", [math.nan, math.inf, "1e400", "hot", 10**400, None, True, [1], -1_000, b"1", object()]
)
async def test_a_lie_is_refused_and_harms_no_other_signal(lie: object) -> None:
    source = Scripted("os", "cpu", "disk")
    async with running(source) as robot:
        source.take("cpu", lie)
        source.take("disk", 40.0)

    assert robot.readings() == [("disk", 40.0)]
    ((signal, why),) = robot.faults()
    assert signal == "cpu"
    assert why.startswith("refused: cpu must be")
    assert robot.sources.status[0].failures == 1


async def test_a_signal_that_is_not_the_sources_is_refused() -> None:
    source = Scripted("os", "cpu")
    async with running(source) as robot:
        source.take("estop", False)
        source.take("no such", 1)

    assert robot.delivered == []


async def test_one_and_nought_are_true_and_false_of_a_boolean_signal() -> None:
    source = Scripted("gpio", "estop")
    async with running(source) as robot:
        source.take("estop", 1)
        source.take("estop", 0.0)
        source.take("estop", 0.5)

    assert robot.readings() == [("estop", True), ("estop", False)]
    assert len(robot.faults()) == 1


@pytest.mark.parametrize(
    ("error", "why"),
    [
        (SourceError("there is no system bus"), "there is no system bus"),
        (ExceptionGroup("several", [OSError()]), "several (1 sub-exception)"),
        (None, "it ended"),
        (asyncio.CancelledError(), "it was cancelled"),
    ],
)
async def test_a_source_that_ends_is_run_again_and_the_others_go_on(
    error: BaseException | None, why: str
) -> None:
    bad, good = Scripted("bus", "disk"), Scripted("os", "cpu")
    async with running(bad, good) as robot:
        bad.end(error)
        await settle()
        good.take("cpu", 1.0)
        assert robot.faults() == [("disk", why)]

        await robot.clock.advance(1)
        assert (bad.runs, good.runs) == (2, 1)
        bad.take("disk", 2.0)
    assert robot.readings() == [("cpu", 1.0), ("disk", 2.0)]


async def test_a_source_that_ends_again_and_again_is_run_ever_less_often() -> None:
    class Ending(Scripted):
        async def run(self, sink: Sink) -> None:
            self.runs += 1

    source = Ending("bus", "disk")
    async with running(source) as robot:
        await robot.clock.advance(63)
        assert source.runs == 7
        await robot.clock.advance(600)
        assert source.runs == 17

    assert len(robot.faults()) == 1


async def test_a_source_that_ran_long_begins_anew_with_the_first_pause() -> None:
    source = Scripted("bus", "disk")
    async with running(source) as robot:
        for _ in range(5):
            await robot.clock.advance(LONGEST_PAUSE / seconds(1))
            source.end(OSError(19, "No such device"))
            await settle()
            await robot.clock.advance(1)
        assert source.runs == 6


async def test_only_what_changes_is_logged_and_told(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    source = Scripted("bus", "disk")
    async with running(source) as robot:
        for _ in range(10):
            source.fail("disk", "no answer")
        await robot.clock.advance(10)
        source.fail("disk", "no such device")
        for _ in range(10):
            source.take("disk", 1.0)

    assert robot.faults() == [("disk", "no answer"), ("disk", "no such device")]
    assert [record.getMessage() for record in caplog.records] == [
        "bus does not read disk: no answer",
        "bus does not read disk: no such device",
        "bus reads disk again",
    ]
    assert (robot.sources.status[0].reads, robot.sources.status[0].failures) == (10, 11)


async def test_a_source_that_fails_with_ever_new_words_does_not_fill_the_record() -> None:
    source = Scripted("bus", "disk", "cpu")
    async with running(source) as robot:
        for number in range(600):
            source.take("disk", f"garbage {number}")
            source.take("disk", 1.0)
            await robot.clock.advance(0.1)
        source.fail("cpu", "no answer")
        assert len(robot.faults()) == 6 + 1

        source.fail("disk", "no such device")
        await robot.clock.advance(10)
        source.fail("disk", "no such device")
    assert robot.faults()[-1] == ("disk", "no such device")


async def test_what_the_core_raises_is_no_failure_of_a_source_and_ends_the_adapter() -> None:
    def fail(_: BackendMessage) -> None:
        raise ZeroDivisionError

    source = Scripted("os", "cpu")
    task = asyncio.create_task(Sources((source,), SPECS, ManualClock()).run(fail))
    await settle()
    with pytest.raises(ZeroDivisionError):
        source.take("cpu", 1.0)

    with pytest.raises(ExceptionGroup) as caught:
        await task
    assert isinstance(caught.value.exceptions[0].__cause__, ZeroDivisionError)


async def test_a_source_may_give_readings_before_it_first_waits() -> None:
    class Eager(Scripted):
        async def run(self, sink: Sink) -> None:
            sink.take("cpu", 1.0)
            sink.note_duration(5)
            await super().run(sink)

    async with running(Eager("os", "cpu")) as robot:
        assert robot.readings() == [("cpu", 1.0)]
        assert robot.sources.status[0].duration == 5
