"""Decides whether the vehicle drives its task: submit, replace, hold, resume, cancel, end.

A task runs only while there are no holds. A hold preempts the goal of navigation and stops the
vehicle in the same step; when the last hold is released, one goal continues from the first waypoint
not yet passed. Each start sends exactly one goal, where smart_polaris sends two.

Source: smart_polaris, `task_planner_node.py`.
"""

from collections.abc import Iterator, Sequence

from domain.arrays import np
from domain.commands import Drive, PreemptGoal, SendGoal
from domain.errors import (
    FarStartError,
    InvalidValueError,
    PilothouseError,
    UnknownControllerError,
)
from domain.events.driving import (
    TASK_ENDS,
    HoldReleased,
    HoldSet,
    TaskPaused,
    TaskPausing,
    TaskResumed,
    TaskServed,
    TaskStarted,
)
from domain.events.event import Event
from domain.identifiers import GoalId, TaskId
from domain.inputs import GoalFeedback, GoalResult, TaskRequest
from domain.outbox import Outbox
from domain.paths.path import Path
from domain.snapshot import TaskPhase, TaskStatus, TaskView
from domain.tasks.holds import RESTART_HOLD, Holds
from domain.tasks.kept_tasks import TaskKeeper
from domain.tasks.settings import TaskSettings
from domain.tasks.task import Task
from domain.tasks.task_log import TaskLog
from domain.tasks.vehicle_watch import VehicleWatch
from domain.timebase import Instant
from domain.tracking.trackers import TRACKERS
from domain.vehicle import Point, VehicleLimits

MIN_CRUISE_MPS = 0.1
"""A slower task would soon be aborted for lack of progress."""
RESTART_REASON = "the service was restarted: the task goes on when the hold restart is released"


def check_controller(name: str) -> None:
    """Reject a controller that is not there.

    Raises:
        UnknownControllerError: There is no path tracker of that name.
    """
    if name not in TRACKERS:
        raise UnknownControllerError("controller", name, tuple(TRACKERS))


def check_cruise(speed_mps: float, limits: VehicleLimits) -> None:
    """Reject a cruise speed that the vehicle cannot drive.

    Raises:
        InvalidValueError: It is less than `MIN_CRUISE_MPS`, or more than the vehicle's top speed.
    """
    top = limits.max_speed_mps
    if not MIN_CRUISE_MPS <= speed_mps <= top:
        message = f"speed {speed_mps:g} m/s is not within {MIN_CRUISE_MPS:g} to {top:g} m/s"
        raise InvalidValueError(message, "speed_mps")


def check_start(path: Path, index: int) -> None:
    """Reject a waypoint at which no task can begin.

    Raises:
        InvalidValueError: It does not exist, or leaves no path.
    """
    if not 0 <= index < path.count - 1:
        message = f"start_index {index} is not within 0 to {path.count - 2}"
        raise InvalidValueError(message, "start_index")
    if path.distance_of(index) >= path.length_m:
        raise InvalidValueError("no path is left after this waypoint", "start_index")


