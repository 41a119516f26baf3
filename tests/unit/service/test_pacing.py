import asyncio
import heapq
from collections.abc import Sequence

import pytest

from domain.timebase import Instant, seconds, to_seconds
from service.pacing import AT_ONCE, Alarm, Pacer
from tests.support.manual_clock import ManualClock, settle


class Alarms:
    """Rings at the times that were set, and counts how often it was advanced."""

    def __init__(self, *times_s: float) -> None:
        self._due = sorted(seconds(time_s) for time_s in times_s)
        self.advanced = 0

    def set(self, time_s: float) -> None:
        heapq.heappush(self._due, seconds(time_s))

    def advance(self, now: Instant) -> list[float]:
        self.advanced += 1
        rung = []
        while self._due and self._due[0] <= now:
            rung.append(to_seconds(heapq.heappop(self._due)))
        return rung

    def wake_at(self) -> Instant | None:
        return self._due[0] if self._due else None


class Paced:
    """Alarms that run on a clock, and when each was heard."""

    def __init__(self, *times_s: float) -> None:
        self.clock = ManualClock()
        self.alarms = Alarms(*times_s)
        self.pacer = Pacer(self.alarms, self.clock)
        self.heard: list[tuple[float, float]] = []
        self.sets_off: dict[float, float] = {}
        self.running = asyncio.create_task(self.pacer.run(self.hear), name="paced")

    def hear(self, alarm_s: float) -> None:
        self.heard.append((to_seconds(self.clock.now()), alarm_s))
        if alarm_s in self.sets_off:
            self.set(self.sets_off[alarm_s])

    def set(self, time_s: float) -> None:
        self.alarms.set(time_s)
        self.pacer.touch()

    async def stop(self) -> None:
        self.running.cancel()
        await asyncio.wait([self.running])


async def test_what_is_due_is_delivered_at_its_exact_time() -> None:
    paced = Paced(0.0, 0.1, 0.1, 7.3)
    await paced.clock.advance(10.0)
    await paced.stop()

    assert paced.heard == [(0.0, 0.0), (0.1, 0.1), (0.1, 0.1), (7.3, 7.3)]


async def test_it_sleeps_between_what_is_due() -> None:
    paced = Paced(1.0, 2.0, 3.0)
    await paced.clock.advance(10.0)
    await paced.stop()

    assert paced.alarms.advanced == 4


async def test_something_handed_in_that_is_due_earlier_is_delivered_in_its_time() -> None:
    paced = Paced(5.0)
    await paced.clock.advance(1.0)
    paced.set(2.0)
    await paced.clock.advance(10.0)
    await paced.stop()

    assert paced.heard == [(2.0, 2.0), (5.0, 5.0)]


async def test_something_handed_in_that_is_due_now_is_delivered_without_time_passing() -> None:
    paced = Paced(5.0)
    await paced.clock.advance(1.0)
    paced.set(1.0)
    await settle()
    await paced.stop()

    assert paced.heard == [(1.0, 1.0)]


async def test_an_object_that_wants_nothing_is_left_alone_until_something_is_handed_in() -> None:
    paced = Paced()
    await paced.clock.advance(3600.0)
    paced.set(3600.0)
    await settle()
    await paced.stop()

    assert paced.heard == [(3600.0, 3600.0)]
    assert paced.alarms.advanced == 2


async def test_what_is_handed_in_while_something_is_delivered_is_not_lost() -> None:
    paced = Paced(1.0, 9.0)
    paced.sets_off = {1.0: 0.5, 0.5: 2.0}
    await paced.clock.advance(5.0)
    await paced.stop()

    assert paced.heard == [(1.0, 1.0), (1.0, 0.5), (2.0, 2.0)]


async def test_many_things_handed_in_at_once_wake_it_once() -> None:
    paced = Paced()
    await settle()
    for _ in range(1000):
        paced.set(0.0)
    await settle()
    await paced.stop()

    assert len(paced.heard) == 1000
    assert paced.alarms.advanced == 2


async def test_very_many_things_that_are_due_together_are_delivered_by_who_can_do_that() -> None:
    one, many = list[float](), list[tuple[int, Instant]]()

    async def take(due: Sequence[float], delivered: Instant) -> None:
        many.append((len(due), delivered))

    clock = ManualClock()
    pacer = Pacer(Alarms(1.0, *[2.0] * (AT_ONCE + 1), *[3.0] * AT_ONCE), clock)
    running = asyncio.create_task(pacer.run(one.append, take))
    await clock.advance(3.0)
    running.cancel()
    await asyncio.wait([running])

    assert many == [(AT_ONCE + 1, seconds(1.0))], "all that was due up to 1 s was delivered before"
    assert len(one) == 1 + AT_ONCE


async def test_what_the_listener_raises_ends_it() -> None:
    paced = Paced(1.0)

    def fail(alarm_s: float) -> None:
        raise LookupError(alarm_s)

    failing = asyncio.create_task(paced.pacer.run(fail))
    await paced.stop()
    await paced.clock.advance(1.0)

    with pytest.raises(LookupError):
        failing.result()


@pytest.mark.parametrize("times_s", [(), (5.0,)], ids=["wanting nothing", "asleep"])
async def test_cancelling_it_ends_it_at_once_and_leaves_no_task(times_s: tuple[float, ...]) -> None:
    before = asyncio.all_tasks()
    paced = Paced(*times_s)
    await paced.clock.advance(1.0)
    await paced.stop()

    assert paced.running.cancelled()
    assert asyncio.all_tasks() == before


