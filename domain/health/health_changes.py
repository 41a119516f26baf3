"""What a call of the state manager changed, and how that is gathered."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from domain.findings import Blocker
from domain.health.error_registry import ErrorChanges, ErrorRegistry
from domain.health.signal_monitor import SignalMonitor
from domain.snapshot import ErrorKey


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


class Marks(NamedTuple):
    """What is told of a signal when it begins, and when it ends."""

    pending_error: str | None = None
    skewed: bool = False

    @classmethod
    def of(cls, monitor: SignalMonitor) -> "Marks":
        """Return those of a signal as it is now."""
        return NO_MARKS if monitor.is_calm else cls(monitor.pending_error, monitor.is_skewed)


NO_MARKS = Marks()


@dataclass(slots=True)
class Gathered:
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

    def add_signal(self, before: Marks, after: Marks, monitor: SignalMonitor) -> None:
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
