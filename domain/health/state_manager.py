"""Derives the health of the robot from its signals: which errors are active, and why.

Source: smart_polaris, `gem_state_manager`, whose error bits and thresholds are the defaults. Unlike
there, decisions are made when a reading arrives or a time is reached, not at the next cycle.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

from domain.errors import (
    InvalidValueError,
    OutdatedReadingError,
    UnknownErrorNameError,
    UnknownSignalError,
)
from domain.findings import Blocker
from domain.health.error_registry import ErrorRegistry
from domain.health.feed import Feed
from domain.health.health_changes import Gathered, HealthChanges, Marks
from domain.health.held_readings import HeldReadings
from domain.health.monitor_graph import faults_of_monitors, fed_by, number_of
from domain.health.owing import Owing
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
from domain.windows.crossings import earliest


@dataclass(slots=True, eq=False)
class _Signal:
    """A signal, and what its readings go to."""

    name: str
    position: int
    """In the registry."""
    monitor: SignalMonitor
    feed: Feed | None
    """None: no monitor is computed from it."""
    fed: "list[_Computed]"


class _Computed(NamedTuple):
    """A monitor that is computed from another signal."""

    signal: _Signal
    monitor: WindowMonitor


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
        self._signals = _signals_of(declared, start)
        self._monitors = {name: signal.monitor for name, signal in self._signals.items()}
        self._windows = {
            name: monitor
            for name, monitor in self._monitors.items()
            if isinstance(monitor, WindowMonitor)
        }
        self._by_position = tuple(self._signals.values())
        self._registry = ErrorRegistry(self._monitors.values())
        feeds = {name: signal.feed for name, signal in self._signals.items()}
        self._owing = Owing({name: feed for name, feed in feeds.items() if feed is not None})
        self._stops = {item.spec.name for item in declared if item.spec.is_stop}
        self.is_late = False
        """While set, deadlines that passed are not judged: what has arrived is taken in first."""
        self._told = [Marks.of(monitor) for monitor in self._monitors.values()]
        """By position, what was told of the signals last."""
        self._versions = [monitor.version for monitor in self._monitors.values()]
        """By position, the versions of the signals that were told last."""
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
            if reading.stamp is None and trial is None:
                # Without a stamp it is behind none.
                continue
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
            fed: dict[int, _Computed] = {}
            for reading in checked:
                signal, value = self._signals[reading.signal], reading.value
                monitor, feed = signal.monitor, signal.feed
                was_calm = monitor.is_calm
                monitor.receive(reading, readings.source, now)
                # A reading that leaves it calm makes it stale later.
                self._note(signal, gathered, was_calm=was_calm, is_put_off=True)
                if feed is not None:
                    spec = monitor.settings.spec
                    number = value if type(value) is float else number_of(spec, value)
                    self._feed(signal, feed, number, now, fed)
            for each in fed.values():
                was_calm = each.monitor.is_calm
                each.monitor.judge(now)
                is_put_off = each.monitor.is_put_off
                self._note(each.signal, gathered, was_calm=was_calm, is_put_off=is_put_off)
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
        return earliest(self._registry.next_wake(), self._owing.next())

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

    def signals_named(self, names: Iterable[str]) -> dict[str, SignalView]:
        """Return several signals, as `signal` does, in the order of the names."""
        return {name: self._monitor(name).view for name in names}

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
            monitor = self._monitors.get(reading.signal) or self._monitor(reading.signal)
            settings = monitor.settings
            if settings.monitor is not None:
                words = f"{reading.signal} is computed from {settings.monitor.of}; post that"
                raise InvalidValueError(words, reading.signal)
            value = settings.spec.checked(reading.value)
            is_same = value is reading.value
            checked.append(reading if is_same else Reading(reading.signal, value, reading.stamp))
        self._checked_last = (readings, checked)
        return checked

    def _feed(
        self, signal: _Signal, feed: Feed, value: float, now: Instant, fed: dict[int, _Computed]
    ) -> None:
        """Hand a value to the monitors of a signal, and theirs to those that they feed.

        Args:
            signal: One that feeds monitors.
            feed: What it feeds.
            value: Its reading.
            now: The current time.
            fed: Takes the monitors that are to be judged, by their positions.
        """
        if not feed.take(value, now):
            return
        is_chained = is_owed_longer = False
        for each in signal.fed:
            computed, monitor = each
            if monitor.feed(value, now):
                fed[computed.position] = each
            else:
                is_owed_longer = True
            if computed.feed is not None:
                is_chained = True
                if (value_of_it := monitor.window.value(now)) is not None:
                    self._feed(computed, computed.feed, value_of_it, now, fed)
        if not is_chained:
            feed.note_fed()
        if is_owed_longer:
            self._owing.note(signal.name)

    def _note(
        self, signal: _Signal, gathered: Gathered, *, was_calm: bool, is_put_off: bool
    ) -> None:
        """Note what became of a signal.

        Args:
            signal: The signal.
            gathered: Takes what changed.
            was_calm: It was calm before; if it still is, no more than its value changed.
            is_put_off: If it still is calm, its deadline is not earlier than before.
        """
        monitor, position = signal.monitor, signal.position
        if not (was_calm and monitor.is_calm) or self._registry.is_touched(position):
            self._registry.touch(position)
            return
        if is_put_off:
            self._registry.postpone(position)
        else:
            self._registry.replan(position, monitor.wake_at())
        if monitor.version != self._versions[position]:
            self._versions[position] = monitor.version
            gathered.signals.add(signal.name)
            self._shown = None

    def _touched(self, name: str) -> SignalMonitor:
        """Return a monitor that is about to change."""
        signal = self._signals[name]
        self._registry.touch(signal.position)
        return signal.monitor

    @contextmanager
    def _gathering(self, now: Instant) -> Iterator[Gathered]:
        """Advance time to `now`, then run the body, and gather the changes."""
        gathered = Gathered()
        while not self.is_late and (due := self.wake_at()) is not None and due <= now:
            self._judge_owing(due)
            self._registry.judge(due)
            self._gather(gathered)
        yield gathered
        self._gather(gathered)

    def _judge_owing(self, now: Instant) -> None:
        """Let monitors take account of readings that were not followed by others."""
        while (name := self._owing.due(now)) is not None:
            for signal, monitor in self._signals[name].fed:
                if monitor.owed_until is not None and monitor.owed_until <= now:
                    self._registry.take_out(signal.position)
                    monitor.judge(now)

    def _gather(self, gathered: Gathered) -> None:
        """Gather what became of the signals that were touched; the others are as they were."""
        for position in self._registry.touched():
            signal = self._by_position[position]
            monitor = signal.monitor
            if monitor.version != self._versions[position]:
                self._versions[position] = monitor.version
                before, after = self._told[position], Marks.of(monitor)
                self._told[position] = after
                gathered.add_signal(before, after, monitor)
                self._shown = None
        changes = self._registry.renew()
        if changes.explained:
            gathered.add_errors(changes, self._registry)

    def _build(self, gathered: Gathered) -> HealthChanges:
        return gathered.build(self._registry.order)


def _signals_of(declared: Sequence[SignalSettings], start: Instant) -> dict[str, _Signal]:
    """Return the signals by name, each with the monitors that its readings go to."""
    feeds = {name: Feed(start) for name in fed_by(declared)}
    signals: dict[str, _Signal] = {}
    computed: list[_Computed] = []
    for position, item in enumerate(declared):
        name = item.spec.name
        if item.monitor is None:
            monitor = SignalMonitor(item, start)
        else:
            monitor = WindowMonitor(item, item.monitor, feeds[item.monitor.of], start)
        signal = signals[name] = _Signal(name, position, monitor, feeds.get(name), [])
        if isinstance(monitor, WindowMonitor):
            computed.append(_Computed(signal, monitor))
    for each in computed:
        signals[each.monitor.of].fed.append(each)
    return signals


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
