"""Tells what the state manager decided, with what led to it."""

from domain.health.state_manager import HealthChanges, StateManager
from domain.outbox import Outbox
from domain.snapshot import SystemState, TaskStatus


class HealthEvents:
    """Turns decisions of the state manager into events.

    An error that time alone raised is caused by the reading that first was bad, not by the clock.
    """

    def __init__(self, health: StateManager, outbox: Outbox) -> None:
        self._health = health
        self._outbox = outbox
        self._pending: dict[str, int] = {}
        view = health.system_state(TaskStatus.NO_TASK)
        self._told: tuple[SystemState, tuple[str, ...]] = (view.state, view.errors)
        self._told_status = TaskStatus.NO_TASK

    def publish(self, changes: HealthChanges) -> int | None:
        """Record what changed, causes first; return the event that decided last, if one did."""
        emit = self._outbox.emit
        for signal, error in changes.pending:
            self._pending[error] = emit("signal.pending", {"signal": signal, "error": error})
        for signal, error in changes.settled:
            emit("signal.settled", {"signal": signal, "error": error})
            self._pending.pop(error, None)
        for signal in changes.skewed:
            emit("signal.skewed", {"signal": signal})
        decided: int | None = None
        for reason in changes.raised:
            data = {
                "error": reason.code,
                "message": reason.message,
                "value": reason.value,
                "threshold": reason.threshold,
            }
            decided = emit("error.raised", data, self._pending.pop(reason.code, None))
        for error in changes.cleared:
            decided = emit("error.cleared", {"error": error})
        self._outbox.signals |= changes.signals
        return decided

    def tell_state(self, task_status: TaskStatus, cause: int | None) -> None:
        """Tell the state of the robot if it is another one than told before."""
        view = self._health.system_state(task_status)
        if task_status is not self._told_status:
            self._told_status = task_status
            self._outbox.system_state = True
        if (view.state, view.errors) == self._told:
            return
        self._outbox.system_state = True
        data = {
            "state": str(view.state),
            "was": str(self._told[0]),
            "errors": list(view.errors),
            "error_code": view.error_code,
        }
        self._told = (view.state, view.errors)
        self._outbox.emit("system_state.changed", data, cause)
