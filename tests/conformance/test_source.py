"""What every source must keep, in virtual time and without its device.

An adapter joins with a class of its own in `UNDER_TEST`; the assertions are the same for all.
"""

import asyncio
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Protocol

import pytest

from service.files.source_block import (
    FileBlock,
    GpioBlock,
    I2cBlock,
    OsBlock,
    SpiBlock,
    SystemdBlock,
)
from service.sources.gpio import gpio_source
from service.sources.i2c import i2c_source
from service.sources.number_file import file_source
from service.sources.os import machine
from service.sources.os.os_sources import os_sources
from service.sources.sampled import DEADLINE, LONGEST_PAUSE
from service.sources.source import Source
from service.sources.spi import spi_source
from service.sources.systemd import systemd_source
from tests.support.manual_clock import ManualClock
from tests.support.sources import (
    Device,
    InlineThread,
    NotedSink,
    fake_gpiod,
    fake_smbus2,
    fake_spidev,
    fake_systemd_bus,
)

A, B = "a", "b"
"""Two signals of one source."""


class Thing(Protocol):
    """What a source reads; both signals show the same."""

    source: Source

    def set(self, *, on: bool) -> None:
        """Let the signals read 1, or 0."""

    def set_there(self, *, there: bool) -> None:
        """Let the thing be there, or not."""


class _WithDevice:
    """A thing behind a library."""

    def __init__(self, device: Device) -> None:
        self.device = device

    def set(self, *, on: bool) -> None:
        self.device.number = int(on)

    def set_there(self, *, there: bool) -> None:
        self.device.is_there = there


class I2c(_WithDevice):
    def __init__(self, clock: ManualClock, _: Path, patch: pytest.MonkeyPatch) -> None:
        super().__init__(Device())
        patch.setitem(sys.modules, "smbus2", fake_smbus2(self.device))
        block = I2cBlock.model_validate({"bus": 1, "address": 0x40, "register": 2})
        self.source: Source = i2c_source(clock, 1, {A: block, B: block})


class Spi(_WithDevice):
    def __init__(self, clock: ManualClock, _: Path, patch: pytest.MonkeyPatch) -> None:
        super().__init__(Device())
        patch.setitem(sys.modules, "spidev", fake_spidev(self.device))
        block = SpiBlock(bus=0, send=[0x80])
        self.source: Source = spi_source(clock, (0, 0), {A: block, B: block})


class Gpio(_WithDevice):
    def __init__(self, clock: ManualClock, _: Path, patch: pytest.MonkeyPatch) -> None:
        super().__init__(Device())
        gpiod, line = fake_gpiod(self.device)
        patch.setitem(sys.modules, "gpiod", gpiod)
        patch.setitem(sys.modules, "gpiod.line", line)
        block = GpioBlock(line=17, period_s=1.0)
        self.source: Source = gpio_source(clock, block.chip, {A: block, B: block})


class Systemd(_WithDevice):
    def __init__(self, clock: ManualClock, _: Path, patch: pytest.MonkeyPatch) -> None:
        super().__init__(Device())
        bus = fake_systemd_bus(self.device)
        patch.setitem(sys.modules, "service.sources.systemd_bus", bus)
        block = SystemdBlock(unit="robot.service", period_s=1.0)
        self.source: Source = systemd_source(clock, "system", {A: block, B: block})


class File:
    def __init__(self, clock: ManualClock, folder: Path, _: pytest.MonkeyPatch) -> None:
        self._file = folder / "temp1_input"
        block = FileBlock(path=str(self._file))
        self.source: Source = file_source(clock, block.path, {A: block, B: block})
        self.set(on=False)

    def set(self, *, on: bool) -> None:
        self._file.write_text(f"{on:d}\n")

    def set_there(self, *, there: bool) -> None:
        if there:
            self.set(on=False)
        else:
            self._file.unlink()


class Computer:
    """The pressure of the machine."""

    def __init__(self, clock: ManualClock, folder: Path, patch: pytest.MonkeyPatch) -> None:
        patch.setattr(machine, "_PRESSURE", folder)
        self._file = folder / "io"
        block = OsBlock(what="io_pressure_percent")
        self.source: Source
        (self.source,) = os_sources({A: block, B: block}, clock)
        self.set(on=False)

    def set(self, *, on: bool) -> None:
        self._file.write_text(f"some avg10={on:.2f} avg60=0.00 avg300=0.00 total=1\n")

    def set_there(self, *, there: bool) -> None:
        if there:
            self.set(on=False)
        else:
            self._file.unlink()


