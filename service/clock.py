"""Clocks are passed in, so that tests need not wait.

All decisions use monotonic time, which never jumps. Wall time is used only for display and for the
time stamps of senders.
"""

import asyncio
import time
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from typing import Protocol

from domain.errors import InvalidValueError
from domain.timebase import Duration, Instant, seconds, to_seconds

EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_EARLIEST = datetime.min.replace(tzinfo=UTC)
_LATEST = datetime.max.replace(tzinfo=UTC)


class Clock(Protocol):
    """Monotonic time, a way to wait for it, and its conversion to UTC.

    `tests/conformance/test_clock.py` specifies what every clock must do.
    """

    def now(self) -> Instant:
        """Return monotonic time; it never decreases."""
        ...

    def wall_time(self, instant: Instant) -> datetime:
        """Return `instant` as UTC for display, limited to the years 1 to 9999."""
        ...

    def from_wall(self, moment: datetime) -> Instant:
        """Convert a sender's time stamp to this clock; the inverse of `wall_time`.

        Raises:
            InvalidValueError: `moment` has no offset from UTC.
        """
        ...

    async def sleep_until(self, deadline: Instant) -> None:
        """Return when `now()` is `deadline` or later; let other tasks run at least once."""
        ...


class MonotonicClock:
    """The clock of this machine.

    Wall time is monotonic time plus an offset, which is measured at the start and then at most once
    a second, when wall time is needed. The offset is replaced only if it has changed by more than
    10 ms, which means that the system clock was stepped: Linux slews both clocks alike. Smaller
    differences are the noise of reading two clocks; following them would make an instant that is
    shown twice differ by a millisecond. After a step the new offset applies to all instants, also
    to earlier ones: intervals stay correct, and a robot that started with a wrong date shows
    correct times as soon as its clock is set.

    Args:
        read_monotonic: Nanoseconds that never decrease.
        read_wall: Nanoseconds since 1970-01-01 UTC.
    """

    def __init__(
        self,
        read_monotonic: Callable[[], int] = time.monotonic_ns,
        read_wall: Callable[[], int] = time.time_ns,
    ) -> None:
        self._read_monotonic = read_monotonic
        self._read_wall = read_wall
        self._offset, self._measured_at = self._measure()

    def now(self) -> Instant:
        """Return monotonic time."""
        return self._read_monotonic()

    def wall_time(self, instant: Instant) -> datetime:
        """Return `instant` as UTC, by the current setting of the system clock."""
        return to_datetime(instant + self._current_offset())

    def from_wall(self, moment: datetime) -> Instant:
        """Return `moment` as an instant, by the current setting of the system clock."""
        return since_epoch(moment) - self._current_offset()

    async def sleep_until(self, deadline: Instant) -> None:
        """Sleep on the event loop."""
        delay = max(0, deadline - self.now())
        while True:
            await asyncio.sleep(to_seconds(delay))
            remaining = deadline - self.now()
            if remaining <= 0:
                return
            # uvloop counts in whole milliseconds: about half of its timers fire early.
            delay = max(remaining, _TIMER_RESOLUTION)

    def _current_offset(self) -> Duration:
        if self._read_monotonic() - self._measured_at >= _MEASURED_EVERY:
            offset, self._measured_at = self._measure()
            if abs(offset - self._offset) > _LEAST_STEP:
                self._offset = offset
        return self._offset

    def _measure(self) -> tuple[Duration, Instant]:
        """Return wall time minus monotonic time, and when that was.

        The fastest of several tries is used: a process that is suspended between the two readings
        would otherwise see a step.
        """
        tries = []
        for _ in range(_TRIES):
            before = self._read_monotonic()
            wall = self._read_wall()
            after = self._read_monotonic()
            tries.append((after - before, wall - (before + after) // 2, after))
        _, offset, at = min(tries)
        return offset, at


def continuous_clock() -> MonotonicClock:
    """Return a clock of this machine whose instants go on over restarts.

    They begin at the wall time of now, in nanoseconds since 1970, and are monotonic from there: a
    system clock that is stepped later does not move them. So what was written down before a restart
    and after it can be compared, as far as the system clock was right at both starts.
    """
    ahead = time.time_ns() - time.monotonic_ns()
    return MonotonicClock(lambda: time.monotonic_ns() + ahead)


_MEASURED_EVERY = seconds(1.0)
_LEAST_STEP = seconds(0.01)
_TIMER_RESOLUTION = seconds(0.001)
_TRIES = 3


def to_datetime(nanoseconds: int) -> datetime:
    """Return nanoseconds since the epoch as UTC, with microseconds.

    Values beyond the range of datetime are clamped to it.
    """
    microseconds = nanoseconds // _PER_MICROSECOND
    if microseconds <= _EARLIEST_MICROSECOND:
        return _EARLIEST
    if microseconds >= _LATEST_MICROSECOND:
        return _LATEST
    return EPOCH + timedelta(microseconds=microseconds)


def since_epoch(moment: datetime) -> int:
    """Return a moment as nanoseconds since the epoch.

    Raises:
        InvalidValueError: `moment` has no offset from UTC.
    """
    if moment.utcoffset() is None:
        raise InvalidValueError("a time needs an offset from UTC, as in 2026-05-04T12:00:00Z")
    return (moment - EPOCH) // timedelta(microseconds=1) * _PER_MICROSECOND


_PER_MICROSECOND = 1_000
_EARLIEST_MICROSECOND = (_EARLIEST - EPOCH) // timedelta(microseconds=1)
_LATEST_MICROSECOND = (_LATEST - EPOCH) // timedelta(microseconds=1)
