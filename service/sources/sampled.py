"""Sources that are read from time to time, by calls that may block."""

import asyncio
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import TypeAlias

from domain.timebase import Duration, Instant, seconds, to_seconds
from service.call_thread import CallThread
from service.clock import Clock
from service.sources.source import Sink, reason_of

DEADLINE: Duration = seconds(1.0)
"""A call that takes longer hangs: its signals have no reading until it returns."""

LONGEST_PAUSE: Duration = seconds(10.0)
"""Longest time between two tries of what fails, unless its period is longer."""

SECOND_LOOK: Duration = seconds(1.0)
"""Longest time until the call is made again that had nothing to tell yet."""

_MOST_DOUBLINGS = 10


@dataclass(frozen=True, slots=True)
class Probe:
    """One signal of a source, and the call that reads it."""

    signal: str
    period: Duration
    read: Callable[[], object]
    """Runs in the thread of the source, and may block. None: there is nothing to tell yet, as of a
    rate before the second look. What it raises is the reason why there is no reading."""


@dataclass(slots=True)
class _Batch:
    """Calls that are due together, and how they end; written by the thread."""

    probes: Sequence[Probe]
    ends: "list[_End]" = field(default_factory=list)
    """One for each probe that is done."""
    duration: Duration = 0

    def read(self) -> "_Batch":
        """Make the calls."""
        begin = time.perf_counter_ns()
        for probe in self.probes:
            try:
                end: _End = (probe.read(), "")
            except Exception as error:  # whatever it is, it is the reason
                end = (None, reason_of(error) or "it failed")
            self.ends.append(end)
        self.duration = time.perf_counter_ns() - begin
        return self


_End: TypeAlias = tuple[object, str]
"""What was read, or why nothing was."""


@dataclass(slots=True)
class _Plan:
    """When a probe is due, and how often it failed in a row."""

    probe: Probe
    due: Instant
    failures: int = 0

    def succeed(self, now: Instant) -> None:
        """Plan the next call a period later; calls that were missed are not made up for."""
        self.failures = 0
        on_time = self.due + self.probe.period
        self.due = on_time if on_time > now else now + self.probe.period

    def look_again(self, now: Instant) -> None:
        """Plan the second look soon, so that a rate is not unknown for a whole long period."""
        self.due = now + min(self.probe.period, SECOND_LOOK)

    def fail(self, now: Instant) -> None:
        """Plan the next call, later and later while it fails again and again."""
        period = self.probe.period
        self.failures = min(self.failures + 1, _MOST_DOUBLINGS)
        self.due = now + min(period << self.failures, max(period, LONGEST_PAUSE))


class SampledSource:
    """A `Source` with a thread of its own, in which all its probes are read.

    While a call hangs, no further one is begun, so that there is never more than one such thread;
    when it returns at last, what it returns is discarded, and all goes on.
    """

    def __init__(
        self,
        name: str,
        probes: Sequence[Probe],
        clock: Clock,
        close: Callable[[], None] | None = None,
    ) -> None:
        """Prepare; nothing is opened yet.

        Args:
            name: Of the source.
            probes: At least one.
            clock: Of the service.
            close: Called in the thread at the end; None: there is nothing to close.
        """
        self.name = name
        self.signals = tuple(probe.signal for probe in probes)
        self.probes = probes
        self._clock = clock
        self._close = close

    async def run(self, sink: Sink) -> None:
        """Read each probe in its period until cancelled."""
        now = self._clock.now()
        plans = [_Plan(probe, now) for probe in self.probes]
        thread = CallThread(f"source {self.name}")
        try:
            while True:
                await self._clock.sleep_until(min(plan.due for plan in plans))
                now = self._clock.now()
                await self._read([plan for plan in plans if plan.due <= now], thread, sink)
        finally:
            if self._close is not None:
                thread.run(partial(_closed, self._close))
            thread.end()

    async def _read(self, plans: Sequence[_Plan], thread: CallThread, sink: Sink) -> None:
        batch = _Batch([plan.probe for plan in plans])
        reading = thread.run(batch.read)
        if not await self._is_in_time(reading, DEADLINE):
            self._tell_hanging(batch, sink)
            while not await self._is_in_time(reading, LONGEST_PAUSE):
                self._tell_hanging(batch, sink)
            for plan in plans:
                plan.fail(self._clock.now())
            return
        sink.note_duration(batch.duration)
        now = self._clock.now()
        for plan, (value, why) in zip(plans, batch.ends, strict=True):
            if why:
                plan.fail(now)
                sink.fail(plan.probe.signal, why)
                continue
            if value is None:
                plan.look_again(now)
                continue
            plan.succeed(now)
            sink.take(plan.probe.signal, value)

    async def _is_in_time(self, reading: "asyncio.Future[_Batch]", limit: Duration) -> bool:
        deadline = asyncio.ensure_future(self._clock.sleep_until(self._clock.now() + limit))
        try:
            await asyncio.wait((reading, deadline), return_when=asyncio.FIRST_COMPLETED)
        finally:
            deadline.cancel()
        return reading.done()

    def _tell_hanging(self, batch: _Batch, sink: Sink) -> None:
        """Say of all signals that they have no reading, since one call does not return.

        Again and again while it lasts, since a sink may not take every reason.
        """
        hanging = batch.probes[min(len(batch.ends), len(batch.probes) - 1)].signal
        limit = f"{to_seconds(DEADLINE):g} s"
        for signal in self.signals:
            what = "" if signal == hanging else f" for {hanging}"
            sink.fail(signal, f"no answer{what} within {limit}")


def _closed(close: Callable[[], None]) -> _Batch:
    # Whatever is wrong with it now, nobody needs it any more.
    with suppress(Exception):
        close()
    return _Batch(())
