"""The robot's own errors in the list of all errors, as the state manager decides them."""

from collections.abc import Iterable

from domain.findings import Blocker
from domain.health.error_list import NORMAL, ErrorList, Found
from domain.health.signals import Recovery
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
                acting = [view for view in signals if view.error == name]
                found = Found(
                    self._state(name, acting), reason.message, reason.value, reason.threshold
                )
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

    def _state(self, error: str, acting: list[SignalView]) -> ErrorState:
        """Return the state of an active error.

        Args:
            error: Its name.
            acting: The signals whose error it is.
        """
        if any(view.needs_acknowledgement for view in acting):
            is_present = error in self._manager.present
            return ErrorState.ACTIVE if is_present else ErrorState.LATCHED
        needs_it = any(view.settings["recovery"] == str(Recovery.ACKNOWLEDGE) for view in acting)
        return ErrorState.ACKNOWLEDGED if needs_it else ErrorState.ACTIVE
