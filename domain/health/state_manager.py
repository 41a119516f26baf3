"""Derives the health of the robot from its signals: which errors are active, and why.

Source: smart_polaris, `gem_state_manager`, whose error bits and thresholds are the defaults. Unlike
there, decisions are made when a reading arrives or a time is reached, not at the next cycle.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple

from domain.errors import (
    InvalidValueError,
    OutdatedReadingError,
    UnknownErrorNameError,
    UnknownSignalError,
)
from domain.findings import Blocker
from domain.health.error_registry import ErrorChanges, ErrorRegistry
from domain.health.held_readings import HeldReadings
from domain.health.monitor_graph import faults_of_monitors, fed_by, number_of
from domain.health.signal_monitor import SignalMonitor, StopCause
from domain.health.signals import ESTOP_SIGNAL, STALE_DATA, ModeLimit, SignalSettings
from domain.health.window_monitor import WindowMonitor
from domain.inputs import Reading, Readings, SourceFault
from domain.kept import KeptError
from domain.snapshot import (
    ErrorKey,
    MonitorView,
    SignalView,
    SystemState,
    SystemStateView,
    TaskStatus,
)
from domain.timebase import Instant, to_seconds


class Raised(NamedTuple):
    """An error that was raised."""

    key: ErrorKey
    reason: Blocker
    """Its most urgent reason."""


@dataclass(frozen=True, slots=True)
class HealthChanges:
    """What a call changed.

    If an error is in both `raised` and `cleared`, it was cleared first if it is active now.
    """

    raised: tuple[Raised, ...] = ()
    cleared: tuple[ErrorKey, ...] = ()
    pending: tuple[tuple[str, str], ...] = ()
    """Signals and errors whose time began to count."""
    settled: tuple[tuple[str, str, bool], ...] = ()
    """Signals and errors whose time stopped before the error was raised, and whether that was
    because the signal became stale."""
    signals: frozenset[str] = frozenset()
    """Signals whose view changed."""
    skewed: tuple[str, ...] = ()
    """Signals whose sender's clock now differs from ours."""
    errors: tuple[ErrorKey, ...] = ()
    """Errors that were raised or cleared, began or ceased to be pending, or have other reasons."""
    state_changed: bool = False
    """Whether errors or reasons changed."""


@dataclass(slots=True)
class _Gathered:
    """Changes while they are being gathered."""

    raised: list[Raised] = field(default_factory=list)
    cleared: list[ErrorKey] = field(default_factory=list)
    pending: list[tuple[str, str]] = field(default_factory=list)
    settled: list[tuple[str, str, bool]] = field(default_factory=list)
    signals: set[str] = field(default_factory=set)
    skewed: list[str] = field(default_factory=list)
    errors: set[ErrorKey] = field(default_factory=set)
    state_changed: bool = False

    def build(self, order: Mapping[ErrorKey, int]) -> HealthChanges:
        """Return the changes."""
        return HealthChanges(
            tuple(self.raised),
            tuple(self.cleared),
            tuple(self.pending),
            tuple(self.settled),
            frozenset(self.signals),
            tuple(self.skewed),
            tuple(sorted(self.errors, key=order.__getitem__)),
            self.state_changed,
        )

    def add_errors(self, changes: ErrorChanges, registry: ErrorRegistry) -> None:
        """Add what became of errors."""
        self.raised += [Raised(key, registry.reason(key)) for key in changes.raised]
        self.cleared += changes.cleared
        self.errors.update(changes.explained)
        self.state_changed = True

    def add_signal(self, before: "_Told", after: "_Told", monitor: SignalMonitor) -> None:
        """Add what became of a signal."""
        name = monitor.settings.spec.name
        self.signals.add(name)
        if before.pending_error != after.pending_error:
            self._add_pending(before.pending_error, after.pending_error, monitor)
        if after.skewed and not before.skewed:
            self.skewed.append(name)

    def _add_pending(self, before: str | None, after: str | None, monitor: SignalMonitor) -> None:
        name, part = monitor.settings.spec.name, monitor.settings.part
        if before is not None:
            self.errors.add(ErrorKey(part, before))
            if before != monitor.view.error:
                self.settled.append((name, before, monitor.view.stale))
        if after is not None:
            self.errors.add(ErrorKey(part, after))
            self.pending.append((name, after))


