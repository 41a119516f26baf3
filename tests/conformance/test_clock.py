"""What every clock must keep; the tests' own one is held to the same as the real one.

On a virtual clock nothing sleeps, so that it is held to all but that.
"""

import asyncio
from collections.abc import Coroutine
from datetime import UTC, datetime, timedelta, timezone

import pytest

from domain.errors import InvalidValueError
from domain.timebase import seconds
from service.clock import Clock, MonotonicClock
from service.virtual_clock import VirtualClock
from tests.support.manual_clock import START, ManualClock

MILLISECOND = seconds(0.001)


def virtual_clock() -> VirtualClock:
    return VirtualClock(seconds(50.0), START)


@pytest.fixture(params=[MonotonicClock, ManualClock, virtual_clock])
def clock(request: pytest.FixtureRequest) -> Clock:
    found: Clock = request.param()
    return found


@pytest.fixture(params=[MonotonicClock, ManualClock])
def sleeping_clock(request: pytest.FixtureRequest) -> Clock:
    """A clock that time passes on while somebody waits."""
    found: Clock = request.param()
    return found


async def wait_for(clock: Clock, *work: Coroutine[object, object, None]) -> None:
    """Let as much time pass as `work` needs."""
    waiting = asyncio.gather(*work)
    if isinstance(clock, ManualClock):
        await clock.advance(1.0)
    await waiting


async def test_time_goes_on_and_never_back(sleeping_clock: Clock) -> None:
    before = sleeping_clock.now()
    await wait_for(sleeping_clock, sleeping_clock.sleep_until(before + MILLISECOND))

    assert sleeping_clock.now() >= before + MILLISECOND


async def test_nobody_is_woken_early(sleeping_clock: Clock) -> None:
    woken_early = []

    async def sleep(until: int) -> None:
        await sleeping_clock.sleep_until(until)
        woken_early.append(sleeping_clock.now() < until)

    start = sleeping_clock.now()
    await wait_for(sleeping_clock, *(sleep(start + n * MILLISECOND // 10) for n in range(50)))

    assert woken_early == [False] * 50


async def test_sleepers_wake_in_the_order_of_their_deadlines(sleeping_clock: Clock) -> None:
    woken = []

    async def sleep(name: str, until: int) -> None:
        await sleeping_clock.sleep_until(until)
        woken.append(name)

    start = sleeping_clock.now()
    await wait_for(
        sleeping_clock,
        sleep("last", start + 30 * MILLISECOND),
        sleep("first", start + 10 * MILLISECOND),
        sleep("second", start + 20 * MILLISECOND),
    )

    assert woken == ["first", "second", "last"]


async def test_a_deadline_that_has_passed_lets_the_others_run_once(clock: Clock) -> None:
    other = asyncio.create_task(asyncio.sleep(0))
    await clock.sleep_until(clock.now() - MILLISECOND)
    await asyncio.sleep(0)

    assert other.done()


async def test_a_sleep_that_is_cancelled_ends_and_disturbs_no_other(sleeping_clock: Clock) -> None:
    start = sleeping_clock.now()
    given_up = asyncio.create_task(sleeping_clock.sleep_until(start + seconds(3600.0)))
    await asyncio.sleep(0)
    given_up.cancel()
    await asyncio.wait([given_up])
    await wait_for(sleeping_clock, sleeping_clock.sleep_until(start + MILLISECOND))

    assert given_up.cancelled()


def test_wall_time_is_utc(clock: Clock) -> None:
    assert clock.wall_time(clock.now()).tzinfo is UTC


def test_distances_in_wall_time_are_those_of_monotonic_time(clock: Clock) -> None:
    now = clock.now()
    shown = clock.wall_time(now + seconds(12.5)) - clock.wall_time(now)

    # Each is cut to a microsecond.
    assert abs(shown - timedelta(seconds=12.5)) <= timedelta(microseconds=1)


@pytest.mark.parametrize(
    "stamp",
    [
        datetime(2026, 5, 4, 12, 0, 0, 123456, tzinfo=UTC),
        datetime(2026, 5, 4, 14, 0, tzinfo=timezone(timedelta(hours=2))),
        datetime(1970, 1, 1, tzinfo=UTC),
    ],
)
def test_a_stamp_is_shown_as_the_moment_that_it_was(clock: Clock, stamp: datetime) -> None:
    assert clock.wall_time(clock.from_wall(stamp)) == stamp


def test_a_stamp_that_does_not_say_its_offset_is_refused(clock: Clock) -> None:
    with pytest.raises(InvalidValueError, match="offset from UTC"):
        clock.from_wall(datetime(2026, 5, 4, 12, 0))


@pytest.mark.parametrize(
    ("stamp", "shown"),
    [
        (datetime.max.replace(tzinfo=timezone(timedelta(hours=-12))), datetime.max),
        (datetime.min.replace(tzinfo=timezone(timedelta(hours=14))), datetime.min),
    ],
    ids=["the end of the calendar", "its beginning"],
)
def test_a_stamp_beyond_the_calendar_is_shown_as_its_end(
    clock: Clock, stamp: datetime, shown: datetime
) -> None:
    assert clock.wall_time(clock.from_wall(stamp)) == shown.replace(tzinfo=UTC)
