"""Derives the health of the robot from its signals: which errors are active, and why.

Source: smart_polaris, `gem_state_manager`, whose error bits and thresholds are the defaults. Unlike
there, decisions are made when a reading arrives or a time is reached, not at the next cycle.
"""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from domain.errors import (
    InvalidValueError,
    OutdatedReadingError,
    UnknownErrorNameError,
    UnknownSignalError,
)
from domain.findings import Blocker
from domain.health.error_registry import ErrorRegistry
from domain.health.held_readings import HeldReadings
from domain.health.signal_monitor import SignalMonitor
from domain.health.signals import ESTOP_SIGNAL, STALE_DATA, SignalSettings
from domain.inputs import Reading, Readings, SourceFault
from domain.kept import KeptError
from domain.snapshot import SignalView, SystemState, SystemStateView, TaskStatus
from domain.timebase import Instant, to_seconds


@dataclass(frozen=True, slots=True)
class HealthChanges:
    """What a call changed.

    If an error is in both `raised` and `cleared`, it was cleared first if it is active now.
    """

    raised: tuple[Blocker, ...] = ()
    """The most urgent reason of each error that was raised."""
    cleared: tuple[str, ...] = ()
    pending: tuple[tuple[str, str], ...] = ()
    """Signals and errors whose time began to count."""
    settled: tuple[tuple[str, str, bool], ...] = ()
    """Signals and errors whose time stopped before the error was raised, and whether that was
    because the signal became stale."""
    signals: frozenset[str] = frozenset()
    """Signals whose view changed."""
    skewed: tuple[str, ...] = ()
    """Signals whose sender's clock now differs from ours."""
    state_changed: bool = False
    """Whether errors or reasons changed."""


@dataclass(frozen=True, slots=True)
class _Seen:
    """Errors, reasons and views at one moment."""

    errors: tuple[str, ...]
    reasons: tuple[Blocker, ...]
    views: Mapping[str, SignalView]


@dataclass(slots=True)
class _Gathered:
    """Changes while they are being gathered."""

    raised: list[Blocker] = field(default_factory=list)
    cleared: list[str] = field(default_factory=list)
    pending: list[tuple[str, str]] = field(default_factory=list)
    settled: list[tuple[str, str, bool]] = field(default_factory=list)
    signals: set[str] = field(default_factory=set)
    skewed: list[str] = field(default_factory=list)
    state_changed: bool = False

    def add(self, before: _Seen, after: _Seen) -> None:
        """Add the difference between two moments."""
        for error in after.errors:
            if error not in before.errors:
                self.raised.append(next(r for r in after.reasons if r.code == error))
        self.cleared += [error for error in before.errors if error not in after.errors]
        for name, view in after.views.items():
            if view is not before.views[name]:
                self._add_view(before.views[name], view)
        self.state_changed |= before.reasons != after.reasons

    def build(self) -> HealthChanges:
        """Return the changes."""
        return HealthChanges(
            tuple(self.raised),
            tuple(self.cleared),
            tuple(self.pending),
            tuple(self.settled),
            frozenset(self.signals),
            tuple(self.skewed),
            self.state_changed,
        )

    def _add_view(self, before: SignalView, after: SignalView) -> None:
        name = after.signal
        self.signals.add(name)
        if before.pending_error != after.pending_error:
            if before.pending_error not in (None, after.error):
                self.settled.append((name, before.pending_error, after.stale))
            if after.pending_error is not None:
                self.pending.append((name, after.pending_error))
        if after.skewed and not before.skewed:
            self.skewed.append(name)


