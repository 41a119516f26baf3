import time
from dataclasses import dataclass, field
from datetime import UTC, datetime

import pytest

from domain.errors import InvalidValueError
from domain.timebase import seconds
from service.clock import MonotonicClock, continuous_clock, since_epoch, to_datetime

NOON = datetime(2026, 5, 4, 12, tzinfo=UTC)


@dataclass
class Machine:
    """A machine whose clocks a test sets."""

    monotonic: int = seconds(1000.0)
    wall: int = since_epoch(NOON)
    pauses: list[int] = field(default_factory=list)
    """How long it is busy with something else each time that the wall clock has been read."""

    def read_monotonic(self) -> int:
        return self.monotonic

    def read_wall(self) -> int:
        wall = self.wall
        if self.pauses:
            self.pass_time(self.pauses.pop(0))
        return wall

    def pass_time(self, duration: int) -> None:
        self.monotonic += duration
        self.wall += duration

    def clock(self) -> MonotonicClock:
        return MonotonicClock(self.read_monotonic, self.read_wall)


def test_what_happened_is_shown_at_the_time_of_the_system_clock() -> None:
    machine = Machine()
    clock = machine.clock()

    assert clock.wall_time(clock.now()) == NOON
    assert clock.from_wall(NOON) == clock.now()


def test_a_step_of_the_system_clock_shows_within_a_second_also_for_what_was_before_it() -> None:
    machine = Machine()
    clock = machine.clock()
    before = clock.now()
    machine.wall += seconds(3600.0)
    machine.pass_time(seconds(1.0))

    assert clock.wall_time(before) == NOON.replace(hour=13)
    assert clock.now() - before == seconds(1.0)


def test_a_stamp_is_moved_to_our_clock_by_the_system_clock_as_it_is_now() -> None:
    machine = Machine()
    clock = machine.clock()
    machine.wall -= seconds(3600.0)
    machine.pass_time(seconds(1.0))

    assert clock.from_wall(to_datetime(machine.wall)) == clock.now()


def test_the_noise_of_two_clocks_does_not_move_what_was_shown() -> None:
    machine = Machine()
    clock = machine.clock()
    before = clock.now()
    shown = set()
    for noise in (0.004, -0.009, 0.005, 0.003):
        machine.wall += seconds(noise)
        machine.pass_time(seconds(1.0))
        shown.add(clock.wall_time(before))

    assert shown == {NOON}


def test_a_process_that_is_put_aside_while_it_measures_sees_no_step() -> None:
    machine = Machine()
    clock = machine.clock()
    before = clock.now()
    machine.pass_time(seconds(1.0))
    machine.pauses = [seconds(2.0), 0, seconds(4.0)]

    assert clock.wall_time(before) == NOON


async def test_a_timer_that_fires_early_is_set_again() -> None:
    # A clock of half the speed: to it, every timer of the loop fires when half the time is over.
    clock = MonotonicClock(lambda: time.monotonic_ns() // 2)
    deadline = clock.now() + seconds(0.004)
    await clock.sleep_until(deadline)

    assert clock.now() >= deadline


@pytest.mark.parametrize(("nanoseconds", "year"), [(-(10**21), 1), (10**21, 9999)])
def test_a_time_that_no_calendar_holds_is_cut(nanoseconds: int, year: int) -> None:
    assert to_datetime(nanoseconds).year == year


def test_a_moment_is_exact_to_the_microsecond() -> None:
    moment = datetime(2026, 5, 4, 12, 0, 0, 123457, tzinfo=UTC)

    assert to_datetime(since_epoch(moment)) == moment
    assert since_epoch(moment) % seconds(1.0) == 123_457_000


def test_a_moment_of_no_known_offset_is_refused() -> None:
    with pytest.raises(InvalidValueError):
        since_epoch(datetime(2026, 5, 4))


def test_instants_of_a_later_run_are_after_those_of_an_earlier_one() -> None:
    first = continuous_clock().now()
    assert continuous_clock().now() > first
    assert abs(first - time.time_ns()) < 60 * 10**9
