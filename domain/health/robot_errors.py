"""The robot's own errors in the list of all errors, as the state manager decides them."""

from domain.health.error_list import NORMAL, ErrorList, Found
from domain.health.health_changes import HealthChanges
from domain.health.state_manager import StateManager
from domain.snapshot import ErrorKey, ErrorState, SignalView
from domain.timebase import Instant


class RobotErrors:
    """Follows the state manager; it decides nothing.

    Among them are the errors of parts that signals raise.
    """

    def __init__(self, manager: StateManager, errors: ErrorList, start: Instant) -> None:
        """Note the errors that are on from the start, of signals that were never seen."""
        self._manager = manager
        self._errors = errors
        self._signal_of: dict[ErrorKey, str] = {}
        """The signal whose value raises an error; staleness is of no value."""
        for signal in manager.signals():
            settings = manager.settings(signal)
            for error in settings.value_errors:
                self._signal_of[ErrorKey(settings.part, error)] = signal
            for key, _ in settings.can_raise().values():
                errors.declare(key, settings.severity)
        for key in manager.keys:
            self._note(key, start)

    def follow(self, changes: HealthChanges, now: Instant) -> None:
        """Note the errors that a call of the state manager changed, or whose reasons it did."""
        for key in changes.errors:
            self._note(key, now)

    def follow_acknowledgement(self, error: ErrorKey, now: Instant) -> None:
        """Note an error that may have been acknowledged."""
        self._note(error, now)

    def _note(self, key: ErrorKey, now: Instant) -> None:
        signal = self._signal_of.get(key)
        view = None if signal is None else self._manager.signal(signal)
        found, since = NORMAL, now
        if self._manager.is_on(key):
            reason = self._manager.reason(key)
            state, lingers = self._state(key, view)
            found = Found(state, reason.message, reason.value, reason.threshold, lingers)
            since = now if reason.since is None else reason.since
        elif view is not None and view.pending_error == key.error:
            found = Found(ErrorState.PENDING)
            since = view.pending_since or now
        self._errors.note(key, found, since)

    def _state(self, key: ErrorKey, view: SignalView | None) -> tuple[ErrorState, bool]:
        """Return whether an error that is on is latched, and whether it lingers without a cause.

        Args:
            key: The error.
            view: The signal whose value raised it; None: it is of staleness.
        """
        if self._manager.is_present(key):
            return ErrorState.ACTIVE, False
        if view is not None and view.needs_acknowledgement:
            return ErrorState.LATCHED, False
        return ErrorState.ACTIVE, True