class StateManager:
    """The signals of the robot, and the errors that follow from them.

    Deterministic: errors and reasons depend only on what was received and when, not on when time is
    advanced. At one instant, deadlines come before inputs.

    `now` is of one monotonic clock, and never decreases from call to call.
    """

    def __init__(self, settings: Iterable[SignalSettings], start: Instant) -> None:
        """Begin at `start` with nothing received.

        Raises:
            InvalidValueError: A signal or an error is declared twice, or `estop` is missing.
        """
        declared = tuple(settings)
        _check_declared(declared)
        self._monitors = {item.spec.name: SignalMonitor(item, start) for item in declared}
        self._registry = ErrorRegistry(self._monitors.values())
        self.is_late = False
        """While set, deadlines that passed are not judged: what has arrived is taken in first."""
        self._seen = self._look()
        self._wake_at = self._registry.next_wake()
        """Cached, since every input of the core reads it."""

    # --- what happens ----------------------------------------------------------------------------

    def check(self, readings: Readings, now: Instant) -> None:
        """Check readings without changing anything; one bad reading rejects all of them.

        Raises:
            UnknownSignalError: A signal is not declared.
            InvalidValueError: A value is of the wrong type, not finite or out of range; the pointer
                is the name of its signal.
            OutdatedReadingError: A newer reading of the signal is held, and this one is no worse.
        """
        trial: dict[str, HeldReadings] = {}
        for reading in self._checked(readings):
            name = reading.signal
            held = trial.setdefault(name, self._monitors[name].readings.copy())
            behind = held.behind(reading, readings.source)
            if behind is not None:
                raise OutdatedReadingError(name, to_seconds(behind))
            held.take(reading, readings.source, now)

    def released_by(self, readings: Readings) -> tuple[str, ...]:
        """Return the stops that their source would release with readings that passed `check`."""
        return tuple(
            reading.signal
            for reading in readings.items
            if self._monitors[reading.signal].readings.is_released_by(reading, readings.source)
        )

    def receive(self, readings: Readings, now: Instant) -> HealthChanges:
        """Process readings that passed `check`."""
        checked = self._checked(readings)
        with self._gathering(now) as gathered:
            for reading in checked:
                self._monitors[reading.signal].receive(reading, readings.source, now)
        return gathered.build()

    def is_new_fault(self, fault: SourceFault) -> bool:
        """Tell whether it is not yet known that a source gives no reading, for this reason.

        Raises:
            UnknownSignalError: The signal is not declared.
        """
        return self._monitor(fault.signal).fault != fault

    def note_fault(self, fault: SourceFault, now: Instant) -> HealthChanges:
        """Take why a source gives no reading of a signal."""
        with self._gathering(now) as gathered:
            self._monitors[fault.signal].note_fault(fault, now)
        return gathered.build()

    def set_emergency_stop(self, since: Instant | None, now: Instant) -> HealthChanges:
        """Raise ESTOP for the emergency stop, which no reading releases, or remove that cause.

        Args:
            since: When it was engaged; None: it is released.
            now: The current time.
        """
        with self._gathering(now) as gathered:
            self._monitors[ESTOP_SIGNAL].set_engaged(since, now)
        return gathered.build()

    def restore(self, errors: Iterable[KeptError], now: Instant) -> HealthChanges:
        """Raise errors of an earlier run that passed `check_kept`; they wait as they did."""
        with self._gathering(now) as gathered:
            for kept in errors:
                since = min(kept.since, now)
                self._monitors[kept.signal].restore(kept.error, since, kept.message, now)
        return gathered.build()

    def check_kept(self, kept: KeptError) -> str:
        """Return in words why an error cannot be restored; empty: it can."""
        monitor = self._monitors.get(kept.signal)
        if monitor is None:
            return f"there is no signal {kept.signal} any more"
        if not monitor.waits_with(kept.error):
            return f"{kept.signal} has no such error to acknowledge any more"
        return ""

    def acknowledge(self, error: str, now: Instant) -> HealthChanges:
        """Acknowledge an error: it clears once its cause is gone, which may be now.

        For an error that is not active, or that clears by itself, this has no effect.

        Raises:
            UnknownErrorNameError: There is no error of this name.
        """
        if error not in self._registry.names:
            raise UnknownErrorNameError("error", error, self._registry.names)
        with self._gathering(now) as gathered:
            self._registry.acknowledge(error, now)
        return gathered.build()

    def pass_time(self, now: Instant) -> HealthChanges:
        """Handle all deadlines up to `now`, each at its own instant."""
        with self._gathering(now) as gathered:
            pass
        return gathered.build()

    def wake_at(self) -> Instant | None:
        """Return the earliest instant at which time alone changes something; None: never."""
        return self._wake_at

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def errors(self) -> tuple[str, ...]:
        """Return the active errors, in the order of their bits."""
        return self._seen.errors

    @property
    def names(self) -> tuple[str, ...]:
        """Return all errors that can be raised, in the order of their bits."""
        return self._registry.names

    @property
    def present(self) -> frozenset[str]:
        """Return the active errors whose cause is still present."""
        return self._registry.present

    @property
    def reasons(self) -> tuple[Blocker, ...]:
        """Return why errors are active, the most urgent first."""
        return self._seen.reasons

    def system_state(self, task_status: TaskStatus) -> SystemStateView:
        """Return the state of the robot with its reasons, the most urgent first.

        ERROR while an error is active, else RUNNING while there is a task (also paused), else IDLE.

        Source: smart_polaris, `state_manager.cpp`.
        """
        error_code = self._registry.code(self.errors)
        if error_code:
            state = SystemState.ERROR
        elif task_status is TaskStatus.NO_TASK:
            state = SystemState.IDLE
        else:
            state = SystemState.RUNNING
        return SystemStateView(state, error_code, self.errors, self._seen.reasons, task_status)

    def signal(self, name: str) -> SignalView:
        """Return one signal; the same object until it changes.

        Raises:
            UnknownSignalError: It is not declared.
        """
        return self._monitor(name).view

    def signals(self) -> Mapping[str, SignalView]:
        """Return all signals in the order of declaration; the same object until one changes."""
        return self._seen.views

    # --- inside ----------------------------------------------------------------------------------

    def _monitor(self, name: str) -> SignalMonitor:
        monitor = self._monitors.get(name)
        if monitor is None:
            raise UnknownSignalError("signal", name, tuple(self._monitors))
        return monitor

    def _checked(self, readings: Readings) -> list[Reading]:
        checked = []
        for reading in readings.items:
            value = self._monitor(reading.signal).settings.spec.checked(reading.value)
            checked.append(Reading(reading.signal, value, reading.stamp))
        return checked

    @contextmanager
    def _gathering(self, now: Instant) -> Iterator[_Gathered]:
        """Advance time to `now`, then run the body, and gather the changes."""
        gathered = _Gathered()
        while not self.is_late and (due := self.wake_at()) is not None and due <= now:
            self._registry.judge(due)
            self._gather(gathered)
        yield gathered
        self._gather(gathered)

    def _gather(self, gathered: _Gathered) -> None:
        before = self._seen
        now = self._look()
        if all(view is before.views[name] for name, view in now.views.items()):
            # Keep the mapping, so that its identity shows that nothing changed.
            now = replace(now, views=before.views)
        self._seen = now
        self._wake_at = self._registry.next_wake()
        gathered.add(before, now)

    def _look(self) -> _Seen:
        views = {name: monitor.view for name, monitor in self._monitors.items()}
        return _Seen(self._registry.errors(), self._registry.reasons(), MappingProxyType(views))


def _check_declared(declared: tuple[SignalSettings, ...]) -> None:
    """Reject duplicate names of signals or errors, and a missing e-stop."""
    names = [item.spec.name for item in declared]
    errors = [STALE_DATA, *(c.error for item in declared for c in item.bounds)]
    for kind, given in (("signal", names), ("error", errors)):
        twice = sorted({name for name in given if given.count(name) > 1})
        if twice:
            raise InvalidValueError(f"{kind} {twice[0]} is declared twice", twice[0])
    if ESTOP_SIGNAL not in names:
        raise InvalidValueError(f"signal {ESTOP_SIGNAL} is not declared", ESTOP_SIGNAL)
