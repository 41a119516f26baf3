"""Health as a concern of the core: readings and acknowledgements in, errors and reasons out."""

from collections.abc import Iterable, Mapping

from domain.concern import Concern, Takers
from domain.events.health import (
    ErrorAcknowledged,
    ErrorCleared,
    ErrorRaised,
    SignalPending,
    SignalRead,
    SignalSettled,
    SignalSkewed,
)
from domain.findings import Blocker
from domain.health.signals import ESTOP, SignalSettings
from domain.health.state_manager import HealthChanges, StateManager
from domain.inputs import AcknowledgeRequest, Readings
from domain.outbox import Outbox
from domain.snapshot import SignalView, SystemStateView, TaskStatus
from domain.timebase import Instant


class Health(Concern):
    """Judges with the state manager, and tells what that decided.

    An error that time alone raised is caused by the reading that first was bad, not by the clock.
    """

    def __init__(self, signals: Iterable[SignalSettings], outbox: Outbox, start: Instant) -> None:
        self._manager = StateManager(signals, start)
        self._outbox = outbox
        self._pending: dict[str, int] = {}
        """By error, the event that told that it is pending."""
        self.decided_by: int | None = None
        """The newest event that raised or cleared an error; None: there was none yet."""

    # --- what happens ----------------------------------------------------------------------------

    @property
    def takes(self) -> Takers:
        """Return what takes each class of input."""
        return {Readings: self.take_readings, AcknowledgeRequest: self.acknowledge}

    def wake_at(self) -> Instant | None:
        """Return when an error begins or ends by time alone."""
        return self._manager.wake_at()

    def pass_time(self, now: Instant) -> None:
        """Let errors begin and end that are due."""
        self._tell(self._manager.pass_time(now))

    def take_readings(self, readings: Readings, now: Instant) -> None:
        """Take readings, and decide at once.

        Raises:
            PilothouseError: One of them cannot be taken; none was.
        """
        self._manager.check(readings, now)
        values = {reading.signal: reading.value for reading in readings.items}
        self._outbox.begin(now, SignalRead(readings.source, values), readings.actor)
        self._tell(self._manager.receive(readings, now))

    def acknowledge(self, request: AcknowledgeRequest, now: Instant) -> None:
        """Acknowledge an error, which ends when its cause is gone.

        Raises:
            UnknownErrorNameError: There is no error of this name.
        """
        self._outbox.begin(now, ErrorAcknowledged(request.error), request.actor)
        self._tell(self._manager.acknowledge(request.error, now))

    def press_stop(self, now: Instant, *, engaged: bool) -> None:
        """Let the emergency stop be a cause of ESTOP, or end that."""
        self._tell(self._manager.set_emergency_stop(engaged, now))

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def errors(self) -> tuple[str, ...]:
        """Return the errors that are on, in the order of their bits."""
        return self._manager.errors

    @property
    def reasons(self) -> tuple[Blocker, ...]:
        """Return why errors are on, the most urgent first; the same object until that changes."""
        return self._manager.reasons

    @property
    def is_stopped(self) -> bool:
        """Tell whether ESTOP is on: nothing may be activated."""
        return ESTOP in self._manager.errors

    @property
    def stop_reasons(self) -> tuple[Blocker, ...]:
        """Return why ESTOP is on; empty when it is not."""
        if not self.is_stopped:
            return ()
        return tuple(reason for reason in self._manager.reasons if reason.code == ESTOP)

    def signal(self, name: str) -> SignalView:
        """Return one signal.

        Raises:
            UnknownSignalError: It is not declared.
        """
        return self._manager.signal(name)

    def signals(self) -> Mapping[str, SignalView]:
        """Return all signals as declared; the same object as long as nothing changed."""
        return self._manager.signals()

    def system_state(self, task_status: TaskStatus) -> SystemStateView:
        """Return the state of the robot, given whether it has a task."""
        return self._manager.system_state(task_status)

    # --- inside ----------------------------------------------------------------------------------

    def _tell(self, changes: HealthChanges) -> None:
        """Record what changed, causes first."""
        emit = self._outbox.emit
        for signal, error in changes.pending:
            self._pending[error] = emit(SignalPending(signal, error))
        for signal, error in changes.settled:
            emit(SignalSettled(signal, error))
            self._pending.pop(error, None)
        for signal in changes.skewed:
            emit(SignalSkewed(signal))
        for reason in changes.raised:
            raised = ErrorRaised(reason.code, reason.message, reason.value, reason.threshold)
            self.decided_by = emit(raised, self._pending.pop(reason.code, None))
        for error in changes.cleared:
            self.decided_by = emit(ErrorCleared(error))
        self._outbox.signals |= changes.signals
