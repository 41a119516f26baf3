"""Frames in virtual time: the tick publishes, and an error is published at once."""

import logging
from collections.abc import AsyncIterator

import pytest

from domain.inputs import ModeRequest, Reading
from domain.snapshot import SystemState
from domain.timebase import seconds
from service.frame_feed import PARTS_AT_ONCE, Frame
from service.supervisor import Supervisor
from tests.support.big_model import FAST, big_model
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.models import ACTUATION, BASE
from tests.support.robot_with_devices import ARM_COMPUTER, BASE_COMPUTER, device_robot, status


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def supervisor(clock: ManualClock) -> AsyncIterator[Supervisor]:
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        yield supervisor


class Recorded:
    """Every frame that a supervisor publishes."""

    def __init__(self, supervisor: Supervisor) -> None:
        self.frames: list[Frame] = []
        self._supervisor = supervisor

    def __call__(self) -> None:
        newest = self._supervisor.frames.newest
        assert newest is not None
        self.frames.append(newest)


async def test_ten_seconds_are_200_frames_without_a_gap(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    recorded = Recorded(supervisor)
    first = supervisor.publisher.seq
    with supervisor.frames.watch(recorded):
        await clock.advance(10)
    assert [f.seq for f in recorded.frames] == list(range(first + 1, first + 201))
    assert supervisor.publisher.late_ticks == 0


async def test_the_first_frame_is_complete_and_later_ones_hold_changes(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    first = supervisor.frames.newest
    assert first is not None
    assert set(first.parts) == set(supervisor.model.parts)
    recorded = Recorded(supervisor)
    with supervisor.frames.watch(recorded):
        await clock.advance(3)
    assert not any(frame.full or frame.parts for frame in recorded.frames)


async def test_a_frame_in_between_holds_what_changed_and_nothing_else(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    await clock.advance(0.31)
    recorded = Recorded(supervisor)
    with supervisor.frames.watch(recorded):
        supervisor.submit(ModeRequest(BASE, "FAST"))
        await clock.advance(0.05)
    (frame,) = recorded.frames
    assert set(frame.parts) == {BASE, ACTUATION}


async def test_an_error_is_published_at_once_and_not_at_the_next_tick(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    await clock.advance(0.01)
    before = supervisor.publisher.seq
    supervisor.readings.submit([Reading("estop", value=True)])
    newest = supervisor.frames.newest
    assert newest is not None
    assert newest.seq == before + 1
    assert newest.system_state.state is SystemState.ERROR


async def test_the_first_frame_of_a_robot_with_the_mock_is_idle(supervisor: Supervisor) -> None:
    newest = supervisor.frames.newest
    assert newest is not None
    assert (newest.system_state.state, newest.full) == (SystemState.IDLE, True)


async def test_changing_reasons_make_no_more_frames_and_errors_do(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    supervisor.readings.submit([Reading("temperature", 60.0)])
    recorded = Recorded(supervisor)
    with supervisor.frames.watch(recorded):
        for number in range(80):
            supervisor.readings.submit([Reading("temperature", 60.0 + number)])
            await clock.advance(0.0125)
    assert len(recorded.frames) == 20


async def test_a_late_tick_is_skipped_counted_and_not_made_up_for(
    clock: ManualClock, supervisor: Supervisor, caplog: pytest.LogCaptureFixture
) -> None:
    periods: list[float] = []
    supervisor.publisher.on_tick.append(periods.append)
    before = supervisor.publisher.seq
    clock.stall(0.32)
    with caplog.at_level(logging.WARNING):
        await clock.advance(0)
    assert supervisor.publisher.late_ticks == 5
    assert supervisor.publisher.seq == before + 1
    await clock.advance(0.03)
    assert periods == pytest.approx([0.32, 0.03])


async def test_the_parts_of_a_large_robot_are_told_in_several_frames_in_the_order_of_change() -> (
    None
):
    clock = ManualClock()
    supervisor = make_supervisor(clock, model=big_model(2 * PARTS_AT_ONCE))
    async with running(supervisor):
        await clock.advance(1)
        recorded = Recorded(supervisor)
        with supervisor.frames.watch(recorded):
            supervisor.submit(ModeRequest(supervisor.model.parts[0], FAST))
            await clock.advance(3)
    told = [part for f in recorded.frames if not f.full for part in f.parts]
    assert set(told) == set(supervisor.model.parts)
    assert all(len(f.parts) <= PARTS_AT_ONCE for f in recorded.frames if not f.full)
    newest = supervisor.frames.complete()
    assert newest is not None
    assert newest.parts == supervisor.core.parts()


async def test_a_value_that_stays_is_told_twice_a_second_and_one_that_changes_at_once(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    """The mock repeats its values at 10 Hz."""
    await clock.advance(2)
    recorded = Recorded(supervisor)
    with supervisor.frames.watch(recorded):
        await clock.advance(3)
        repeats = [f for f in recorded.frames if "temperature" in f.signals]
        assert 5 <= len(repeats) <= 8
        supervisor.readings.submit([Reading("temperature", 31.0)])
        await clock.advance(0.05)
    assert recorded.frames[-1].signals["temperature"].value == 31.0
    await clock.advance(0.5)
    newest = supervisor.frames.complete()
    assert newest is not None
    held, now = newest.signals["temperature"], supervisor.core.signal("temperature")
    assert held.received_at is not None
    assert now.received_at is not None
    assert now.received_at - held.received_at <= seconds(0.6)


async def test_devices_are_in_the_first_frame_and_then_in_those_after_a_change() -> None:
    async with device_robot() as (robot, _):
        first = robot.supervisor.frames.newest
        assert first is not None
        assert list(first.devices) == [BASE_COMPUTER, ARM_COMPUTER]
        recorded = Recorded(robot.supervisor)
        with robot.supervisor.frames.watch(recorded):
            await robot.pass_time(0.1)
            robot.supervisor.submit(status(ARM_COMPUTER))
            await robot.pass_time(0.1)

    told = [list(frame.devices) for frame in recorded.frames]
    assert [names for names in told if names] == [[ARM_COMPUTER]]
