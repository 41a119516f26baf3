"""Driving as a concern of the core: the vehicle, its task and its holds."""

from collections.abc import Iterator, Mapping

from domain.actor import SERVICE
from domain.concern import Concern, Takers
from domain.controller import NavigationStatus
from domain.events.driving import (
    DriveAvailable,
    DriveUnavailable,
    GoalEnded,
    GoalProgressed,
    HoldReleaseRequested,
    HoldRequested,
    NavigationAvailable,
    NavigationUnavailable,
    TaskCancelRequested,
    TaskRequested,
    VehicleReported,
)
from domain.events.service import NotRestored
from domain.findings import Blocker
from domain.health.emergency_stop import EmergencyStop
from domain.health.health import Health
from domain.inputs import (
    CancelTaskRequest,
    DriveStatus,
    GoalFeedback,
    GoalResult,
    HoldRequest,
    ReleaseRequest,
    Restored,
    TaskRequest,
    VehicleReport,
)
from domain.kept import KeptHold, KeptProgress, KeptTask
from domain.outbox import Outbox
from domain.paths.path import Path
from domain.reaction_terms import HOLD_PREFIX
from domain.snapshot import HoldView, TaskStatus, TaskView, VehicleView
from domain.tasks.holds import (
    DRIVE_HOLD,
    ERROR_HOLD,
    NAVIGATION_HOLD,
    VEHICLE_HOLD,
    why_not_restored,
)
from domain.tasks.kept_tasks import tasks_of
from domain.tasks.settings import TaskSettings
from domain.tasks.task_planner import TaskPlanner
from domain.tasks.vehicle_watch import VehicleWatch
from domain.timebase import Instant, to_seconds
from domain.vehicle import VehicleLimits

_REASONS_TOLD = 3


