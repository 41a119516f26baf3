import asyncio
from datetime import timedelta

import pytest

from domain.timebase import seconds
from service.virtual_clock import VirtualClock
from tests.support.manual_clock import START, settle


def test_it_stands_until_it_is_set() -> None:
    clock = VirtualClock(seconds(50), START)
    assert clock.now() == seconds(50)

    clock.set(seconds(51.5))
    assert clock.now() == seconds(51.5)


def test_time_that_has_passed_does_not_come_back() -> None:
    clock = VirtualClock(seconds(50), START)
    clock.set(seconds(49))

    assert clock.now() == seconds(50)


def test_the_calendar_goes_on_with_it_from_what_it_said_at_the_start() -> None:
    clock = VirtualClock(seconds(50), START)
    clock.set(seconds(3650))

    assert clock.wall_time(seconds(50)) == START
    assert clock.wall_time(clock.now()) == START + timedelta(hours=1)
    assert clock.from_wall(START + timedelta(seconds=1)) == seconds(51)


@pytest.mark.parametrize("ahead", [1, seconds(3600)])
async def test_who_waits_for_what_is_to_come_waits_even_when_it_has_come(ahead: int) -> None:
    clock = VirtualClock(0, START)
    waiting = asyncio.create_task(clock.sleep_until(ahead))
    await settle()
    clock.set(ahead)
    await settle()
    assert not waiting.done()

    waiting.cancel()
    await asyncio.wait([waiting])
    assert waiting.cancelled()


@pytest.mark.parametrize("deadline", [0, seconds(50)])
async def test_who_waits_for_what_has_passed_does_not_wait(deadline: int) -> None:
    clock = VirtualClock(seconds(50), START)

    await asyncio.wait_for(clock.sleep_until(deadline), 5)
