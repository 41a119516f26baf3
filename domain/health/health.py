"""Health as a concern of the core: readings and acknowledgements in; errors and reasons out."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from itertools import chain

from domain.concern import Concern, Takers
from domain.events.health import (
    ErrorCleared,
    ErrorRaised,
    SignalLimitsChanged,
    SignalNotRead,
    SignalPending,
    SignalRead,
    SignalSettled,
    SignalSkewed,
)
from domain.events.service import NotRestored, WriteAnswered
from domain.findings import Blocker
from domain.health.error_causes import NO_CAUSES, ErrorCauses
from domain.health.error_list import ErrorList
from domain.health.health_changes import HealthChanges
from domain.health.robot_errors import RobotErrors
from domain.health.signal_monitor import StopCause
from domain.health.signals import (
    DECLARED_BIT,
    ESTOP,
    Comparison,
    ModeLimit,
    Recovery,
    SignalSettings,
)
from domain.health.state_manager import StateManager
from domain.inputs import Readings, Restored, SourceFault
from domain.kept import KeptError
from domain.outbox import Outbox
from domain.snapshot import (
    ErrorKey,
    ErrorView,
    MonitorView,
    Severity,
    SignalView,
    SystemState,
    SystemStateView,
    TaskStatus,
)
from domain.state_and_mode import PartName
from domain.timebase import Instant

_ESTOP = ErrorKey(None, ESTOP)
_TAKEN = 200
"""Status of a request that was accepted, as in HTTP."""


class Health(Concern):
    """Passes inputs to the state manager, and publishes its decisions as events.

    The cause of an error that time alone raised is the first bad reading, not the clock.
    """

    def __init__(
        self,
        signals: Iterable[SignalSettings],
        outbox: Outbox,
        start: Instant,
        causes: ErrorCauses = NO_CAUSES,
    ) -> None:
        """Begin with no readings.

        Args:
            signals: Settings of all signals.
            outbox: Receives events.
            start: The current time; the times of silent signals count from here.
            causes: Which errors of parts explain which.
        """
        declared = tuple(signals)
        self._manager = StateManager(declared, start)
        self._outbox = outbox
        self.error_list = ErrorList(outbox, causes)
        """All errors; later concerns note those of parts there."""
        self._robot_errors = RobotErrors(self._manager, self.error_list, start)
        self._keys_of: dict[PartName | None, list[ErrorKey]] = {}
        """By part, the errors that signals raise; None: the robot's own."""
        for key in self._manager.keys:
            self._keys_of.setdefault(key.part, []).append(key)
        self._pending: dict[ErrorKey, int] = {}
        """By error, the event that recorded it as pending."""
        acknowledge = Recovery.ACKNOWLEDGE
        self._waiting = {item.spec.name for item in declared if item.recovery is acknowledge}
        """Signals whose error may wait for an acknowledgement."""
        self._kept: dict[str, ErrorKey] = {}
        """By signal, the error that is kept, since it waits for an acknowledgement."""
        self._decided_by: int | None = None
        """The newest event that raised or cleared an error of a signal."""
        self._seen: tuple[tuple[Blocker, ...], tuple[Blocker, ...]] = ((), ())
        self._all_reasons: tuple[Blocker, ...] = ()

    # --- what happens ----------------------------------------------------------------------------

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {
            Readings: self.take_readings,
            SourceFault: self.take_fault,
            Restored: self.restore,
        }

    def wake_at(self) -> Instant | None:
        """Return when time alone raises or clears an error."""
        return self._manager.wake_at()

    def pass_time(self, now: Instant) -> None:
        """Raise and clear the errors that are due."""
        self._tell(self._manager.pass_time(now), now)

    @contextmanager
    def late(self) -> Iterator[None]:
        """Leave what is due to a later call of `pass_time` while the context is open."""
        self._manager.is_late = True
        try:
            yield
        finally:
            self._manager.is_late = False

    @property
    def is_late(self) -> bool:
        """Tell whether the current input was heard late by our own fault."""
        return self._manager.is_late

    def take_readings(self, readings: Readings, now: Instant) -> None:
        """Accept readings, and decide at once; one that releases a stop is in the audit trail.

        Raises:
            PilothouseError: One reading is rejected, and so all of them are.
        """
        self._manager.check(readings, now)
        values = {reading.signal: reading.value for reading in readings.items}
        released = self._manager.released_by(readings)
        self._outbox.begin(now, SignalRead(readings.source, values), readings.actor)
        self._tell(self._manager.receive(readings, now), now)
        sender = readings.actor.address or readings.source
        for signal in released:
            self._outbox.emit(WriteAnswered("READING", f"/signals/{signal}", _TAKEN, sender))

    def take_fault(self, fault: SourceFault, now: Instant) -> None:
        """Take why a source gives no reading of a signal; only what is new is told.

        Raises:
            UnknownSignalError: The signal is not declared.
        """
        is_new = self._manager.is_new_fault(fault)
        self._outbox.begin(now, SignalNotRead(fault.signal, fault.source, fault.reason))
        if is_new:
            self._outbox.record_input()
            self._tell(self._manager.note_fault(fault, now), now)

    def acknowledge(self, key: ErrorKey, now: Instant) -> None:
        """Acknowledge an error, so that its signal clears it once its cause is gone.

        For an error that no signal raises, this has no effect.
        """
        if key in self._manager.keys:
            self._tell(self._manager.acknowledge(key, now), now)
            self._robot_errors.follow_acknowledgement(key, now)

    def press_stop(self, causes: tuple[StopCause, ...], now: Instant) -> None:
        """Raise ESTOP for the emergency stop, or remove that cause.

        Args:
            causes: Why it is engaged, one for each computer; empty: it is released.
            now: The current time.
        """
        self._tell(self._manager.set_emergency_stop(causes, now), now)

    def set_limit(self, signal: str, limit: ModeLimit | None, now: Instant) -> None:
        """Put another limit of a signal in force, since a part is in another mode.

        Args:
            signal: Of which limits by mode are declared.
            limit: One of them; None: no value is bad.
            now: The current time.
        """
        bound = None if limit is None else limit.bound
        threshold = None if bound is None else float(bound.threshold)
        is_above = bound is not None and bound.comparison is Comparison.ABOVE
        above, below = (threshold, None) if is_above else (None, threshold)
        because = None if limit is None else limit.name
        self._outbox.emit(SignalLimitsChanged(signal, because, above, below))
        self._tell(self._manager.set_limit(signal, limit, now), now)

    def restore(self, restored: Restored, now: Instant) -> None:
        """Raise the errors again that nobody acknowledged, before anything is read."""
        errors = []
        for kept in restored.kept:
            if not isinstance(kept, KeptError):
                continue
            if reason := self._manager.check_kept(kept):
                self._outbox.forget(KeptError, kept.name)
                self._outbox.emit(NotRestored(f"the error {kept.error}", reason))
            else:
                errors.append(kept)
                self._kept[kept.signal] = ErrorKey(kept.part, kept.error)
        if errors:
            self._tell(self._manager.restore(errors, now), now)

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def decided_by(self) -> int | None:
        """Return the newest event that raised or cleared an error that sets a bit; None: none."""
        known = (self._decided_by, self.error_list.severe.decided_by)
        return max((event for event in known if event is not None), default=None)

    @property
    def errors(self) -> tuple[str, ...]:
        """Return the names of the active errors that set a bit: those of signals by their bits."""
        names = self.error_list.severe.names
        return (*self._manager.errors, *names) if names else self._manager.errors

    @property
    def reasons(self) -> tuple[Blocker, ...]:
        """Return why errors that set a bit are active, the most urgent first.

        The same object until it changes.
        """
        of_parts = self.error_list.severe.reasons(self.error_list.view)
        if not of_parts:
            return self._manager.reasons
        seen = (self._manager.reasons, of_parts)
        if seen[0] is not self._seen[0] or seen[1] is not self._seen[1]:
            self._seen, self._all_reasons = seen, (*seen[0], *seen[1])
        return self._all_reasons

    def error_views(self, part: PartName | None = None) -> Iterator[ErrorView]:
        """Yield the errors that signals raise, also those that were never raised, by their bits.

        Args:
            part: Whose errors; None: the robot's own.
        """
        for key in self._keys_of.get(part, ()):
            yield self.error_list.view(key)

    def severities(self) -> Mapping[ErrorKey, Severity]:
        """Return the errors that signals raise, with their severities; ESTOP is one of them."""
        keys = chain.from_iterable(self._keys_of.values())
        return {key: self.error_list.view(key).severity for key in keys}

    @property
    def is_stopped(self) -> bool:
        """Tell whether ESTOP is active: no node may be activated."""
        return self._manager.is_on(_ESTOP)

    @property
    def stop_reasons(self) -> tuple[Blocker, ...]:
        """Return why ESTOP is active; empty: it is not."""
        if not self.is_stopped:
            return ()
        return tuple(reason for reason in self._manager.reasons if reason.code == ESTOP)

    def signal(self, name: str) -> SignalView:
        """Return one signal.

        Raises:
            UnknownSignalError: It is not declared.
        """
        return self._manager.signal(name)

    def signals_named(self, names: Iterable[str]) -> dict[str, SignalView]:
        """Return several signals, as `signal` does, in the order of the names."""
        return self._manager.signals_named(names)

    def signals(self) -> Mapping[str, SignalView]:
        """Return all signals in the order of declaration; the same object until one changes."""
        return self._manager.signals()

    def monitors(self, now: Instant) -> Iterator[MonitorView]:
        """Yield the monitors in the order of declaration."""
        return self._manager.monitors(now)

    def system_state(self, task_status: TaskStatus) -> SystemStateView:
        """Return the state of the robot for a given task status."""
        view = self._manager.system_state(task_status)
        if not self.error_list.severe.names:
            return view
        code = view.error_code | DECLARED_BIT
        return replace(
            view,
            state=SystemState.ERROR,
            error_code=code,
            errors=self.errors,
            reasons=self.reasons,
        )

    # --- inside ----------------------------------------------------------------------------------

    def _tell(self, changes: HealthChanges, now: Instant) -> None:
        """Record changes as events, causes first."""
        emit = self._outbox.emit
        for signal, error in changes.pending:
            self._pending[self._key(signal, error)] = emit(SignalPending(signal, error))
        for signal, error, stale in changes.settled:
            emit(SignalSettled(signal, error, stale))
            self._pending.pop(self._key(signal, error), None)
        for signal in changes.skewed:
            emit(SignalSkewed(signal))
        for key, why in changes.raised:
            found, is_silenced = (why.message, why.value, why.threshold), self._is_silenced(key)
            is_root = not self.error_list.explanation_of(key)[1]
            raised = ErrorRaised(key.error, *found, key.part, is_root, is_silenced)
            self._decided_by = emit(raised, self._pending.pop(key, None))
            self.error_list.note_told(key, self._decided_by)
        for key in changes.cleared:
            is_root = self.error_list.view(key).is_root
            cleared = ErrorCleared(key.error, key.part, is_root, self._is_silenced(key))
            self._decided_by = emit(cleared)
            self.error_list.note_told(key, self._decided_by)
        self._robot_errors.follow(changes, now)
        self._outbox.signals |= changes.signals
        for signal in sorted(changes.signals & self._waiting):
            self._keep(signal)

    def _is_silenced(self, key: ErrorKey) -> bool:
        return self.error_list.view(key).marks.is_silenced

    def _keep(self, name: str) -> None:
        """Keep the error of a signal from when it waits for an acknowledgement until it does not.

        With what was measured when it began to: later readings are not worth a write each.
        """
        view, kept = self._manager.signal(name), self._kept.get(name)
        waits = view.error if view.needs_acknowledgement else None
        key = None if waits is None else self._key(name, waits)
        if key == kept:
            return
        if kept is not None:
            self._outbox.forget(KeptError, kept.name)
            del self._kept[name]
        if key is not None:
            why = self._manager.reason(key)
            self._outbox.keep(KeptError(name, key.error, why.since or 0, why.message, key.part))
            self._kept[name] = key

    def _key(self, signal: str, error: str) -> ErrorKey:
        """Return which error of a signal is meant."""
        return ErrorKey(self._manager.settings(signal).part, error)
