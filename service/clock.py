"""Time as something that is handed in, so that tests need not wait for it.

Everything is decided by monotonic time alone, which never jumps. Wall time is only for showing, and
for what senders say.
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
    """Monotonic time, a way to wait for it, and what a calendar makes of it.

    `tests/conformance/test_clock.py` says what each must keep.
    """

    def now(self) -> Instant:
        """Return monotonic time; it never falls."""
        ...

    def wall_time(self, instant: Instant) -> datetime:
        """Return `instant` as UTC, to be shown; cut to the years 1 to 9999."""
        ...

    def from_wall(self, moment: datetime) -> Instant:
        """Return when a sender's stamp was, on this clock; the reverse of `wall_time`.

        Raises:
            InvalidValueError: `moment` has no offset from UTC.
        """
        ...

    async def sleep_until(self, deadline: Instant) -> None:
        """Return once `now()` is `deadline` or later; let other tasks run at least once."""
        ...


class MonotonicClock:
    """The clock of this machine.

    Wall time is monotonic time plus one offset, which is measured at the start and once a second
    while it is asked for. It is replaced only when the clocks are 10 ms further apart, and that is
    when the system clock was stepped, since Linux slews both alike. Anything smaller is the noise
    of reading two clocks, and would let an instant that is shown twice differ by a millisecond.
    After a step all instants, also older ones, are shown by the new offset: their distances stay
    true, and a robot that was started with a wrong date is right from when it gets the time.

    Args:
        read_monotonic: Nanoseconds that never fall.
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
        """Return `instant` as UTC by what the system clock says now."""
        return to_datetime(instant + self._current_offset())

    def from_wall(self, moment: datetime) -> Instant:
        """Return when `moment` was by what the system clock says now."""
        return since_epoch(moment) - self._current_offset()

    async def sleep_until(self, deadline: Instant) -> None:
        """Sleep on the event loop."""
        delay = max(0, deadline - self.now())
        while True:
            await asyncio.sleep(to_seconds(delay))
            remaining = deadline - self.now()
            if remaining <= 0:
                return
            # uvloop counts in whole milliseconds: about every second of its timers fires early.
            delay = max(remaining, _TIMER_RESOLUTION)

    def _current_offset(self) -> Duration:
        if self._read_monotonic() - self._measured_at >= _MEASURED_EVERY:
            offset, self._measured_at = self._measure()
            if abs(offset - self._offset) > _LEAST_STEP:
                self._offset = offset
        return self._offset

    def _measure(self) -> tuple[Duration, Instant]:
        """Return wall time minus monotonic time, and when that was.

        Of several tries the one that took the shortest is taken: a process that is put aside
        between reading the one and the other clock would otherwise see a step.
        """
        tries = []
        for _ in range(_TRIES):
            before = self._read_monotonic()
            wall = self._read_wall()
            after = self._read_monotonic()
            tries.append((after - before, wall - (before + after) // 2, after))
        _, offset, at = min(tries)
        return offset, at


_MEASURED_EVERY = seconds(1.0)
_LEAST_STEP = seconds(0.01)
_TIMER_RESOLUTION = seconds(0.001)
_TRIES = 3


def to_datetime(nanoseconds: int) -> datetime:
    """Return nanoseconds since the epoch as UTC, cut to microseconds, and to what a datetime holds.

    A stamp from far away is thus shown as far away, whatever the offset is by then.
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
