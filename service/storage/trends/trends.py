"""The history of signals: takes every reading, and answers charts."""

import asyncio
import logging
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from threading import BoundedSemaphore

from domain.errors import StorageDegradedError, UnknownSignalError
from domain.health.signals import SignalSettings
from domain.inputs import SignalValue
from domain.timebase import Instant, seconds
from service.call_thread import CallThread
from service.storage.trends.block_file import MEMORY
from service.storage.trends.history import Trend
from service.storage.trends.intake import Intake
from service.storage.trends.known_signals import KnownSignals
from service.storage.trends.recorder import Recorder
from service.storage.trends.tiers import MEMORY_TIERS, TIERS

log = logging.getLogger(__name__)

HAND_OVER = seconds(5.0)
"""How often the thread gets the readings; so many are lost at most if the process is killed."""

_CLOSING_S = 2.0
"""How long the end of the service waits for a disk."""

_MOST_CHARTS = 32
"""Charts that wait for the thread at once: while a disk hangs, more would only pile up."""

_INT64 = 2**63 - 1


@dataclass(frozen=True, slots=True)
class TrendsStatus:
    """How the history is doing."""

    bytes: int
    """Size of the blocks on disk, about."""
    dropped: int
    """Readings and rows of readings that this run could not keep."""
    reason: str | None
    """Why it cannot be stored; None: it can."""


class Trends:
    """Every method is called on the event loop, and returns at once unless it is awaited."""

    def __init__(self, signals: Iterable[SignalSettings], path: str = MEMORY) -> None:
        """Prepare; a thread starts with the first readings.

        Args:
            signals: All signals that are declared.
            path: Of the file; `MEMORY`: the history ends with the service.
        """
        self._signals = KnownSignals(signals)
        self._known = self._signals.by_name
        self._is_in_memory = path == MEMORY
        tiers = MEMORY_TIERS if self._is_in_memory else TIERS
        self._recorder = Recorder(self._signals, path, tiers)
        self._intake = Intake()
        self._thread: CallThread | None = None
        """None: there was nothing to do yet."""
        self._is_closed = False
        self._settling: asyncio.Future[None] | None = None
        self._charts = BoundedSemaphore(_MOST_CHARTS)
        self._started: Instant | None = None
        self._now: Instant = 0
        self._due: Instant = 0

    @property
    def status(self) -> TrendsStatus:
        """Return how the history is doing."""
        recorder = self._recorder
        size = 0 if self._is_in_memory else recorder.size
        return TrendsStatus(size, recorder.dropped + self._intake.dropped, recorder.reason)

    def note(self, signal: str, at: Instant, value: SignalValue, error: str | None) -> None:
        """Take a reading.

        Args:
            signal: Its name; one that is not declared is left out.
            at: When it arrived; not before the previous one.
            value: As the signal holds it.
            error: The error of the value in force then, if any.
        """
        known = self._known.get(signal)
        if known is not None:
            self._intake.add(known.number, at, known.number_of(value), known.rank_of(error))

    def pass_time(self, now: Instant) -> None:
        """Hand the readings over to the thread, every five seconds and unless it is busy."""
        self._set_time(now)
        is_busy = self._settling is not None and not self._settling.done()
        if now >= self._due and not is_busy and not self._is_closed:
            self._due = now + HAND_OVER
            self._hand_over()
            self._settling = self._do(partial(self._recorder.settle, self._elapsed()))

    async def history(self, signal: str, from_at: Instant, to_at: Instant, points: int) -> Trend:
        """Return the history of a signal, including all that was noted before.

        Args:
            signal: Its name.
            from_at: Begin of the chart.
            to_at: End of the chart, after the begin.
            points: Most points, at least 2.

        Raises:
            UnknownSignalError: It is not declared.
            StorageDegradedError: The file cannot be read, a disk hangs, or the service ends.
        """
        known = self._known.get(signal)
        if known is None:
            raise UnknownSignalError("signal", signal, [*self._known])
        if self._is_closed or not self._charts.acquire(blocking=False):
            raise StorageDegradedError("the history of signals takes too long to read")
        self._hand_over()
        from_at, to_at = max(from_at, -_INT64 // 2), min(to_at, _INT64 // 2)

        def trend() -> Trend:
            try:
                return self._recorder.trend(known, from_at, to_at, points)
            finally:
                # Here, since whoever asked may have gone meanwhile.
                self._charts.release()

        return await self._started_thread().run(trend)

    async def close(self) -> None:
        """Write down what was noted; a disk that hangs is not waited for."""
        if self._is_closed:
            return
        self._hand_over()
        closing = self._do(partial(self._recorder.close, self._elapsed()))
        self._is_closed = True
        await asyncio.wait([closing], timeout=_CLOSING_S)
        self._started_thread().end()

    def _set_time(self, now: Instant) -> None:
        if self._started is None:
            self._started, self._due = now, now + HAND_OVER
        self._now = now

    def _elapsed(self) -> int:
        return 0 if self._started is None else self._now - self._started

    def _hand_over(self) -> None:
        if rows := self._intake.take():
            self._do(partial(self._recorder.add, rows, self._elapsed()))

    def _do(self, work: Callable[[], None]) -> asyncio.Future[None]:
        doing = self._started_thread().run(work)
        doing.add_done_callback(_log_failure)
        return doing

    def _started_thread(self) -> CallThread:
        if self._thread is None:
            self._thread = CallThread("trends")
        return self._thread


def _log_failure(done: asyncio.Future[None]) -> None:
    if not done.cancelled() and (error := done.exception()) is not None:
        log.error("readings are missing in the history of signals", exc_info=error)