UNDER_TEST: list[Callable[[ManualClock, Path, pytest.MonkeyPatch], Thing]] = [
    Computer,
    File,
    Gpio,
    I2c,
    Spi,
    Systemd,
]
PERIOD_S = 1.0
DEADLINE_S = DEADLINE / 1e9
LONGEST_PAUSE_S = LONGEST_PAUSE / 1e9


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture(params=UNDER_TEST, ids=lambda made: made.__name__)
def thing(
    request: pytest.FixtureRequest,
    clock: ManualClock,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Thing:
    InlineThread.reset()
    monkeypatch.setattr("service.sources.sampled.CallThread", InlineThread)
    made: Thing = request.param(clock, tmp_path, monkeypatch)
    return made


@asynccontextmanager
async def running(source: Source) -> AsyncIterator[NotedSink]:
    """Run a source, and give what it says."""
    noted = NotedSink()
    task = asyncio.create_task(source.run(noted))
    try:
        yield noted
    finally:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


def test_it_opens_nothing_before_it_runs(thing: Thing) -> None:
    thing.set_there(there=False)

    assert thing.source.signals == (A, B)
    assert thing.source.name


async def test_it_reads_all_its_signals_at_once_and_then_in_their_period(
    thing: Thing, clock: ManualClock
) -> None:
    thing.set(on=True)
    async with running(thing.source) as sink:
        await clock.advance(0)
        assert sink.taken == [(A, 1), (B, 1)]

        thing.set(on=False)
        await clock.advance(PERIOD_S - 0.01)
        assert len(sink.taken) == 2
        await clock.advance(0.01)
        assert sink.taken[2:] == [(A, 0), (B, 0)]
        assert sink.failed == []


async def test_it_says_how_long_it_took(thing: Thing, clock: ManualClock) -> None:
    thing.set(on=True)
    async with running(thing.source) as sink:
        await clock.advance(0)

        assert all(duration >= 0 for duration in sink.durations)
        assert sink.durations


async def test_a_thing_that_is_not_there_is_the_reason_until_it_comes(
    thing: Thing, clock: ManualClock
) -> None:
    thing.set_there(there=False)
    async with running(thing.source) as sink:
        await clock.advance(60)
        assert sink.taken == []
        assert {signal for signal, _ in sink.failed} == {A, B}
        assert all(why for _, why in sink.failed)
        assert len(sink.failed) < 2 * 12, "it is tried ever less often"

        thing.set_there(there=True)
        await clock.advance(LONGEST_PAUSE_S)
        assert {signal for signal, _ in sink.taken} == {A, B}


async def test_a_thing_that_goes_and_comes_back_is_read_again(
    thing: Thing, clock: ManualClock
) -> None:
    async with running(thing.source) as sink:
        await clock.advance(0)
        thing.set_there(there=False)
        await clock.advance(PERIOD_S)
        assert {signal for signal, _ in sink.failed} == {A, B}

        thing.set_there(there=True)
        thing.set(on=True)
        await clock.advance(LONGEST_PAUSE_S)
        assert sink.taken[-2:] == [(A, 1), (B, 1)]


async def test_a_thing_that_hangs_is_told_while_that_lasts_and_asked_no_further(
    thing: Thing, clock: ManualClock
) -> None:
    async with running(thing.source) as sink:
        await clock.advance(0)
        sink.taken.clear()
        InlineThread.hangs = True
        await clock.advance(PERIOD_S + DEADLINE_S + 100)
        assert sink.taken == []
        assert sorted(set(sink.failed)) == [
            (A, "no answer within 1 s"),
            (B, "no answer for a within 1 s"),
        ]
        assert len(sink.failed) == 2 * 11
        assert len(InlineThread.waiting) == 1

        thing.set(on=True)
        InlineThread.go_on()
        await clock.advance(LONGEST_PAUSE_S)
        assert sink.taken[-2:] == [(A, 1), (B, 1)]


async def test_it_ends_at_once_also_while_the_thing_hangs(thing: Thing, clock: ManualClock) -> None:
    InlineThread.hangs = True
    running = asyncio.create_task(thing.source.run(NotedSink()))
    await clock.advance(60)

    running.cancel()
    with pytest.raises(asyncio.CancelledError):
        await running
    assert InlineThread.ended == 1
