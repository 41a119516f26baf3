"""The state of the whole robot, derived from its errors and its task: IDLE, RUNNING or ERROR."""

from dataclasses import replace

from domain.concern import Concern
from domain.events.health import SystemStateChanged
from domain.findings import Blocker
from domain.health.health import Health
from domain.outbox import Outbox
from domain.snapshot import SystemStateView, TaskStatus
from domain.storage import Storage
from domain.tasks.driving import Driving
from domain.timebase import Instant


class RobotState(Concern):
    """Publishes the state after errors and task have settled: the vehicle is stopped first."""

    def __init__(self, health: Health, driving: Driving, storage: Storage, outbox: Outbox) -> None:
        self._storage = storage
        self._health = health
        self._driving = driving
        self._outbox = outbox
        view = health.system_state(TaskStatus.NO_TASK)
        self._told = (view.state, view.errors)
        self._told_status = TaskStatus.NO_TASK
        self._told_moving: Blocker | None = None

    def settle(self, now: Instant) -> bool:
        """Publish the state of the robot if it differs from the last published one."""
        status, moving = self._driving.status, self._driving.still_moving
        if moving is not self._told_moving:
            self._told_moving = moving
            self._outbox.system_state = True
        if status is self._told_status and self._health.errors == self._told[1]:
            return False
        view = self._health.system_state(status)
        if status is not self._told_status:
            self._told_status = status
            self._outbox.system_state = True
        was, errors_before = self._told
        if (view.state, view.errors) != self._told:
            self._told = (view.state, view.errors)
            self._outbox.system_state = True
            cause = self._health.decided_by if view.errors != errors_before else None
            changed = SystemStateChanged(view.state, was, view.errors, view.error_code)
            self._outbox.emit(changed, cause)
        return True

    def view(self) -> SystemStateView:
        """Return the state of the robot with its reasons.

        A vehicle that should stand and does not comes first; it is a reason, and not an error.
        """
        view = self._health.system_state(self._driving.status)
        moving = self._driving.still_moving
        if moving is not None:
            view = replace(view, reasons=(moving, *view.reasons))
        fault = self._storage.fault
        return view if fault is None else replace(view, storage_fault=fault)