class _Told(NamedTuple):
    """How a signal was when it was told last."""

    version: int
    pending_error: str | None
    skewed: bool

    @classmethod
    def of(cls, monitor: SignalMonitor) -> "_Told":
        if monitor.is_calm:
            return cls(monitor.version, None, monitor.is_skewed)
        return cls(monitor.version, monitor.pending_error, monitor.is_skewed)


class _Trial:
    """Readings that are held as a trial: of several of one signal, each has to fit those before."""

    def __init__(self, monitors: Mapping[str, SignalMonitor]) -> None:
        self._monitors = monitors
        self._copies: dict[str, HeldReadings] = {}

    def readings(self, name: str) -> HeldReadings:
        """Return a copy of the readings of a signal, the same for each call."""
        if name not in self._copies:
            self._copies[name] = self._monitors[name].readings.copy()
        return self._copies[name]


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
        self._monitors = {item.spec.name: _monitor_of(item, start) for item in declared}
        self._windows = {
            name: monitor
            for name, monitor in self._monitors.items()
            if isinstance(monitor, WindowMonitor)
        }
        self._fed = fed_by(declared)
        """By signal, the monitors that its readings go to."""
        self._position = {name: position for position, name in enumerate(self._monitors)}
        """By signal, its position in the registry."""
        self._by_position = tuple(self._monitors.values())
        self._registry = ErrorRegistry(self._monitors.values())
        self._stops = {item.spec.name for item in declared if item.spec.is_stop}
        self.is_late = False
        """While set, deadlines that passed are not judged: what has arrived is taken in first."""
        self._told = [_Told.of(monitor) for monitor in self._monitors.values()]
        """By position, how the signals were when they were told last."""
        self._checked_last: tuple[Readings | None, list[Reading]] = (None, [])
        """The readings that were checked last: `receive` follows `check`."""
        self._shown: Mapping[str, SignalView] | None = None
        """A copy of the views; None: to be made when somebody asks."""

    # --- what happens ----------------------------------------------------------------------------

    def check(self, readings: Readings, now: Instant) -> None:
        """Check readings without changing anything; one bad reading rejects all of them.

        Raises:
            UnknownSignalError: A signal is not declared.
            InvalidValueError: A value is of the wrong type, not finite or out of range; the pointer
                is the name of its signal.
            OutdatedReadingError: A newer reading of the signal is held, and this one is no worse.
        """
        checked = self._checked(readings)
        names = {reading.signal for reading in checked}
        trial = _Trial(self._monitors) if len(names) < len(checked) else None
        for reading in checked:
            name = reading.signal
            held = self._monitors[name].readings if trial is None else trial.readings(name)
            behind = held.behind(reading, readings.source)
            if behind is not None:
                raise OutdatedReadingError(name, to_seconds(behind))
            if trial is not None:
                held.take(reading, readings.source, now)

    def released_by(self, readings: Readings) -> tuple[str, ...]:
        """Return the stops that their source would release with readings that passed `check`."""
        return tuple(
            reading.signal
            for reading in readings.items
            if reading.signal in self._stops
            and self._monitors[reading.signal].readings.is_released_by(reading, readings.source)
        )

    def receive(self, readings: Readings, now: Instant) -> HealthChanges:
        """Process readings that passed `check`."""
        checked = self._checked(readings)
        with self._gathering(now) as gathered:
            fed: dict[str, None] = {}
            for reading in checked:
                monitor = self._touched(reading.signal)
                monitor.receive(reading, readings.source, now)
                if reading.signal in self._fed:
                    value = number_of(monitor.settings.spec, reading.value)
                    self._feed(reading.signal, value, now, fed)
            for name in fed:
                self._windows[name].compute(now)
                self._touched(name)
        return self._build(gathered)

    def set_limit(self, signal: str, limit: ModeLimit | None, now: Instant) -> HealthChanges:
        """Put another limit of a signal in force, one of its settings; None: none is."""
        with self._gathering(now) as gathered:
            self._touched(signal).set_limit(limit, now)
        return self._build(gathered)

    def is_new_fault(self, fault: SourceFault) -> bool:
        """Tell whether it is not yet known that a source gives no reading, for this reason.

        Raises:
            UnknownSignalError: The signal is not declared.
        """
        return self._monitor(fault.signal).fault != fault

    def note_fault(self, fault: SourceFault, now: Instant) -> HealthChanges:
        """Take why a source gives no reading of a signal."""
        with self._gathering(now) as gathered:
            self._touched(fault.signal).note_fault(fault, now)
        return self._build(gathered)

    def set_emergency_stop(self, causes: tuple[StopCause, ...], now: Instant) -> HealthChanges:
        """Raise ESTOP for the emergency stop, which no reading releases, or remove that cause.

        Args:
            causes: Why it is engaged, one for each computer; empty: it is released.
            now: The current time.
        """
        with self._gathering(now) as gathered:
            self._touched(ESTOP_SIGNAL).set_engaged(causes, now)
        return self._build(gathered)

    def restore(self, errors: Iterable[KeptError], now: Instant) -> HealthChanges:
        """Raise errors of an earlier run that passed `check_kept`; they wait as they did."""
        with self._gathering(now) as gathered:
            for kept in errors:
                since = min(kept.since, now)
                self._touched(kept.signal).restore(kept.error, since, kept.message, now)
        return self._build(gathered)

    def check_kept(self, kept: KeptError) -> str:
        """Return in words why an error cannot be restored; empty: it can."""
        monitor = self._monitors.get(kept.signal)
        if monitor is None:
            return f"there is no signal {kept.signal} any more"
        if monitor.settings.part != kept.part or not monitor.waits_with(kept.error):
            return f"{kept.signal} has no such error to acknowledge any more"
        return ""

    def acknowledge(self, error: ErrorKey, now: Instant) -> HealthChanges:
        """Acknowledge an error: it clears once its cause is gone, which may be now.

        For an error that is not active, or that clears by itself, this has no effect.

        Raises:
            UnknownErrorNameError: There is no such error.
        """
        if error not in self._registry.order:
            names = tuple(key.name for key in self._registry.order)
            raise UnknownErrorNameError("error", error.name, names)
        with self._gathering(now) as gathered:
            self._registry.acknowledge(error, now)
        return self._build(gathered)

    def pass_time(self, now: Instant) -> HealthChanges:
        """Handle all deadlines up to `now`, each at its own instant."""
        with self._gathering(now) as gathered:
            pass
        return self._build(gathered)

    def wake_at(self) -> Instant | None:
        """Return the earliest instant at which time alone changes something; None: never."""
        return self._registry.next_wake()

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def errors(self) -> tuple[str, ...]:
        """Return the names of the active errors that set a bit, in the order of their bits."""
        return self._registry.errors

    @property
    def keys(self) -> Iterable[ErrorKey]:
        """Return all errors that can be raised, in the order of their bits."""
        return self._registry.order.keys()

    @property
    def reasons(self) -> tuple[Blocker, ...]:
        """Return why errors that set a bit are active, the most urgent first.

        The same object until it changes.
        """
        return self._registry.reasons

    def is_on(self, error: ErrorKey) -> bool:
        """Tell whether an error is active."""
        return self._registry.is_on(error)

    def is_present(self, error: ErrorKey) -> bool:
        """Tell whether an error is active and its cause still present."""
        return self._registry.is_present(error)

    def reason(self, error: ErrorKey) -> Blocker:
        """Return the most urgent reason of an active error."""
        return self._registry.reason(error)

    def system_state(self, task_status: TaskStatus) -> SystemStateView:
        """Return the state of the robot with its reasons, the most urgent first.

        ERROR while an error is active that sets a bit, else RUNNING while there is a task (also
        paused), else IDLE.

        Source: smart_polaris, `state_manager.cpp`.
        """
        error_code = self._registry.code
        if error_code:
            state = SystemState.ERROR
        elif task_status is TaskStatus.NO_TASK:
            state = SystemState.IDLE
        else:
            state = SystemState.RUNNING
        return SystemStateView(state, error_code, self.errors, self.reasons, task_status)

    def settings(self, name: str) -> SignalSettings:
        """Return the settings of a declared signal."""
        return self._monitors[name].settings

    def signal(self, name: str) -> SignalView:
        """Return one signal; the same object until it changes.

        Raises:
            UnknownSignalError: It is not declared.
        """
        return self._monitor(name).view

    def signals(self) -> Mapping[str, SignalView]:
        """Return all signals in the order of declaration; the same object until one changes."""
        if self._shown is None:
            views = {name: monitor.view for name, monitor in self._monitors.items()}
            self._shown = MappingProxyType(views)
        return self._shown

    def monitors(self, now: Instant) -> Iterator[MonitorView]:
        """Yield the monitors in the order of declaration."""
        return (monitor.monitor_view(now) for monitor in self._windows.values())

    # --- inside ----------------------------------------------------------------------------------

    def _monitor(self, name: str) -> SignalMonitor:
        monitor = self._monitors.get(name)
        if monitor is None:
            raise UnknownSignalError("signal", name, tuple(self._monitors))
        return monitor

    def _checked(self, readings: Readings) -> list[Reading]:
        if readings is self._checked_last[0]:
            return self._checked_last[1]
        checked = []
        for reading in readings.items:
            settings = self._monitor(reading.signal).settings
            if settings.monitor is not None:
                words = f"{reading.signal} is computed from {settings.monitor.of}; post that"
                raise InvalidValueError(words, reading.signal)
            value = settings.spec.checked(reading.value)
            is_same = type(value) is type(reading.value) and value == reading.value and value
            checked.append(reading if is_same else Reading(reading.signal, value, reading.stamp))
        self._checked_last = (readings, checked)
        return checked

    def _feed(self, signal: str, value: float, now: Instant, fed: dict[str, None]) -> None:
        """Hand a value to the monitors of a signal, and theirs to those that they feed.

        Args:
            signal: One that feeds monitors.
            value: Its reading.
            now: The current time.
            fed: Takes the monitors.
        """
        for name in self._fed[signal]:
            monitor = self._windows[name]
            if monitor.feed(value, now):
                fed[name] = None
            if name in self._fed and (computed := monitor.window.value(now)) is not None:
                self._feed(name, computed, now, fed)

    def _touched(self, name: str) -> SignalMonitor:
        """Return a monitor that is about to change."""
        self._registry.touch(self._position[name])
        return self._monitors[name]

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
        """Gather what became of the signals that were touched; the others are as they were."""
        for position in self._registry.touched():
            before, monitor = self._told[position], self._by_position[position]
            if monitor.version != before.version:
                after = self._told[position] = _Told.of(monitor)
                gathered.add_signal(before, after, monitor)
                self._shown = None
        changes = self._registry.renew()
        if changes.explained:
            gathered.add_errors(changes, self._registry)

    def _build(self, gathered: _Gathered) -> HealthChanges:
        return gathered.build(self._registry.order)


def _monitor_of(settings: SignalSettings, start: Instant) -> SignalMonitor:
    if settings.monitor is None:
        return SignalMonitor(settings, start)
    return WindowMonitor(settings, settings.monitor, start)


def _check_declared(declared: tuple[SignalSettings, ...]) -> None:
    """Reject duplicate names of signals or errors, and a missing e-stop."""
    names = [item.spec.name for item in declared]
    errors = [STALE_DATA]
    for item in declared:
        errors += (ErrorKey(item.part, error).name for error in item.value_errors)
        if item.stale_key.error != STALE_DATA:
            errors.append(item.stale_key.name)
    for kind, given in (("signal", names), ("error", errors)):
        twice = [name for name, times in Counter(given).items() if times > 1]
        if twice:
            raise InvalidValueError(f"{kind} {min(twice)} is declared twice", min(twice))
    for fault in faults_of_monitors(declared):
        raise InvalidValueError(fault.message, f"{fault.signal}/{fault.key}")
    if ESTOP_SIGNAL not in names:
        raise InvalidValueError(f"signal {ESTOP_SIGNAL} is not declared", ESTOP_SIGNAL)
