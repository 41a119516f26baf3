"""The robot's own errors in the list of all errors, as the state manager decides them."""

from collections.abc import Collection, Iterable

from domain.findings import Blocker
from domain.health.error_list import NORMAL, ErrorList, Found
from domain.health.state_manager import HealthChanges, StateManager
from domain.snapshot import ErrorKey, ErrorState, SignalView
from domain.timebase import Instant


class RobotErrors:
    """Follows the state manager; it decides nothing."""

    def __init__(self, manager: StateManager, errors: ErrorList, start: Instant) -> None:
        """Note the errors that are on from the start, of signals that were never seen."""
        self._manager = manager
        self._errors = errors
        self._note(manager.errors, start)

    def follow(self, changes: HealthChanges, now: Instant) -> None:
        """Note the errors that a call of the state manager changed, or whose reasons it did."""
        affected = {error for _, error in changes.pending}
        affected |= {error for _, error, _ in changes.settled}
        if changes.state_changed:
            affected |= {reason.code for reason in changes.raised}
            affected |= {*changes.cleared, *self._manager.errors}
        if affected:
            self._note((error for error in self._manager.names if error in affected), now)

    def follow_acknowledgement(self, error: str, now: Instant) -> None:
        """Note an error that may have been acknowledged."""
        self._note((error,), now)

    def _note(self, names: Iterable[str], now: Instant) -> None:
        signals = self._manager.signals().values()
        pending = {view.pending_error: view.pending_since for view in signals}
        for name in names:
            since = now
            if name in self._manager.errors:
                reason = self._reason(name)
                state, lingers = self._state(name, signals)
                found = Found(state, reason.message, reason.value, reason.threshold, lingers)
                since = now if reason.since is None else reason.since
            elif name in pending:
                found = Found(ErrorState.PENDING)
                since = pending[name] or now
            else:
                found = NORMAL
            self._errors.note(ErrorKey(None, name), found, since)

    def _reason(self, error: str) -> Blocker:
        """Return the most urgent reason of an active error."""
        return next(reason for reason in self._manager.reasons if reason.code == error)

    def _state(self, error: str, signals: Collection[SignalView]) -> tuple[ErrorState, bool]:
        """Return whether an active error is latched, and whether it lingers without a cause.

        Args:
            error: Its name.
            signals: All signals.
        """
        if error in self._manager.present:
            return ErrorState.ACTIVE, False
        if any(view.needs_acknowledgement for view in signals if view.error == error):
            return ErrorState.LATCHED, False
        return ErrorState.ACTIVE, True
