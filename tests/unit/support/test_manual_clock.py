import asyncio
from datetime import timedelta

import pytest

from domain.timebase import seconds
from tests.support.manual_clock import ManualClock, settle


async def test_a_loop_of_many_steps_runs_through_in_one_advance_exactly() -> None:
    clock = ManualClock(start=seconds(3.0))
    ticks = []

    async def tick() -> None:
        for n in range(1, 201):
            await clock.sleep_until(seconds(3.0) + n * seconds(0.05))
            ticks.append(clock.now())

    ticking = asyncio.create_task(tick())
    await clock.advance(9.99)
    assert len(ticks) == 199
    await clock.advance(0.01)

    assert ticks == [seconds(3.0) + n * seconds(0.05) for n in range(1, 201)]
    assert ticking.done()


async def test_what_a_sleeper_sets_off_is_over_before_time_goes_on() -> None:
    clock = ManualClock()
    seen = []

    async def chain(length: int) -> None:
        for _ in range(length):
            await asyncio.sleep(0)
        seen.append(clock.now())

    async def set_off() -> None:
        await clock.sleep_until(seconds(1.0))
        await asyncio.create_task(chain(50))

    setting_off = asyncio.create_task(set_off())
    await clock.advance(5.0)

    assert seen == [seconds(1.0)]
    assert setting_off.done()


async def test_a_sleeper_that_gave_up_is_not_waited_for() -> None:
    clock = ManualClock()
    asleep = asyncio.create_task(clock.sleep_until(seconds(1.0)))
    await settle()
    asleep.cancel()
    await clock.advance(5.0)

    assert clock.now() == seconds(5.0)


async def test_setting_the_calendar_leaves_the_time_alone() -> None:
    clock = ManualClock()
    shown = clock.wall_time(0)
    clock.step_wall_time(3600.0)

    assert clock.wall_time(0) - shown == timedelta(hours=1)
    assert clock.now() == 0


async def test_a_task_that_spins_is_told_instead_of_hanging_the_test(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("tests.support.manual_clock._MANY_TURNS", 100)

    async def spin() -> None:
        loop = asyncio.get_running_loop()
        while True:
            turn = loop.create_future()
            loop.call_soon(turn.set_result, None)
            await turn

    spinning = asyncio.create_task(spin())
    with pytest.raises(AssertionError, match="one of them spins"):
        await settle()
    spinning.cancel()
