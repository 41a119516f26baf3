"""All sources of the robot as one adapter: none of them ends the service, or harms another."""

import asyncio
import logging
from collections.abc import Mapping, Sequence

from domain.errors import InvalidValueError
from domain.health.signals import SignalKind, SignalSpec
from domain.inputs import Reading, Readings, SourceFault
from domain.timebase import Duration, Instant, seconds
from service.clock import Clock
from service.ports import BackendMessage, Deliver
from service.running import run_forever
from service.source_status import SourceStatus
from service.sources.source import Source, reason_of

log = logging.getLogger(__name__)

FIRST_PAUSE: Duration = seconds(1.0)
"""Time until a source that ended is run again; twice as long each time that it ends again."""

LONGEST_PAUSE: Duration = seconds(60.0)
"""Longest such time; a source that ran so long begins anew with the first one."""


QUIET: Duration = seconds(10.0)
"""Least time between two faults of a signal that are told: each of them is recorded."""


class Sources:
    """A `SignalSource` that runs sources: one that fails is run again, later and later.

    The readings of a source are checked here, each by itself, so that a source that lies about one
    signal can still tell the truth about others.
    """

    def __init__(
        self, sources: Sequence[Source], specs: Mapping[str, SignalSpec], clock: Clock
    ) -> None:
        """Prepare; nothing is opened yet.

        Args:
            sources: Of different names.
            specs: Of the signals of the robot, by name.
            clock: Of the service.
        """
        self._sources = tuple(sources)
        self._specs = specs
        self._clock = clock
        self.status = tuple(SourceStatus(source.name, source.signals) for source in sources)

    async def run(self, deliver: Deliver) -> None:
        """Deliver readings and faults of all sources until cancelled.

        Raises:
            ExceptionGroup: What `deliver` raised, in a `TaskFailedError`.
        """
        delivery = _Delivery(deliver)
        work = {"delivery of readings": delivery.failed()}
        for source, status in zip(self._sources, self.status, strict=True):
            sink = _Sink(status, self._specs, self._clock, delivery.deliver)
            work[f"source {source.name}"] = self._keep(source, sink)
        await run_forever(work)

    async def _keep(self, source: Source, sink: "_Sink") -> None:
        pause = FIRST_PAUSE
        while True:
            begun = self._clock.now()
            why = await _end_of(source, sink)
            for signal in source.signals:
                sink.fail(signal, why)
            now = self._clock.now()
            if now - begun >= LONGEST_PAUSE:
                pause = FIRST_PAUSE
            await self._clock.sleep_until(now + pause)
            pause = min(2 * pause, LONGEST_PAUSE)


class _Delivery:
    """Delivers, and tells the adapter if that fails: it is no failure of the source."""

    def __init__(self, deliver: Deliver) -> None:
        self._deliver = deliver
        self._failed: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    def deliver(self, message: BackendMessage) -> None:
        try:
            self._deliver(message)
        except Exception as error:
            if not self._failed.done():
                self._failed.set_exception(error)
            raise

    async def failed(self) -> None:
        await self._failed


async def _end_of(source: Source, sink: "_Sink") -> str:
    """Run a source until it ends, and return why it did."""
    try:
        await source.run(sink)
    except asyncio.CancelledError:
        task = asyncio.current_task()
        if task is not None and task.cancelling():
            raise
        return "it was cancelled"
    except Exception as error:  # no source may end the service
        return reason_of(error)
    return "it ended"


class _Sink:
    """Checks what one source has to say, delivers it, and logs what changed."""

    def __init__(
        self,
        status: SourceStatus,
        specs: Mapping[str, SignalSpec],
        clock: Clock,
        deliver: Deliver,
    ) -> None:
        self._status = status
        self._specs = specs
        self._clock = clock
        self._told: dict[str, str] = {}
        """Why there is no reading, by signal, as it was told."""
        self._quiet_until: dict[str, Instant] = {}
        self._deliver = deliver

    def take(self, signal: str, value: object, stamp: Instant | None = None) -> None:
        """Deliver a reading that its signal can have."""
        status, spec = self._status, self._specs.get(signal)
        if spec is None or signal not in status.signals:
            log.warning("%s gave a reading of %.64r, which is not its signal", status.name, signal)
            return
        try:
            checked = spec.checked(_as_value(value, spec))
        except InvalidValueError as error:
            self.fail(signal, f"refused: {error.message}")
            return
        status.reads += 1
        if self._told.pop(signal, None) is not None:
            log.info("%s reads %s again", status.name, signal)
        self._deliver(Readings((Reading(signal, checked, stamp),), status.name))

    def fail(self, signal: str, why: str) -> None:
        """Deliver why there is no reading, unless that is known, or another reason just was."""
        status, now = self._status, self._clock.now()
        status.failures += 1
        if self._told.get(signal) == why or now < self._quiet_until.get(signal, now):
            return
        self._quiet_until[signal] = now + QUIET
        self._told[signal] = why
        log.warning("%s does not read %s: %s", status.name, signal, why)
        self._deliver(SourceFault(signal, status.name, why))

    def note_duration(self, duration: Duration) -> None:
        """Take how long the source needed to measure."""
        self._status.duration = duration


def _as_value(value: object, spec: SignalSpec) -> object:
    """Return 1 and 0 of a boolean signal as true and false."""
    if spec.kind is SignalKind.BOOLEAN and isinstance(value, int | float) and value in (0, 1):
        return bool(value)
    return value
