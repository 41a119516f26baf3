"""Monitors one signal: its readings, how long it has been bad, and whether it is stale."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import NamedTuple

from domain.findings import Blocker, Fact
from domain.health.error_slot import ErrorSlot
from domain.health.good_range import good_range
from domain.health.held_readings import HeldReading, HeldReadings
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
    ModeLimit,
    Raisable,
    Recovery,
    SignalSettings,
)
from domain.inputs import Reading, SignalValue, SourceFault
from domain.snapshot import SignalView
from domain.timebase import Duration, Instant, to_seconds


class StopCause(NamedTuple):
    """Something other than a reading that presses a stop."""

    message: str
    since: Instant


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
        self.limit = next((limit for limit in settings.limits if limit.part is None), None)
        """Which of the limits by mode is in force; until modes are known, that of the others."""
        self.settings = settings.with_limit(self.limit) if settings.limits else settings
        self.readings = HeldReadings(self.settings)
        self._good = good_range(self.settings.bounds)
        """Numbers that meet no bound while no error is on."""
        name, part = settings.spec.name, settings.part
        self._path = (name,) if part is None else (part, name)
        self._counts_last_good = settings.counts_from is CountsFrom.LAST_GOOD
        self._counting_since = start if self._counts_last_good else None
        """From here on "for" counts; None: nothing counts."""
        self._cause: Bound | None = None
        self._counted: Duration = 0
        """How long it had counted when the error was raised."""
        self._engaged: tuple[StopCause, ...] = ()
        self.fault: SourceFault | None = None
        """The last failure of a source that it did not end by a reading."""
        self._measured_before = ""
        """What an earlier run had measured of the error that it left; empty: it left none."""
        self._facts: Mapping[str, Fact] = MappingProxyType(self._make_facts())
        self._stale = settings.stale_key.error
        self._waiting: tuple[Bound, ...] = ()
        """Bounds that are met and will become the cause when they are due."""
        self.can_raise: Mapping[str, Raisable] = MappingProxyType(settings.can_raise())
        """The errors that it can raise, by name."""
        self._value_slot = ErrorSlot(settings.min_on, settings.recovery, settings.clear_for)
        self._stale_slot = ErrorSlot(settings.min_on, Recovery.AUTOMATIC)
        if settings.stale_after:
            # No minimum time: the first reading clears it at once.
            self._stale_slot.begin_with(self._stale, start)
        self.version = 0
        """Differs whenever something about the signal does."""
        self.is_calm = False
        """Nothing is wrong, counts or is pressed: a good reading changes nothing but the value."""
        self._view: SignalView | None = self._make_view(self._is_stale(start))
        """None: to be made when somebody asks."""

    # --- what happens ----------------------------------------------------------------------------

    def receive(self, reading: Reading, source: str, now: Instant) -> None:
        """Process a checked reading.

        Args:
            reading: Of this signal; valid and not outdated.
            source: Who measured.
            now: When it arrived.
        """
        before = self.readings.newest
        after = self.readings.take(reading, source, now)
        if self.is_calm and not after.skewed and self._is_good(reading.value):
            if after != before:
                self._note_change(None)
            return
        if self.fault is not None and self.fault.source == source:
            self.fault = None
        self._judge(self._count(now), now)

    def note_fault(self, fault: SourceFault, now: Instant) -> None:
        """Take why a source gives no reading; the signal becomes stale in its own time."""
        self.fault = fault
        self.judge(now)

    def set_engaged(self, causes: tuple[StopCause, ...], now: Instant) -> None:
        """Press or release the stop independently of its sources; this takes effect at once.

        Args:
            causes: All that press it; empty: it is released.
            now: The current time.
        """
        if causes != self._engaged:
            self._engaged = causes
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
        has_it = error in self.settings.value_errors
        return has_it and self.settings.recovery is Recovery.ACKNOWLEDGE

    def set_limit(self, limit: ModeLimit | None, now: Instant) -> None:
        """Put another limit in force, and judge the value that is held anew.

        "For" counts from here. An error that is on stays so if the value is beyond the new limit.

        Args:
            limit: One of the settings; None: no value is bad.
            now: The current time.
        """
        self._look()
        self.limit = limit
        self.settings = self.settings.with_limit(limit)
        self.readings.settings = self.settings
        self._good = good_range(self.settings.bounds)
        self._facts = MappingProxyType(self._make_facts())
        was_on, self._cause, self._counting_since = self._cause is not None, None, None
        met, is_unknown = self._met_by_readings(), self.readings.value is None
        if was_on and self.settings.bounds and (met or is_unknown):
            self._cause = self.settings.bounds[0]
        elif met:
            self._counting_since = now
        self.judge(now)

    def acknowledge(self, error: str, now: Instant) -> None:
        """Acknowledge `error` if it is the active one."""
        if self._value_slot.error == error:
            self._value_slot.acknowledge()
            self.judge(now)

    def judge(self, now: Instant) -> None:
        """Evaluate the readings as of `now`."""
        self._judge(self._met_by_readings(), now)

    def wake_at(self) -> Instant | None:
        """Return the next instant at which time alone changes something; None: never."""
        if self.is_calm:
            return self._stale_at()
        since = self._counting_since
        due = [] if since is None else [since + bound.for_ for bound in self._waiting]
        others = (self._stale_at(), self._value_slot.wake_at, self._stale_slot.wake_at)
        return min((*due, *(at for at in others if at is not None)), default=None)

    def _count(self, now: Instant) -> list[Bound]:
        """Begin to count if the value is bad, and cease to if not; return the bounds it meets."""
        met = self._met_by_readings()
        if not met:
            self._counting_since = now if self._counts_last_good else None
        elif self._counting_since is None:
            self._counting_since = now
        return met

    def _judge(self, met: list[Bound], now: Instant) -> None:
        """Evaluate the readings as of `now`, of which it is known which bounds they meet."""
        is_stale = self._is_stale(now)
        if is_stale and not self._counts_last_good:
            # What is not heard is not known to be bad.
            self._counting_since = None
        if self._engaged:
            met = list(self.settings.bounds)
        cause = self._find_cause(met, now)
        if cause is not self._cause:
            self._cause = cause
            self._counted = 0 if self._counting_since is None else now - self._counting_since
        self._value_slot.update(None if cause is None else cause.error, now)
        self._stale_slot.update(self._stale if is_stale else None, now)
        self._waiting = () if self._counting_since is None else tuple(self._before_cause(met))
        before, view = self.view, self._make_view(is_stale)
        self.is_calm = (
            cause is None
            and self._counting_since is None
            and not self.is_on
            and not self._engaged
            and self.fault is None
            and not self.is_skewed
            and not self.settings.spec.is_stop
        )
        if view != before:
            self._note_change(view)

    def _look(self) -> None:
        """Make the view before something changes, so that the change is told whoever looked."""
        self._view = self.view

    def _note_change(self, view: SignalView | None) -> None:
        self.version += 1
        self._view = view

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def is_on(self) -> bool:
        """Tell whether an error is active."""
        return self._value_slot.error is not None or self._stale_slot.error is not None

    @property
    def pending_error(self) -> str | None:
        """Return the error that will be raised next if the signal stays bad."""
        coming = min(self._waiting, key=_needs, default=None)
        return coming.error if coming else None

    @property
    def is_skewed(self) -> bool:
        """Tell whether the sender's clock differs from ours."""
        newest = self.readings.newest
        return newest is not None and newest.skewed

    @property
    def waits_for_acknowledgement(self) -> bool:
        """Tell whether an operator has yet to acknowledge the error of the value."""
        return self._value_slot.waits_for_acknowledgement

    @property
    def view(self) -> SignalView:
        """Return the signal; the same object until something changes."""
        if self._view is None:
            # Only good readings of a calm signal leave it to be made.
            newest = self.readings.newest
            self._view = self._make_view(False) if newest is None else self._make_calm_view(newest)
        return self._view

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
        for message, since in self._engaged:
            yield self._reason(slot, message, value=True, since=since)
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

    def _make_facts(self) -> dict[str, Fact]:
        facts = self.settings.facts()
        if self.settings.limits:
            facts["limits_because"] = None if self.limit is None else self.limit.name
        return facts

    def _make_view(self, is_stale: bool) -> SignalView:
        spec, newest = self.settings.spec, self.readings.newest
        pressing = self.readings.pressing
        coming = min(self._waiting, key=_needs, default=None)
        return SignalView(
            spec.name,
            self.readings.value,
            spec.unit,
            pressing[0].source if pressing else newest.source if newest else None,
            newest.received_at if newest else None,
            newest.stamp if newest else None,
            is_stale,
            self._value_slot.error,
            coming.error if coming else None,
            self._counting_since if coming else None,
            coming.for_ if coming else None,
            self.is_skewed,
            self._value_slot.waits_for_acknowledgement,
            self._facts,
            self._fault_reason or None,
        )

    def _make_calm_view(self, newest: HeldReading) -> SignalView:
        """Return the signal while it is calm: as `_make_view`, of what can be told then."""
        spec = self.settings.spec
        return SignalView(
            spec.name,
            newest.value,
            spec.unit,
            newest.source,
            newest.received_at,
            newest.stamp,
            False,
            None,
            None,
            None,
            None,
            False,
            False,
            self._facts,
            None,
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

    def _is_good(self, value: SignalValue) -> bool:
        """Tell whether the value that is held meets no bound, and no error is on."""
        if type(value) is not float:
            return not self._met_by_readings()
        lowest, highest = self._good
        return lowest <= value <= highest

    def _is_due(self, bound: Bound, now: Instant) -> bool:
        if self._engaged:
            return True
        return self._counting_since is not None and now - self._counting_since >= bound.for_

    def _find_cause(self, met: list[Bound], now: Instant) -> Bound | None:
        """Return the most urgent bound that is met and due, or is an error already."""
        for bound in met:
            if bound is self._cause or self._is_due(bound, now):
                return bound
        return met[0] if met and self._cause is not None else None

    def _before_cause(self, met: list[Bound]) -> list[Bound]:
        """Return the bounds that are met and more urgent than the cause."""
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


def _needs(bound: Bound) -> Duration:
    return bound.for_