class Driving(Concern):
    """Feeds the task planner, and sets the holds of Pilothouse itself."""

    def __init__(
        self,
        settings: TaskSettings,
        limits: VehicleLimits,
        health: Health,
        emergency_stop: EmergencyStop,
        outbox: Outbox,
        start: Instant,
        *,
        has_vehicle: bool = True,
    ) -> None:
        """Begin without a pose, and so with the hold `vehicle`.

        Args:
            settings: When a task may begin, and when the vehicle counts as lost or at standstill.
            limits: Limits of the vehicle.
            health: Its errors set the hold `error`.
            emergency_stop: Informed when the vehicle is at standstill.
            outbox: Receives commands and events.
            start: The current time.
            has_vehicle: Whether this computer drives the vehicle; otherwise nothing waits for its
                pose, and what is reported of one is left aside.
        """
        self._has_vehicle = has_vehicle
        self.limits = limits
        self.watch = VehicleWatch(settings, outbox)
        """The vehicle state; navigation uses it too."""
        self._settings = settings
        self._health = health
        self._emergency_stop = emergency_stop
        self._outbox = outbox
        self._planner = TaskPlanner(settings, limits, self.watch, outbox)
        self._followed = health.reasons
        self._kept: dict[str, KeptHold] = {}
        """The holds that are kept over a restart, by owner."""
        # The initial state is not an event.
        if has_vehicle:
            self._planner.holds.set(VEHICLE_HOLD, "the vehicle never reported a pose", "", start)
        if self._followed:
            self._planner.holds.set(ERROR_HOLD, _words(self._followed), "", start)

    # --- what happens ----------------------------------------------------------------------------

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {
            VehicleReport: self._take_report,
            DriveStatus: self._take_drive_status,
            NavigationStatus: self._take_navigation_status,
            GoalFeedback: self._take_feedback,
            GoalResult: self._take_result,
            TaskRequest: self._take_task,
            CancelTaskRequest: self._take_cancel,
            HoldRequest: self._take_hold,
            ReleaseRequest: self._take_release,
            Restored: self._take_restored,
        }

    def wake_at(self) -> Instant | None:
        """Return when the pose becomes stale."""
        return self.watch.wake_at()

    def pass_time(self, now: Instant) -> None:
        """Hold the task once the pose is stale."""
        if self.watch.pass_time(now):
            limit_s = to_seconds(self._settings.pose_stale_after)
            reason = f"no pose of the vehicle for {limit_s:g} s"
            self._planner.hold(VEHICLE_HOLD, reason, "", now)

    def settle(self, now: Instant) -> bool:
        """Hold the task while the robot is in ERROR."""
        reasons = self._health.reasons
        if reasons is self._followed:
            return False
        is_same = reasons == self._followed
        self._followed = reasons
        if is_same:
            return False
        if reasons:
            self._planner.hold(ERROR_HOLD, _words(reasons), "", now, self._health.decided_by)
        else:
            self._planner.release(ERROR_HOLD, now, self._health.decided_by)
        return True

    def _take_report(self, report: VehicleReport, now: Instant) -> None:
        self.watch.check(report)
        if not self._has_vehicle:
            return
        pose = report.state.pose
        self._outbox.begin(now, VehicleReported(pose.x_m, pose.y_m, report.state.speed_mps))
        was_lost = self.watch.is_lost
        self.watch.take(report, now)
        if self.watch.stands:
            self._planner.note_standstill(now)
        if was_lost:
            self._planner.release(VEHICLE_HOLD, now)
        if self.watch.stands:
            self._emergency_stop.note_standstill(now)

    def _take_drive_status(self, status: DriveStatus, now: Instant) -> None:
        if status.available:
            self._outbox.begin(now, DriveAvailable())
            self._planner.release(DRIVE_HOLD, now)
        else:
            self._outbox.begin(now, DriveUnavailable(status.reason))
            self._planner.hold(DRIVE_HOLD, status.reason, "", now)

    def _take_navigation_status(self, status: NavigationStatus, now: Instant) -> None:
        if status.available:
            self._outbox.begin(now, NavigationAvailable())
            self._planner.release(NAVIGATION_HOLD, now)
        else:
            self._outbox.begin(now, NavigationUnavailable(status.reason))
            self._planner.hold(NAVIGATION_HOLD, status.reason, "", now)

    def _take_feedback(self, feedback: GoalFeedback, now: Instant) -> None:
        self._outbox.begin(now, GoalProgressed(feedback.goal))
        self._planner.take_feedback(feedback, now)

    def _take_result(self, result: GoalResult, now: Instant) -> None:
        self._outbox.begin(now, GoalEnded(result.goal, result.succeeded, result.reason))
        self._planner.take_result(result, now)

    def _take_task(self, request: TaskRequest, now: Instant) -> None:
        self._planner.check(request)
        path = request.path
        requested = TaskRequested(
            path.count, path.length_m, request.start_index, request.controller, request.speed_mps
        )
        self._outbox.begin(now, requested, request.actor)
        self._outbox.task = self._planner.submit(request, now)

    def _take_cancel(self, request: CancelTaskRequest, now: Instant) -> None:
        self._outbox.begin(now, TaskCancelRequested(), request.actor)
        self._planner.cancel(now)

    def _take_hold(self, request: HoldRequest, now: Instant) -> None:
        self._planner.holds.check_set(request.owner)
        self._outbox.begin(now, HoldRequested(request.owner, request.reason), request.actor)
        self._planner.hold(request.owner, request.reason, request.actor.label, now)
        # The hold with which the service ends has done its duty when the service runs again.
        if request.actor != SERVICE:
            self._keep(self._planner.holds.views[request.owner])

    def _take_release(self, request: ReleaseRequest, now: Instant) -> None:
        self._planner.holds.check_release(request.owner)
        self._outbox.begin(now, HoldReleaseRequested(request.owner), request.actor)
        self._planner.release(request.owner, now)
        if self._kept.pop(request.owner, None) is not None:
            self._outbox.forget(KeptHold, request.owner)

    def _keep(self, hold: HoldView) -> None:
        kept = KeptHold(hold.owner, hold.reason, hold.by, hold.since)
        if self._kept.get(hold.owner) != kept:
            self._kept[hold.owner] = kept
            self._outbox.keep(kept)

    def _take_restored(self, restored: Restored, now: Instant) -> None:
        """Set the holds again that somebody had set, and hold the task that had not ended."""
        holds = sorted((h for h in restored.kept if isinstance(h, KeptHold)), key=_age)
        for hold in holds:
            if why := why_not_restored(hold.owner, len(self._kept)):
                self._outbox.forget(KeptHold, hold.owner)
                self._outbox.emit(NotRestored(f"the hold {hold.owner}", why))
                continue
            self._kept[hold.owner] = hold
            self._planner.holds.set(hold.owner, hold.reason, hold.by, min(hold.since, now))
        tasks, left_out = tasks_of(restored.kept, now)
        for task, why in left_out.items():
            self._outbox.forget(KeptTask, task)
            self._outbox.forget(KeptProgress, task)
            self._outbox.emit(NotRestored(f"the task {task}", why))
        self._planner.restore(tasks, restored.next_task, now)

    # --- for reactions ---------------------------------------------------------------------------

    def hold_for_reaction(self, reaction: str, reason: str, now: Instant) -> None:
        """Set the hold of a reaction: speed 0 is commanded at once."""
        self._planner.hold(f"{HOLD_PREFIX}{reaction}", reason, "", now)

    def release_for_reaction(self, reaction: str, now: Instant) -> None:
        """Release the hold of a reaction, if it is set."""
        self._planner.release(f"{HOLD_PREFIX}{reaction}", now)

    def restore_hold_of_reaction(self, reaction: str, reason: str, since: Instant) -> None:
        """Set a hold that an earlier run had set; the vehicle is not commanded."""
        self._planner.holds.set(f"{HOLD_PREFIX}{reaction}", reason, "", since)

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def status(self) -> TaskStatus:
        """Return whether there is a task, and whether it runs."""
        return self._planner.status

    @property
    def vehicle(self) -> VehicleView:
        """Return the view of the vehicle."""
        return self.watch.view

    @property
    def still_moving(self) -> Blocker | None:
        """Return that the vehicle should stand and does not, or may not; None: no such finding."""
        return self.watch.still_moving

    @property
    def holds(self) -> Mapping[str, HoldView]:
        """Return the holds by owner; the same object as long as nothing changed."""
        return self._planner.holds.views

    @property
    def current_task(self) -> TaskView | None:
        """Return the current task; None: there is none."""
        return self._planner.current

    @property
    def latest_task(self) -> TaskView | None:
        """Return the current task, or else the one that ended last; None: there never was one."""
        return self._planner.latest

    def task(self, identity: str) -> TaskView:
        """Return a task.

        Raises:
            UnknownTaskError: The id is unknown, or the task is no longer kept.
        """
        return self._planner.task(identity).view()

    def path_of(self, identity: str) -> Path:
        """Return the path of a task.

        Raises:
            UnknownTaskError: The id is unknown, or the task is no longer kept.
        """
        return self._planner.task(identity).path

    def tasks(self) -> Iterator[TaskView]:
        """Yield the tasks that are kept, the newest first."""
        return self._planner.tasks()


def _age(hold: KeptHold) -> tuple[Instant, str]:
    return hold.since, hold.owner


def _words(errors: tuple[Blocker, ...]) -> str:
    told = [error.message for error in errors[:_REASONS_TOLD]]
    more = len(errors) - len(told)
    return "; ".join(told) + (f"; and {more} more" if more else "")
