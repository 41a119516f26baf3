import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.messages import Readings, SignalValue
from domain.simulation.mock_signals import MockSignals
from domain.timebase import seconds, to_seconds
from service.mock_source import MockSource
from service.ports import SignalSource
from tests.support.manual_clock import ManualClock, settle


class Listening:
    """A mock source that runs on a clock, and what was heard of it, when."""

    def __init__(self) -> None:
        self.clock = ManualClock(start=seconds(50.0))
        self.source = MockSource(MockSignals(self.clock.now()), self.clock)
        self.heard: list[tuple[float, dict[str, SignalValue]]] = []

    def hear(self, readings: Readings) -> None:
        assert readings.source == self.source.source
        at = to_seconds(self.clock.now() - seconds(50.0))
        self.heard.append((at, {reading.signal: reading.value for reading in readings.items}))


@pytest.fixture
async def listening() -> AsyncIterator[Listening]:
    listening = Listening()
    source: SignalSource = listening.source
    running = asyncio.create_task(source.run(listening.hear))
    await settle()
    yield listening
    running.cancel()
    await asyncio.wait([running])


async def test_all_signals_are_there_before_any_time_passes(listening: Listening) -> None:
    ((at, values),) = listening.heard

    assert (at, len(values)) == (0.0, 5)


async def test_ten_readings_a_second_come_for_as_long_as_it_runs(listening: Listening) -> None:
    await listening.clock.advance(60.0)

    assert [at for at, _ in listening.heard] == [n / 10 for n in range(601)]


async def test_a_held_value_is_heard_without_waiting(listening: Listening) -> None:
    await listening.clock.advance(0.03)
    listening.source.hold("estop", True)
    await settle()

    assert listening.heard[-1] == (0.03, {"estop": True})


async def test_a_signal_can_be_stopped_and_taken_up_again(listening: Listening) -> None:
    listening.source.set_publishing("temperature", False)
    await listening.clock.advance(1.0)
    assert "temperature" not in listening.heard[-1][1]

    listening.source.set_publishing("temperature", True)
    await settle()

    assert listening.heard[-1] == (1.0, {"temperature": 30.0})


def test_it_shows_what_it_holds() -> None:
    source = Listening().source
    source.hold("battery_level", 0.42)
    held = {signal.signal: signal.value for signal in source.view()}

    assert held["battery_level"] == 0.42
    assert source.holds("battery_level")
    assert not source.holds("wind_speed")


async def test_what_is_due_can_be_taken_first_and_is_not_delivered_again() -> None:
    clock = ManualClock()
    source = MockSource(MockSignals(clock.now()), clock)
    (due,) = source.due()
    heard: list[Readings] = []
    running = asyncio.create_task(source.run(heard.append))
    await clock.advance(0.05)

    assert len(due.items) == 5
    assert heard == []

    await clock.advance(0.05)
    assert heard == [due]
    running.cancel()
    await asyncio.wait([running])
