"""Monitors one signal: its readings, how long it has been bad, and whether it is stale."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from domain.findings import Blocker, Fact
from domain.health.error_slot import ErrorSlot
from domain.health.held_readings import HeldReadings
from domain.health.signal_reasons import (
    kept_reason,
    pressed_reason,
    restored_reason,
    stale_reason,
    value_reason,
)
from domain.health.signals import (
    ESTOP,
    Bound,
    CountsFrom,
    Raisable,
    Recovery,
    SignalSettings,
)
from domain.inputs import Reading, SourceFault
from domain.snapshot import SignalView
from domain.timebase import Duration, Instant, to_seconds


class SignalMonitor:
    """One signal and its two errors: that of its value, and that it is stale.

    The result follows from the readings and from the instant of the last `judge`. The caller must
    call `judge` at each `wake_at`, before anything else that happens then or later.

    A reading is good if it meets no bound. "For 3 s" counts as `CountsFrom` says; all
    bounds of a signal share that timer. If the value goes from one error to another without a
    good reading in between, the second is raised at once.

    A stop is as fresh as the newest reading from any source. If every source had to be fresh, a
    source that sends once, such as a person by hand, would make the stop stale for ever.
    """

    def __init__(self, settings: SignalSettings, start: Instant) -> None:
        self.settings = settings
        self.readings = HeldReadings(settings)
        name, part = settings.spec.name, settings.part
        self._path = (name,) if part is None else (part, name)
        self._counts_last_good = settings.counts_from is CountsFrom.LAST_GOOD
        self._counting_since = start if self._counts_last_good else None
        """From here on "for" counts; None: nothing counts."""
        self._cause: Bound | None = None
        self._counted: Duration = 0
        """How long it had counted when the error was raised."""
        self._engaged_since: Instant | None = None
        self.fault: SourceFault | None = None
        """The last failure of a source that it did not end by a reading."""
        self._measured_before = ""
        """What an earlier run had measured of the error that it left; empty: it left none."""
        self._facts = MappingProxyType(settings.facts())
        self._stale = settings.stale_key.error
        self.can_raise: Mapping[str, Raisable] = MappingProxyType(settings.can_raise())
        """The errors that it can raise, by name."""
        self._value_slot = ErrorSlot(settings.min_on, settings.recovery)
        self._stale_slot = ErrorSlot(settings.min_on, Recovery.AUTOMATIC)
        if settings.stale_after:
            # No minimum time: the first reading clears it at once.
            self._stale_slot.begin_with(self._stale, start)
        self.view = self._make_view(start)
        """The same object until something changes."""

    # --- what happens ----------------------------------------------------------------------------

    def receive(self, reading: Reading, source: str, now: Instant) -> None:
        """Process a checked reading.

        Args:
            reading: Of this signal; valid and not outdated.
            source: Who measured.
            now: When it arrived.
        """
        self.readings.take(reading, source, now)
        if self.fault is not None and self.fault.source == source:
            self.fault = None
        if not self._met_by_readings():
            self._counting_since = now if self._counts_last_good else None
        elif self._counting_since is None:
            self._counting_since = now
        self.judge(now)

    def note_fault(self, fault: SourceFault, now: Instant) -> None:
        """Take why a source gives no reading; the signal becomes stale in its own time."""
        self.fault = fault
        self.judge(now)

    def set_engaged(self, since: Instant | None, now: Instant) -> None:
        """Press or release the stop independently of its sources; this takes effect at once.

        Args:
            since: When it was pressed; None: it is released.
            now: The current time.
        """
        if (since is None) is not (self._engaged_since is None):
            self._engaged_since = since
            self.judge(now)

    def restore(self, error: str, since: Instant, measured: str, now: Instant) -> None:
        """Raise an error of an earlier run, which waits for acknowledgement; nothing is read yet.

        Args:
            error: One that needs an acknowledgement.
            since: When it was raised.
            measured: What was measured then.
            now: The current time.
        """
        self._measured_before = measured
        self._value_slot.restore(error, since)
        self.judge(now)

    def waits_with(self, error: str) -> bool:
        """Tell whether an error of this name, once raised, waits for an acknowledgement."""
        has_it = any(bound.error == error for bound in self.settings.bounds)
        return has_it and self.settings.recovery is Recovery.ACKNOWLEDGE

    def acknowledge(self, error: str, now: Instant) -> None:
        """Acknowledge `error` if it is the active one."""
        if self._value_slot.error == error:
            self._value_slot.acknowledge()
            self.judge(now)

    def judge(self, now: Instant) -> None:
        """Evaluate the readings as of `now`."""
        if not self._counts_last_good and self._is_stale(now):
            # What is not heard is not known to be bad.
            self._counting_since = None
        cause = self._find_cause(now)
        if cause is not self._cause:
            self._cause = cause
            self._counted = 0 if self._counting_since is None else now - self._counting_since
        self._value_slot.update(None if cause is None else cause.error, now)
        self._stale_slot.update(self._stale if self._is_stale(now) else None, now)
        view = self._make_view(now)
        if view != self.view:
            self.view = view

    def wake_at(self) -> Instant | None:
        """Return the next instant at which time alone changes something; None: never."""
        since = self._counting_since
        due = [] if since is None else [since + bound.for_ for bound in self._waiting()]
        others = (self._stale_at(), self._value_slot.wake_at, self._stale_slot.wake_at)
        return min((*due, *(at for at in others if at is not None)), default=None)

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def errors(self) -> frozenset[str]:
        """Return the active errors."""
        errors = (self._value_slot.error, self._stale_slot.error)
        return frozenset(error for error in errors if error is not None)

    @property
    def present(self) -> frozenset[str]:
        """Return the active errors whose cause is still present."""
        causes = (self._value_slot.cause, self._stale_slot.cause)
        return frozenset(cause for cause in causes if cause is not None)

    def reasons(self) -> Iterator[Blocker]:
        """Yield why the errors are active, one reason per cause."""
        value = self.readings.value
        if self._value_slot.error is not None and self._cause is None:
            yield self._reason(self._value_slot, self._kept_reason())
        elif self._cause is not None and self.settings.spec.is_stop:
            yield from self._stop_reasons(self._value_slot)
        elif self._cause is not None and value is not None:
            message = value_reason(self.settings, self._cause, value, self._counted)
            threshold = self._cause.threshold
            yield self._reason(self._value_slot, message, value, threshold)
        if self._stale_slot.cause is not None:
            is_seen = self.readings.newest is not None
            message = stale_reason(self.settings, self._fault_reason, is_seen=is_seen)
            limit = to_seconds(self.settings.stale_after)
            yield self._reason(self._stale_slot, message, threshold=limit)
        elif self._stale_slot.error is not None:
            yield self._reason(self._stale_slot, kept_reason(self.settings, self._stale_slot))

    def _kept_reason(self) -> str:
        if self._measured_before and self.readings.newest is None:
            return restored_reason(self._measured_before)
        return kept_reason(self.settings, self._value_slot)

    def _stop_reasons(self, slot: ErrorSlot) -> Iterator[Blocker]:
        if self._engaged_since is not None:
            message = "emergency stop is engaged"
            yield self._reason(slot, message, value=True, since=self._engaged_since)
        if pressing := self.readings.pressing:
            message = pressed_reason(self.readings, self.settings.spec)
            yield self._reason(slot, message, value=True, since=pressing[0].since)

    def _reason(
        self,
        slot: ErrorSlot,
        message: str,
        value: Fact = None,
        threshold: Fact = None,
        since: Instant | None = None,
    ) -> Blocker:
        return Blocker(
            code=slot.error or "",
            message=message,
            path=self._path,
            value=value,
            threshold=threshold,
            since=slot.since if since is None else since,
            refuses=slot.error == ESTOP,
        )

    def _make_view(self, now: Instant) -> SignalView:
        newest = self.readings.newest
        pressing = self.readings.pressing
        coming = min(self._waiting(), key=lambda bound: bound.for_, default=None)
        return SignalView(
            signal=self.settings.spec.name,
            value=self.readings.value,
            unit=self.settings.spec.unit,
            source=pressing[0].source if pressing else newest.source if newest else None,
            received_at=newest.received_at if newest else None,
            stamp=newest.stamp if newest else None,
            stale=self._is_stale(now),
            error=self._value_slot.error,
            pending_error=coming.error if coming else None,
            pending_since=self._counting_since if coming else None,
            pending_needs=coming.for_ if coming else None,
            skewed=newest.skewed if newest else False,
            needs_acknowledgement=self._value_slot.waits_for_acknowledgement,
            settings=self._facts,
            source_fault=self._fault_reason or None,
        )

    @property
    def _fault_reason(self) -> str:
        return "" if self.fault is None else self.fault.reason

    # --- what is judged --------------------------------------------------------------------------

    def _met_by_readings(self) -> list[Bound]:
        """Return the bounds that the value meets, the most urgent first."""
        value = self.readings.value
        if value is None:
            return []
        return [
            bound
            for bound in self.settings.bounds
            if bound.is_met_by(value, error_is_on=bound is self._cause)
        ]

    def _met(self) -> list[Bound]:
        """Return the bounds that are met; an engaged emergency stop meets all."""
        if self._engaged_since is not None:
            return list(self.settings.bounds)
        return self._met_by_readings()

    def _is_due(self, bound: Bound, now: Instant) -> bool:
        if self._engaged_since is not None:
            return True
        return self._counting_since is not None and now - self._counting_since >= bound.for_

    def _find_cause(self, now: Instant) -> Bound | None:
        """Return the most urgent bound that is met and due, or is an error already."""
        met = self._met()
        for bound in met:
            if bound is self._cause or self._is_due(bound, now):
                return bound
        return met[0] if met and self._cause is not None else None

    def _waiting(self) -> list[Bound]:
        """Return the bounds that are met and will become the cause when they are due."""
        met = self._met() if self._counting_since is not None else []
        return met[: met.index(self._cause)] if self._cause in met else met

    def _stale_at(self) -> Instant | None:
        """Return when the value becomes stale; None: it is stale already, or never will be."""
        newest = self.readings.newest
        if not self.settings.stale_after or newest is None or self._stale_slot.cause is not None:
            return None
        # "Older than" is strict: the instant after the limit.
        return newest.received_at + self.settings.stale_after + 1

    def _is_stale(self, now: Instant) -> bool:
        if not self.settings.stale_after:
            return False
        newest = self.readings.newest
        return newest is None or now - newest.received_at > self.settings.stale_after