async def test_touching_it_when_it_does_not_run_does_no_harm() -> None:
    paced = Paced()
    await paced.stop()

    paced.pacer.touch()


async def test_a_clock_that_breaks_ends_it() -> None:
    class BrokenClock(ManualClock):
        async def sleep_until(self, deadline: Instant) -> None:
            raise OSError("no timer")

    with pytest.raises(OSError, match="no timer"):
        await Pacer(Alarms(1.0), BrokenClock()).run(lambda _: None)


# --- alarms --------------------------------------------------------------------------------------


class Bell:
    """Something that is due at one time, which moves, and an alarm that rings it."""

    def __init__(self, due_s: float | None = None, *, every_s: float | None = None) -> None:
        self.clock = ManualClock()
        self._every_s = every_s
        self._due = None if due_s is None else seconds(due_s)
        self.looked = 0
        self.rung: list[float] = []
        self.alarm = Alarm(self._when, self._ring, self.clock)
        self.running = asyncio.create_task(self.alarm.run(), name="alarm")

    def move(self, due_s: float | None) -> None:
        self._due = None if due_s is None else seconds(due_s)
        self.alarm.check()

    async def stop(self) -> None:
        self.running.cancel()
        await asyncio.wait([self.running])

    def _when(self) -> Instant | None:
        self.looked += 1
        return self._due

    def _ring(self) -> None:
        self.rung.append(to_seconds(self.clock.now()))
        self._due = None
        if self._every_s is not None:
            self._due = self.clock.now() + seconds(self._every_s)


async def test_an_alarm_rings_once_and_exactly_when_it_is_due() -> None:
    bell = Bell(0.123456789)
    await bell.clock.advance(10.0)
    await bell.stop()

    assert bell.rung == [0.123456789]


async def test_an_alarm_rings_as_often_as_something_is_due() -> None:
    bell = Bell(0.0, every_s=0.25)
    await bell.clock.advance(1.0)
    await bell.stop()

    assert bell.rung == [0.0, 0.25, 0.5, 0.75, 1.0]


async def test_an_alarm_that_is_due_earlier_now_rings_earlier() -> None:
    bell = Bell(5.0)
    await bell.clock.advance(1.0)
    bell.move(2.0)
    await bell.clock.advance(10.0)
    await bell.stop()

    assert bell.rung == [2.0]


async def test_an_alarm_that_is_due_later_now_rings_later_and_not_before() -> None:
    bell = Bell(2.0)
    await bell.clock.advance(1.0)
    bell.move(5.0)
    await bell.clock.advance(10.0)
    await bell.stop()

    assert bell.rung == [5.0]


async def test_an_alarm_that_is_not_due_any_more_does_not_ring() -> None:
    bell = Bell(2.0)
    await bell.clock.advance(1.0)
    bell.move(None)
    await bell.clock.advance(10.0)
    await bell.stop()

    assert bell.rung == []


async def test_an_alarm_that_was_not_due_at_all_rings_once_it_is() -> None:
    bell = Bell()
    await bell.clock.advance(3600.0)
    bell.move(3601.5)
    await bell.clock.advance(10.0)
    await bell.stop()

    assert bell.rung == [3601.5]


async def test_an_alarm_that_is_due_now_rings_without_time_passing() -> None:
    bell = Bell(5.0)
    await bell.clock.advance(1.0)
    bell.move(1.0)
    await settle()
    await bell.stop()

    assert bell.rung == [1.0]


async def test_a_moment_that_was_missed_is_rung_late_and_once() -> None:
    bell = Bell(1.0)
    await settle()
    bell.clock.stall(3.0)
    await bell.clock.advance(1.0)
    await bell.stop()

    assert bell.rung == [3.0]


async def test_checking_an_alarm_that_need_not_ring_earlier_does_not_wake_it() -> None:
    bell = Bell(5.0)
    await bell.clock.advance(1.0)
    before = bell.looked
    for _ in range(1000):
        bell.alarm.check()
    await settle()
    await bell.stop()

    assert bell.looked == before + 1000


async def test_what_an_alarm_rings_may_check_it() -> None:
    bell = Bell(1.0)
    again = [2.0, 3.0]

    def ring() -> None:
        bell.rung.append(to_seconds(bell.clock.now()))
        bell.move(again.pop(0) if again else None)

    await bell.stop()
    bell.alarm = Alarm(bell._when, ring, bell.clock)  # noqa: SLF001  # its own bell
    bell.running = asyncio.create_task(bell.alarm.run(), name="alarm")
    await bell.clock.advance(10.0)
    await bell.stop()

    assert bell.rung == [1.0, 2.0, 3.0]


async def test_an_alarm_that_is_checked_before_it_runs_does_no_harm() -> None:
    bell = Bell(1.0)
    bell.alarm.check()
    await bell.clock.advance(2.0)
    await bell.stop()

    assert bell.rung == [1.0]


async def test_what_ringing_raises_ends_the_alarm() -> None:
    clock = ManualClock()

    def fail() -> None:
        raise LookupError

    with pytest.raises(LookupError):
        await Alarm(lambda: 0, fail, clock).run()


async def test_cancelling_an_alarm_ends_it_at_once_and_leaves_no_task() -> None:
    before = asyncio.all_tasks()
    bell = Bell(5.0)
    await bell.clock.advance(1.0)
    await bell.stop()

    assert bell.running.cancelled()
    assert asyncio.all_tasks() == before
