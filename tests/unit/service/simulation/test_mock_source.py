import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.errors import InvalidValueError
from domain.inputs import Reading, Readings, SignalValue
from domain.simulation.mock_signals import MOCK_SOURCE, MockSignals
from domain.simulation.robot import SimulatedRobot
from domain.timebase import seconds, to_seconds
from service.ports import BackendMessage
from service.simulation.mock_source import MockHandle, MockSource
from service.simulation.simulated import SimulatedBackend
from service.supervisor import Supervisor
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock, settle
from tests.support.models import actuation_model


def backend_of(clock: ManualClock) -> SimulatedBackend:
    """Return a simulated robot with mock signals, on a clock."""
    return SimulatedBackend(SimulatedRobot(actuation_model(), clock.now(), mock=True), clock)


def mock_of(backend: SimulatedBackend) -> MockHandle:
    """Return what can be done to the mock signals of a robot."""
    assert backend.mock is not None
    return backend.mock


class Listening:
    """The mock of a robot that runs on a clock, and what was heard of it, when."""

    def __init__(self) -> None:
        self.clock = ManualClock(start=seconds(50.0))
        self.backend = backend_of(self.clock)
        self.source = mock_of(self.backend)
        self.heard: list[tuple[float, dict[str, SignalValue]]] = []

    def hear(self, message: BackendMessage) -> None:
        if isinstance(message, Readings):
            assert message.source == self.source.source
            at = to_seconds(self.clock.now() - seconds(50.0))
            self.heard.append((at, {reading.signal: reading.value for reading in message.items}))


@pytest.fixture
async def listening() -> AsyncIterator[Listening]:
    listening = Listening()
    run = asyncio.create_task(listening.backend.run(listening.hear))
    await settle()
    yield listening
    run.cancel()
    await asyncio.wait([run])


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
    listening = Listening()
    (due,) = listening.source.due()
    run = asyncio.create_task(listening.backend.run(listening.hear))
    await listening.clock.advance(0.05)

    assert len(due.items) == 5
    assert listening.heard == []

    await listening.clock.advance(0.05)
    assert listening.heard == [(0.1, {reading.signal: reading.value for reading in due.items})]
    run.cancel()
    await asyncio.wait([run])


# --- readings from outside ------------------------------------------------------------------------


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def supervisor(clock: ManualClock) -> AsyncIterator[Supervisor]:
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        yield supervisor


async def test_a_posted_reading_is_what_the_mock_goes_on_with(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    supervisor.readings.submit([Reading("battery_level", 0.4)])
    await clock.advance(5)
    assert supervisor.core.signal("battery_level").value == 0.4
    assert supervisor.core.system_state().errors == ("BATTERY_LOW",)


async def test_a_named_source_of_estop_is_kept_apart_from_the_mock_and_from_others(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    supervisor.readings.submit([Reading("estop", value=True)], source="panel")
    supervisor.readings.submit([Reading("estop", value=False)], source="remote")
    supervisor.readings.submit([Reading("estop", value=False)])
    await clock.advance(1)
    assert supervisor.core.system_state().errors == ("ESTOP",)
    supervisor.readings.submit([Reading("estop", value=False)], source="panel")
    await clock.advance(1)
    assert supervisor.core.system_state().errors == ()


async def test_a_refused_reading_leaves_the_mock_as_it_was(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    with pytest.raises(InvalidValueError):
        supervisor.readings.submit([Reading("battery_level", 0.4), Reading("temperature", "hot")])
    await clock.advance(1)
    assert supervisor.core.signal("battery_level").value == 1.0


async def test_an_older_value_of_the_mock_never_follows_a_posted_one(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    """The mock is due, and has not had its turn, when the reading arrives."""
    await clock.advance(0.095)
    clock.stall(0.01)
    supervisor.readings.submit([Reading("estop", value=True)])
    values = [
        event.data["values"]
        for event in supervisor.events.oldest_first()
        if event.kind == "signal.read"
    ]
    await clock.advance(0)
    assert values[-1] == {"estop": True}
    assert supervisor.core.signal("estop").value is True


async def test_it_runs_on_its_own_beside_other_adapters() -> None:
    clock = ManualClock()
    source = MockSource(MockSignals(clock.now()), clock)
    heard: list[Readings] = []
    run = asyncio.create_task(source.run(heard.append))
    await clock.advance(0.35)
    source.hold("temperature", 60.0)
    await settle()
    run.cancel()
    await asyncio.wait([run])

    assert {message.source for message in heard} == {MOCK_SOURCE}
    assert [len(message.items) for message in heard] == [5, 5, 5, 5, 1]