class TaskPlanner:
    """The current task, if any, the holds, and the goal of navigation."""

    def __init__(
        self,
        settings: TaskSettings,
        limits: VehicleLimits,
        vehicle: VehicleWatch,
        outbox: Outbox,
    ) -> None:
        self.holds = Holds()
        self._settings = settings
        self._limits = limits
        self._vehicle = vehicle
        self._outbox = outbox
        self._log = TaskLog()
        self._keeper = TaskKeeper(outbox)
        self._current: Task | None = None
        self._tasks_accepted = 0
        self._goals_sent = 0

    # --- tasks -----------------------------------------------------------------------------------

    def check(self, request: TaskRequest) -> None:
        """Reject a task that cannot be driven.

        Raises:
            UnknownControllerError: There is no path tracker of that name.
            InvalidValueError: The start index is out of range or leaves no path, or the vehicle
                cannot drive the cruise speed.
            FarStartError: The path begins too far from the vehicle.
        """
        path, index = request.path, request.start_index
        self._check_drivable(path, index, request.controller, request.speed_mps)
        if (distance := self._too_far(path.waypoint(index))) is not None:
            limit_m = self._settings.max_start_distance_m
            raise FarStartError(distance, limit_m, self._nearest(path))

    def submit(self, request: TaskRequest, now: Instant) -> TaskId:
        """Replace the current task by a checked one, and start it unless there are holds."""
        self._tasks_accepted += 1
        task = Task(
            TaskId(f"t{self._tasks_accepted}"),
            request.path,
            request.controller,
            request.speed_mps,
            request.start_index,
            created_at=now,
            cause=self._outbox.record_input(),
        )
        if self._current is not None:
            self._drop_goal(self._current)
            self._end(self._current, TaskPhase.CANCELED, f"replaced by {task.id}", now)
        self._current = task
        self._add(task)
        self._keeper.add(task)
        count, length_m = task.path.count, task.length_m
        accepted = self._emit(TaskServed(task.id, count, length_m))
        if self.holds:
            self._pause(task, accepted, now, was_driving=False)
        else:
            self._start(task, accepted, now)
        return task.id

    def cancel(self, now: Instant) -> None:
        """Cancel the current task, if any, and stop the vehicle."""
        if self._current is not None:
            self._drop_goal(self._current)
            self._stop()
            self._end(self._current, TaskPhase.CANCELED, "canceled", now)
            # There is no task any more that it could keep from going on by itself.
            self.release(RESTART_HOLD, now)

    def restore(self, tasks: Sequence[Task], next_number: int, now: Instant) -> None:
        """Take over the tasks of an earlier run; one that has not ended waits for a person.

        Args:
            tasks: The oldest first; there is no other task yet.
            next_number: Number of the next task that is submitted.
            now: The current time.
        """
        self._tasks_accepted = next_number - 1
        for task in tasks:
            self._add(task)
        for task in tasks:
            if task.ended_at is not None:
                continue
            if why := self._why_not_driven(task, tasks[-1]):
                self._end(task, TaskPhase.ABORTED, why, now)
            else:
                self._current = task
                self.hold(RESTART_HOLD, RESTART_REASON, "", now)
                self._emit(TaskPaused(task.id, task.reason))

    # --- holds -----------------------------------------------------------------------------------

    def hold(
        self, owner: str, reason: str, by: str, now: Instant, cause: int | None = None
    ) -> None:
        """Set a hold and stop the vehicle in the same step; a repetition only updates the reason.

        Args:
            owner: Name of the hold.
            reason: Why it is set; may be empty.
            by: Who sets it; empty: Pilothouse itself.
            now: The current time.
            cause: Id of the event that led to it; None: the current input.
        """
        if not self.holds.set(owner, reason, by, now):
            self._renew_reason()
            return
        task = self._current
        was_driving = task is not None and self._drop_goal(task)
        self._stop()
        held = self._outbox.emit(HoldSet(owner, reason), cause)
        if task is not None and task.phase is TaskPhase.RUNNING:
            self._pause(task, held, now, was_driving=was_driving)
        self._renew_reason()

    def release(self, owner: str, now: Instant, cause: int | None = None) -> None:
        """Release a hold; with the last one the task resumes, even while it is still pausing.

        Args:
            owner: Name of the hold.
            now: The current time.
            cause: Id of the event that led to it; None: the current input.
        """
        if not self.holds.release(owner):
            return
        released = self._outbox.emit(HoldReleased(owner), cause)
        self._renew_reason()
        if self._current is not None and not self.holds:
            self._start(self._current, released, now)

    # --- what navigation and the vehicle say -----------------------------------------------------

    def take_feedback(self, feedback: GoalFeedback, now: Instant) -> None:
        """Update the progress of the task; late feedback of another goal is ignored."""
        task = self._current
        if task is None or feedback.goal not in (task.goal, task.stopping):
            return
        task.advance(feedback, self._vehicle.state)
        self._keeper.note_driven(task, now)
        is_driving = feedback.goal == task.goal
        if feedback.command is not None:
            self._vehicle.told(feedback.command, feedback.lookahead if is_driving else None)
        self._outbox.task_changed = True

    def take_result(self, result: GoalResult, now: Instant) -> None:
        """End the task with the result of its goal, and stop the vehicle."""
        task = self._current
        if task is None or task.goal != result.goal:
            return
        self._stop()
        phase = TaskPhase.SUCCEEDED if result.succeeded else TaskPhase.ABORTED
        self._end(task, phase, result.reason or None, now)

    def note_standstill(self, now: Instant) -> None:
        """Record that the vehicle is at standstill: a pausing task is paused."""
        task = self._current
        if task is not None and task.phase is TaskPhase.PAUSING:
            task.phase = TaskPhase.PAUSED
            self._keeper.note(task, now)
            self._emit(TaskPaused(task.id, task.reason))

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def status(self) -> TaskStatus:
        """Return whether there is a task, and whether it runs.

        Source: smart_polaris, `TaskPlannerStatus.msg`.
        """
        if self._current is None:
            return TaskStatus.NO_TASK
        running = self._current.phase is TaskPhase.RUNNING
        return TaskStatus.RUNNING_TASK if running else TaskStatus.PAUSED_TASK

    @property
    def current(self) -> TaskView | None:
        """Return the current task; None: there is none."""
        return None if self._current is None else self._current.view()

    @property
    def latest(self) -> TaskView | None:
        """Return the current task, or else the one that ended last; None: there never was one."""
        return next(self.tasks(), None)

    def task(self, identity: str) -> Task:
        """Return a task.

        Raises:
            UnknownTaskError: The id is unknown, or the task is no longer kept.
        """
        return self._log.get(identity)

    def tasks(self) -> Iterator[TaskView]:
        """Yield the tasks that are kept, the newest first."""
        return (task.view() for task in self._log.newest_first())

    # --- inside ----------------------------------------------------------------------------------

    def _start(self, task: Task, cause: int, now: Instant) -> None:
        """Send one goal.

        If the pose was unknown when the task was submitted, the distance to the start is checked
        now.
        """
        distance = None if task.has_run else self._too_far(task.path.waypoint(task.start_index))
        if distance is not None:
            limit_m = self._settings.max_start_distance_m
            reason = FarStartError(distance, limit_m).message
            self._end(task, TaskPhase.ABORTED, reason, now, cause)
            return
        self._goals_sent += 1
        task.goal, task.stopping = GoalId(self._goals_sent), None
        task.phase, task.reason = TaskPhase.RUNNING, None
        kind = TaskResumed if task.has_run else TaskStarted
        task.has_run = True
        self._emit(kind(task.id, task.goal, task.target_index), cause)
        self._outbox.command(
            SendGoal(
                task.goal,
                task.path,
                task.start_index,
                task.target_index,
                task.controller,
                task.speed_mps,
                task.reached_m,
                task.left_out_m,
                task.seen,
            )
        )

    def _pause(self, task: Task, cause: int, now: Instant, *, was_driving: bool) -> None:
        """Pause until there are no holds; a vehicle that was driving is not yet at standstill."""
        stands = self._vehicle.stands and not was_driving
        task.phase = TaskPhase.PAUSED if stands else TaskPhase.PAUSING
        task.reason = self.holds.reason
        self._keeper.note(task, now)
        kind = TaskPaused if stands else TaskPausing
        self._emit(kind(task.id, task.reason), cause)

    def _renew_reason(self) -> None:
        task = self._current
        if task is not None and task.reason != (reason := self.holds.reason or None):
            task.reason = reason
            self._outbox.task_changed = True

    def _drop_goal(self, task: Task) -> bool:
        """Preempt the goal of navigation; return whether there was one."""
        if task.goal is None:
            return False
        self._outbox.command(PreemptGoal(task.goal))
        task.goal, task.stopping = None, task.goal
        return True

    def _stop(self) -> None:
        command = self._vehicle.stop_command()
        self._vehicle.told(command, None)
        self._outbox.command(Drive(command))

    def _end(
        self,
        task: Task,
        phase: TaskPhase,
        reason: str | None,
        now: Instant,
        cause: int | None = None,
    ) -> None:
        task.end(phase, reason, now)
        self._keeper.note(task, now)
        self._emit(TASK_ENDS[phase](task.id, reason, task.view().progress), cause)
        self._current = None

    def _emit(self, event: Event, cause: int | None = None) -> int:
        """Record an event of a task."""
        self._outbox.task_changed = True
        return self._outbox.emit(event, cause)

    def _add(self, task: Task) -> None:
        for dropped in self._log.add(task):
            self._keeper.forget(dropped)

    def _check_drivable(
        self, path: Path, start_index: int, controller: str, speed_mps: float
    ) -> None:
        """Reject a task that this vehicle can drive from nowhere.

        Raises:
            UnknownControllerError: There is no path tracker of that name.
            InvalidValueError: The start index is out of range or leaves no path, or the vehicle
                cannot drive the cruise speed.
        """
        check_controller(controller)
        check_start(path, start_index)
        check_cruise(speed_mps, self._limits)

    def _why_not_driven(self, task: Task, newest: Task) -> str:
        """Return why a task of an earlier run cannot go on, in words; empty: it can."""
        if task is not newest:
            return "how it ended was not written down"
        try:
            self._check_drivable(task.path, task.start_index, task.controller, task.speed_mps)
        except PilothouseError as error:
            return error.message
        return ""

    def _nearest(self, path: Path) -> tuple[int, float] | None:
        """Return index and distance, in m, of the nearest waypoint at which a task may begin."""
        state = self._vehicle.view.state
        if state is None:
            return None
        x, y = path.waypoints[:-1, 0], path.waypoints[:-1, 1]
        distances = np.hypot(x - state.pose.x_m, y - state.pose.y_m)
        index = int(distances.argmin())
        away_m = float(distances[index])
        return (index, away_m) if away_m <= self._settings.max_start_distance_m else None

    def _too_far(self, start: Point) -> float | None:
        """Return the distance to the start of a path, in m, if it is too large; else None."""
        distance = self._vehicle.distance_to(start)
        limit_m = self._settings.max_start_distance_m
        return distance if distance is not None and distance > limit_m else None
