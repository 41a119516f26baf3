"""The part of the supervision that is about the vehicle: its pose, its task, and who holds it."""

from collections.abc import Iterator, Mapping

from domain.findings import Blocker
from domain.inputs import (
    CancelTaskRequest,
    DriveRequest,
    GoalFeedback,
    GoalResult,
    HoldRequest,
    ReleaseRequest,
    TaskRequest,
    VehicleReport,
)
from domain.outbox import Outbox
from domain.paths.path import Path
from domain.snapshot import HoldView, TaskStatus, TaskView, VehicleView
from domain.tasks.holds import ERROR_HOLD, VEHICLE_HOLD
from domain.tasks.settings import TaskSettings
from domain.tasks.task_planner import TaskPlanner
from domain.tasks.vehicle_watch import VehicleWatch
from domain.timebase import Instant, to_seconds
from domain.vehicle import VehicleLimits

_REASONS_TOLD = 3


class Driving:
    """Feeds the task planner, and sets the two holds that are Pilothouse's own."""

    def __init__(
        self,
        settings: TaskSettings,
        limits: VehicleLimits,
        errors: tuple[Blocker, ...],
        outbox: Outbox,
        start: Instant,
    ) -> None:
        """Begin without a pose, and so held.

        Args:
            settings: When a task may begin.
            limits: What the vehicle can do.
            errors: Why the robot is in ERROR already; empty: it is not.
            outbox: Where commands and events go.
            start: The present.
        """
        self.limits = limits
        self._settings = settings
        self._outbox = outbox
        self._vehicle = VehicleWatch(settings, outbox)
        self._planner = TaskPlanner(settings, limits, self._vehicle, outbox)
        # How things are at the start is no event.
        self._planner.holds.set(VEHICLE_HOLD, "the vehicle never told where it is", "", start)
        if errors:
            self._planner.holds.set(ERROR_HOLD, _words(errors), "", start)

    # --- what happens ----------------------------------------------------------------------------

    def check(self, given: DriveRequest | VehicleReport) -> None:
        """Refuse what cannot be taken; nothing is changed.

        Raises:
            PilothouseError: What stands against it.
        """
        match given:
            case TaskRequest():
                self._planner.check(given)
            case HoldRequest():
                self._planner.holds.check(given.owner)
                self._planner.holds.check_room(given.owner)
            case ReleaseRequest():
                self._planner.holds.check(given.owner)
            case VehicleReport():
                self._vehicle.check(given)
            case CancelTaskRequest():
                pass

    def take(
        self, given: DriveRequest | VehicleReport | GoalFeedback | GoalResult, now: Instant
    ) -> None:
        """Take in what `check` did not refuse."""
        match given:
            case VehicleReport():
                self._take_report(given, now)
            case GoalFeedback():
                self._planner.take_feedback(given)
            case GoalResult():
                self._planner.take_result(given, now)
            case TaskRequest():
                self._outbox.task = self._planner.serve(given, now)
            case CancelTaskRequest():
                self._planner.cancel(now)
            case HoldRequest():
                self._planner.hold(given.owner, given.reason, given.actor, now)
            case ReleaseRequest():
                self._planner.release(given.owner, now)

    def follow_errors(self, errors: tuple[Blocker, ...], now: Instant, cause: int | None) -> None:
        """Hold the task while the robot is in ERROR.

        Args:
            errors: Why it is; empty: it is not.
            now: The present.
            cause: Event that decided so.
        """
        if errors:
            self._planner.hold(ERROR_HOLD, _words(errors), "", now, cause)
        else:
            self._planner.release(ERROR_HOLD, now, cause)

    def wake_at(self) -> Instant | None:
        """Return when the pose becomes too old."""
        return self._vehicle.wake_at()

    def pass_time(self, now: Instant) -> None:
        """Hold the task once the pose is too old."""
        if self._vehicle.pass_time(now):
            limit_s = to_seconds(self._settings.pose_stale_after)
            reason = f"no pose of the vehicle for {limit_s:g} s"
            self._planner.hold(VEHICLE_HOLD, reason, "", now)

    def _take_report(self, report: VehicleReport, now: Instant) -> None:
        was_lost = self._vehicle.is_lost
        self._vehicle.take(report, now)
        if self._vehicle.stands:
            self._planner.note_standstill()
        if was_lost:
            self._planner.release(VEHICLE_HOLD, now)

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def status(self) -> TaskStatus:
        """Return whether there is a task, and whether it runs."""
        return self._planner.status

    @property
    def stands(self) -> bool:
        """Tell whether the vehicle is known to stand still."""
        return self._vehicle.stands

    @property
    def vehicle(self) -> VehicleView:
        """Return what is known of the vehicle."""
        return self._vehicle.view

    @property
    def holds(self) -> Mapping[str, HoldView]:
        """Return the holds by owner; the same object as long as nothing changed."""
        return self._planner.holds.views

    @property
    def current_task(self) -> TaskView | None:
        """Return the current task."""
        return self._planner.current

    @property
    def latest_task(self) -> TaskView | None:
        """Return the current task, or else the one that ended last; None: there never was one."""
        return self._planner.latest

    def task(self, identity: str) -> TaskView:
        """Return a task.

        Raises:
            UnknownTaskError: There is none of that id, or it is forgotten.
        """
        return self._planner.task(identity).view()

    def path_of(self, identity: str) -> Path:
        """Return the path of a task.

        Raises:
            UnknownTaskError: There is none of that id, or it is forgotten.
        """
        return self._planner.task(identity).path

    def tasks(self) -> Iterator[TaskView]:
        """Yield the tasks that are kept, the newest first."""
        return self._planner.tasks()


def _words(errors: tuple[Blocker, ...]) -> str:
    told = [error.message for error in errors[:_REASONS_TOLD]]
    more = len(errors) - len(told)
    return "; ".join(told) + (f"; and {more} more" if more else "")
