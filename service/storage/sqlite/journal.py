"""The journal in a folder: its front on the event loop, which never waits for a disk.

What is noted is gathered in a batch. While one flight of batches is with the writer's thread the
next is gathered, so that all who wait share one sync.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from typing import Final

from pydantic_core import to_json

from domain.errors import StorageDegradedError
from domain.outbox import NOTHING, Outputs
from domain.timebase import Duration, Instant, seconds
from service.call_thread import CallThread
from service.clock import Clock, since_epoch
from service.codec.codec import KEPT, STEPS
from service.codec.names import NAMES
from service.codec.recorded_step import recorded_step
from service.storage.errors import UnusableFolderError
from service.storage.event_rows import event_row
from service.storage.journal import (
    Boot,
    EventQuery,
    Found,
    Plain,
    Step,
    StorageStatus,
    StoredEvent,
)
from service.storage.sqlite.announcer import Announcer
from service.storage.sqlite.backlog import Backlog
from service.storage.sqlite.batch import IDS, OWN, Flight
from service.storage.sqlite.connection import FAILURES, words
from service.storage.sqlite.folder import Report
from service.storage.sqlite.opening import Opened, StoreSettings, open_folder
from service.storage.sqlite.reading import read_events
from service.storage.sqlite.status import status_of

_EVENTS_AT_ONCE: Final = 200
"""A step with more events is written down in a turn of its own: for 1,000 it takes 20 ms."""
BATCH_S: Final = 0.05
"""How long what nobody waits for is gathered."""
FOLLOW_EVERY_S = 1.0
"""How often the writer does what no answer waits for, such as to bring the state up to the log."""
RETRY_S: Final = 1.0
SLOW_S: Final = 1.0
"""Storage that takes longer for one flight is degraded."""
CLOSE_PATIENCE_S: Final = 5.0
OPEN_PATIENCE_S: Final = 60.0
CHECKPOINT_EVERY: Final[Duration] = seconds(600.0)
_READ_PATIENCE_S: Final = 2.0
_READ_LIMIT_S: Final = 5.0

_log = logging.getLogger(__name__)


class SqliteJournal:
    """A `Journal` in a folder; made by `open`."""

    def __init__(
        self, settings: StoreSettings, boot: Boot, clock: Clock, writer: CallThread, opened: Opened
    ) -> None:
        self._settings = settings
        self._boot = boot
        self._clock = clock
        self._writer = writer
        self._opened = opened
        self._report = opened.report
        self._reader = CallThread("journal-reader")
        self._announcer = Announcer(opened.announced)
        self._backlog = Backlog(settings.backlog_bytes, opened.next.batch, opened.next.step)
        self._waiters: list[asyncio.Future[None]] = []
        self._must_last = False
        self._timer: asyncio.Handle | None = None
        self._is_due = False
        self._flying: asyncio.Task[None] | None = None
        self._took_off_at = 0.0
        self._followed_at = 0.0
        self._lags = False
        """Whether something was written after the writer did last what can wait."""
        self._fault: str | None = None
        self._is_closed = False
        self._deferred = deque[Step]()
        """Steps that are written down in later turns, the first of which is large."""
        self._wall: tuple[Instant | None, int] = (None, 0)
        self._wants_checkpoint = True
        self._checkpoint_at: Instant = boot.started_at
        if opened.fault is not None:
            self._fail(opened.fault, [])
            self._go_on()

    @classmethod
    async def open(cls, settings: StoreSettings, boot: Boot, clock: Clock) -> "SqliteJournal":
        """Take the folder of a robot, and write down that a run begins.

        Raises:
            UnusableFolderError: It is in use, of another robot, or cannot be used at all.
        """
        writer = CallThread("journal-writer")
        try:
            async with asyncio.timeout(OPEN_PATIENCE_S):
                opened = await writer.run(lambda: open_folder(settings, boot))
        except TimeoutError as error:
            writer.end()
            reason = f"{settings.folder} cannot be used: no answer for {OPEN_PATIENCE_S:g} s"
            raise UnusableFolderError(reason) from error
        except BaseException:
            writer.end()
            raise
        return cls(settings, boot, clock, writer, opened)

    @property
    def found(self) -> Found:
        """Return what was there when the journal was opened."""
        return self._opened.found

    @property
    def boot(self) -> Boot:
        """Return this run."""
        return self._boot

    @property
    def is_durable(self) -> bool:
        """Return True."""
        return True

    @property
    def fault(self) -> str | None:
        """Return why storage is degraded; None: it is not."""
        return self._fault or self._slowness() or self._report.state_fault

    @property
    def wants_checkpoint(self) -> bool:
        """Tell whether a replay could not go on from what was written down lately."""
        return self._wants_checkpoint

    def note(self, step: Step) -> None:
        """Write a step down soon, all of it or nothing."""
        if self._is_closed:
            return
        if self._deferred or len(step.outputs.events) > _EVENTS_AT_ONCE:
            self._deferred.append(step)
            if len(self._deferred) == 1:
                asyncio.get_running_loop().call_soon(self._take_deferred)
        else:
            self._take(step)

    def _take_deferred(self) -> None:
        """Take steps that were left to a turn of their own, up to the next large one."""
        while self._deferred:
            self._take(self._deferred.popleft())
            if self._deferred and len(self._deferred[0].outputs.events) > _EVENTS_AT_ONCE:
                asyncio.get_running_loop().call_soon(self._take_deferred)
                return

    def _take(self, step: Step) -> None:
        outputs = step.outputs
        try:
            line = STEPS.encode(recorded_step(step.at, step.given, step.is_late, outputs))
            rows = [event_row(event, self._wall_ns(event.at)) for event in outputs.events]
        except Exception as error:
            # Whatever is wrong with a step, the robot is supervised on.
            _log.exception("a step cannot be written down")
            self._backlog.lose(step.at, len(outputs.events), words(error))
        else:
            self._backlog.add_step(line, step.at, self._wall_ns(step.at), rows)
        if outputs is not NOTHING:
            self._note_kept(outputs)
        if step.at - self._checkpoint_at >= CHECKPOINT_EVERY:
            self._wants_checkpoint = True
        self._schedule()

    def _wall_ns(self, at: Instant) -> int:
        """Return the wall time of an instant; most that follow each other are the same."""
        if at != self._wall[0]:
            self._wall = at, since_epoch(self._clock.wall_time(at))
        return self._wall[1]

    def keep(self, name: str, value: Plain) -> None:
        """Keep a value of the service itself."""
        if not self._is_closed:
            self._backlog.change((OWN, name), to_json(value))
            self._schedule()

    @property
    def last_step(self) -> int:
        """Return the number of the step that was noted last."""
        return self._backlog.last_step + len(self._deferred)

    def checkpoint(self, step: int, at: Instant, state: bytes) -> None:
        """Write down the whole state of the core as it was after a step."""
        while self._deferred:
            self._take(self._deferred.popleft())
        if not self._is_closed and self._backlog.add_checkpoint(step, at, state):
            self._wants_checkpoint, self._checkpoint_at = False, at
            self._schedule()

    async def announce(self, what: Plain, patience_s: float) -> bool:
        """Put on disk what is about to be done; return whether it is there, in that time."""
        self._require_use()
        try:
            async with asyncio.timeout(patience_s):
                await self._announcer.announce(what)
        except TimeoutError:
            return False
        except OSError as error:
            self._fail_beside_flights(words(error))
            raise StorageDegradedError(words(error)) from error
        return True

    async def commit(self, patience_s: float) -> bool:
        """Wait until all that was noted before is on disk; return whether it is, in that time."""
        for _ in range(len(self._deferred)):
            # In each turn at least one of them is taken.
            await asyncio.sleep(0)
        self._require_use()
        self._must_last = True
        return await self._landed(patience_s)

    def _require_use(self) -> None:
        if self._is_closed:
            raise StorageDegradedError("storage is closed")
        if self._fault is not None:
            raise StorageDegradedError(self._fault)

    def status(self) -> StorageStatus:
        """Return how storage is doing."""
        return status_of(
            self._settings.folder,
            self._opened.found.restored.boot,
            self._report,
            self.fault,
            (self._backlog.lost_steps, self._backlog.lost_events),
        )

    async def events(self, query: EventQuery) -> Sequence[StoredEvent]:
        """Return events in the order of their ids, also those of earlier runs."""
        if self._fault is None and not self._is_closed and not self._is_landed:
            with suppress(StorageDegradedError):
                await self._landed(_READ_PATIENCE_S)
        files = self._report.files
        if not files:
            raise StorageDegradedError(self._fault or "the log is not open yet")
        reading = self._reader.run(lambda: read_events(files, query))
        try:
            async with asyncio.timeout(_READ_LIMIT_S):
                return await reading
        except TimeoutError:
            raise StorageDegradedError("the log takes too long to be read") from None
        except FAILURES as error:
            raise StorageDegradedError(words(error)) from error

    async def close(self) -> None:
        """Write down what is noted, note that the run ended, and release the folder."""
        if self._is_closed:
            return
        self._is_closed = True
        if self._timer is not None:
            self._timer.cancel()
        try:
            async with asyncio.timeout(CLOSE_PATIENCE_S):
                await self._end()
        except TimeoutError:
            _log.error("storage is too slow: the last entries may be lost")
        self._writer.end()
        self._reader.end()
        self._announcer.end()

    async def _end(self) -> None:
        while self._deferred:
            self._take(self._deferred.popleft())
        if self._flying is not None:
            await self._flying
        for kind, first in self._opened.ids.exact().items():
            self._backlog.change((IDS, kind), _id_text(first))
        self._backlog.end_run()
        flight = self._backlog.take(must_last=True)
        opened, is_degraded = self._opened, self._fault is not None
        folder = opened.folder

        def end() -> None:
            try:
                (folder.recover if is_degraded else folder.write)(flight)
                folder.follow()
            finally:
                folder.close()
                opened.announced.close()
                opened.lock.release()

        try:
            await self._writer.run(end)
        except Exception as error:
            _log.error("storage fails: the last entries are lost: %s", words(error))
            self._settle(self._waiters, StorageDegradedError(words(error)))
        self._settle(self._waiters, None)

    # --- from one flight to the next --------------------------------------------------------------

    @property
    def _is_landed(self) -> bool:
        return self._backlog.is_empty and self._flying is None and not self._deferred

    async def _landed(self, patience_s: float) -> bool:
        """Wait until all that was noted is written; return whether it is, in that time."""
        waiter: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiters.append(waiter)
        self._hurry()
        try:
            async with asyncio.timeout(patience_s):
                await waiter
        except TimeoutError:
            return False
        return True

    def _schedule(self) -> None:
        """Let a flight take off soon, unless one is in the air or due."""
        if self._timer is None and self._flying is None and not self._is_closed:
            self._timer = asyncio.get_running_loop().call_later(BATCH_S, self._take_off)

    def _hurry(self) -> None:
        """Let a flight take off when all who are about to wait in this turn of the loop do."""
        if self._flying is None and not self._is_due and self._fault is None:
            if self._timer is not None:
                self._timer.cancel()
            self._is_due = True
            self._timer = asyncio.get_running_loop().call_soon(self._take_off)

    def _take_off(self) -> None:
        self._timer, self._is_due = None, False
        loop = asyncio.get_running_loop()
        self._took_off_at = loop.time()
        waiters, self._waiters = self._waiters, []
        if self._backlog.is_empty and not waiters and self._fault is None:
            self._flying = loop.create_task(self._fly(None, waiters))
            return
        flight = self._backlog.take(self._must_last)
        self._must_last = False
        self._flying = loop.create_task(self._fly(flight, waiters))

    async def _fly(self, flight: Flight | None, waiters: "list[asyncio.Future[None]]") -> None:
        """Write a flight down, and see to the next one; None: only do what can wait."""
        is_recovering = self._fault is not None
        try:
            if flight is not None:
                await self._write(flight, is_recovering=is_recovering)
            self._settle(waiters, None)
            now = asyncio.get_running_loop().time()
            if flight is None or is_recovering or now - self._followed_at >= FOLLOW_EVERY_S:
                self._followed_at, self._lags = now, False
                self._take_report(await self._writer.run(self._opened.folder.follow))
        except FAILURES as error:
            self._fail(words(error), waiters)
        except Exception as error:
            _log.exception("steps cannot be written down")
            self._backlog.discard(words(error))
            self._fail(words(error), waiters)
        else:
            if is_recovering:
                _log.warning("storage works again")
                self._fault = None
        self._flying = None
        self._go_on()

    async def _write(self, flight: Flight, *, is_recovering: bool) -> None:
        folder, announced = self._opened.folder, self._opened.announced

        def write() -> None:
            if is_recovering:
                folder.recover(flight)
                announced.renew()
            else:
                folder.write(flight)

        await self._writer.run(write)
        self._lags = True
        self._backlog.written()
        self._wants_checkpoint |= any(batch.hole for batch in flight.batches)

    def _go_on(self) -> None:
        if self._is_closed:
            return
        if self._fault is not None:
            self._timer = asyncio.get_running_loop().call_later(RETRY_S, self._take_off)
        elif self._waiters:
            self._hurry()
        elif not self._backlog.is_empty or self._lags:
            self._schedule()

    def _take_report(self, report: Report) -> None:
        self._report = report
        self._wants_checkpoint |= report.began_file

    def _fail(self, reason: str, waiters: "list[asyncio.Future[None]]") -> None:
        if self._fault is None:
            _log.error("storage fails, and is tried again every second: %s", reason)
        self._fault = reason
        self._settle([*waiters, *self._waiters], StorageDegradedError(reason))
        self._waiters = []

    def _fail_beside_flights(self, reason: str) -> None:
        """Degrade at once; a flight that is in the air or due lands first."""
        if self._fault is not None or self._is_closed:
            return
        self._fail(reason, [])
        if self._flying is None:
            if self._timer is not None:
                self._timer.cancel()
            self._is_due = False
            self._go_on()

    def _settle(
        self, waiters: "list[asyncio.Future[None]]", error: StorageDegradedError | None
    ) -> None:
        for waiter in waiters:
            if waiter.done():
                continue
            if error is None:
                waiter.set_result(None)
            else:
                waiter.set_exception(error)

    def _slowness(self) -> str | None:
        if self._flying is None:
            return None
        waited = asyncio.get_running_loop().time() - self._took_off_at
        return f"no answer from the disk for {waited:.1f} s" if waited >= SLOW_S else None

    def _note_kept(self, outputs: Outputs) -> None:
        for change in outputs.kept:
            try:
                text = None if change.value is None else KEPT.encode(change.value)
            except Exception:
                _log.exception("%s cannot be kept", change.name)
                continue
            self._backlog.change((NAMES[change.kind], change.name), text)
        if self._opened.ids.see(outputs):
            for kind, end in self._opened.ids.reserve().items():
                self._backlog.change((IDS, kind), _id_text(end))


def _id_text(first: int) -> bytes:
    return str(first).encode()
