"""Events of the vehicle, its task and its holds."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from domain.events.event import Event, because
from domain.identifiers import GoalId, TaskId
from domain.snapshot import TaskPhase


@dataclass(frozen=True, slots=True)
class VehicleReported(Event):
    """The vehicle reports its pose and speed."""

    kind = "vehicle.reported"
    is_input = True
    is_notable = False

    x_m: float
    y_m: float
    speed_mps: float

    def _words(self) -> str:
        return f"vehicle at x {self.x_m:.2f} m, y {self.y_m:.2f} m, {self.speed_mps:.2f} m/s"


@dataclass(frozen=True, slots=True)
class DriveAvailable(Event):
    """Drive commands reach the vehicle again."""

    kind = "drive.available"
    is_input = True
    is_notable = False

    def _words(self) -> str:
        return "drive commands reach the vehicle"


@dataclass(frozen=True, slots=True)
class DriveUnavailable(Event):
    """Drive commands do not reach the vehicle."""

    kind = "drive.unavailable"
    is_input = True
    is_notable = False

    reason: str

    def _words(self) -> str:
        return because("drive commands do not reach the vehicle", self.reason)


@dataclass(frozen=True, slots=True)
class NavigationAvailable(Event):
    """The external controller can be given goals again."""

    kind = "navigation.available"
    is_input = True
    is_notable = False

    def _words(self) -> str:
        return "the external controller can be given goals"


@dataclass(frozen=True, slots=True)
class NavigationUnavailable(Event):
    """The external controller cannot be given goals, or does not give one up."""

    kind = "navigation.unavailable"
    is_input = True
    is_notable = False

    reason: str

    def _words(self) -> str:
        return because("the external controller is given no goals", self.reason)


@dataclass(frozen=True, slots=True)
class VehicleStillMoving(Event):
    """The vehicle should stand, and still moves after the time that its braking needs."""

    kind = "vehicle.still_moving"

    speed_mps: float
    after_s: float
    """Time since the stop began."""

    def _words(self) -> str:
        when = f"{self.after_s:.1f} s after the stop began"
        return f"the vehicle should stand, but moved at {self.speed_mps:.2f} m/s, {when}"


@dataclass(frozen=True, slots=True)
class VehicleStandstillUnknown(Event):
    """The vehicle should stand, but there is no pose that shows it."""

    kind = "vehicle.standstill_unknown"

    after_s: float
    """Time since the stop began."""

    def _words(self) -> str:
        when = f"{self.after_s:.1f} s after the stop began"
        return f"the vehicle should stand, but there was no pose to show it, {when}"


@dataclass(frozen=True, slots=True)
class VehicleStopped(Event):
    """The vehicle stands at last, after it was found moving, or was not known to stand."""

    kind = "vehicle.stopped"

    after_s: float
    """Time since the stop began."""

    def _words(self) -> str:
        return f"the vehicle stands, {self.after_s:.1f} s after the stop began"


@dataclass(frozen=True, slots=True)
class GoalProgressed(Event):
    """Navigation reports its progress towards a goal."""

    kind = "goal.feedback"
    is_input = True
    is_notable = False

    goal: GoalId

    def _words(self) -> str:
        return f"progress of goal {self.goal}"


@dataclass(frozen=True, slots=True)
class GoalEnded(Event):
    """Navigation ended its goal by itself."""

    kind = "goal.ended"
    is_input = True
    is_notable = False

    goal: GoalId
    succeeded: bool
    reason: str

    def _words(self) -> str:
        ending = "reached" if self.succeeded else "aborted"
        return because(f"goal {self.goal} {ending}", self.reason)


@dataclass(frozen=True, slots=True)
class TaskRequested(Event):
    """A task is submitted."""

    kind = "task.requested"
    is_input = True
    is_notable = False

    waypoints: int
    length_m: float
    start_index: int
    controller: str
    speed_mps: float

    def _words(self) -> str:
        path = f"{self.waypoints} waypoints, {self.length_m:.1f} m"
        return f"task requested: {path} by {self.controller} at {self.speed_mps:g} m/s"


@dataclass(frozen=True, slots=True)
class TaskCancelRequested(Event):
    """A cancel of the current task is requested."""

    kind = "task.cancel_requested"
    is_input = True
    is_notable = False

    def _words(self) -> str:
        return "cancel of the task requested"


@dataclass(frozen=True, slots=True)
class TaskServed(Event):
    """A task is accepted as the current one."""

    kind = "task.served"

    task: TaskId
    waypoints: int
    length_m: float

    def _words(self) -> str:
        return f"task {self.task} accepted, {self.length_m:.1f} m"


@dataclass(frozen=True, slots=True)
class _TaskDriven(Event):
    """Navigation received a goal of the task."""

    verb: ClassVar[str]

    task: TaskId
    goal: GoalId
    target_index: int

    def _words(self) -> str:
        return f"task {self.task} {self.verb}"


@dataclass(frozen=True, slots=True)
class TaskStarted(_TaskDriven):
    """The task starts to drive."""

    kind = "task.started"
    verb = "started"


@dataclass(frozen=True, slots=True)
class TaskResumed(_TaskDriven):
    """The task resumes from its target index."""

    kind = "task.resumed"
    verb = "resumed"


@dataclass(frozen=True, slots=True)
class _TaskHeld(Event):
    """The task is held."""

    verb: ClassVar[str]

    task: TaskId
    reason: str | None

    def _words(self) -> str:
        return because(f"task {self.task} {self.verb}", self.reason)


@dataclass(frozen=True, slots=True)
class TaskPausing(_TaskHeld):
    """The task is held, and the vehicle comes to a standstill."""

    kind = "task.pausing"
    verb = "pausing"


@dataclass(frozen=True, slots=True)
class TaskPaused(_TaskHeld):
    """The task is held, and the vehicle is at standstill."""

    kind = "task.paused"
    verb = "paused"


@dataclass(frozen=True, slots=True)
class _TaskEnded(Event):
    """The task ended."""

    phase: ClassVar[TaskPhase]

    task: TaskId
    reason: str | None
    progress: float

    def _words(self) -> str:
        ended = f"task {self.task} {self.phase.lower()} at {self.progress:.0%}"
        return because(ended, self.reason)


@dataclass(frozen=True, slots=True)
class TaskSucceeded(_TaskEnded):
    """The task succeeded: its path was driven to the end."""

    kind = "task.succeeded"
    phase = TaskPhase.SUCCEEDED


@dataclass(frozen=True, slots=True)
class TaskCanceled(_TaskEnded):
    """The task was canceled or replaced."""

    kind = "task.canceled"
    phase = TaskPhase.CANCELED


@dataclass(frozen=True, slots=True)
class TaskAborted(_TaskEnded):
    """The task was aborted, for a reason."""

    kind = "task.aborted"
    phase = TaskPhase.ABORTED


TASK_ENDS: Mapping[TaskPhase, type[_TaskEnded]] = {
    end.phase: end for end in (TaskSucceeded, TaskCanceled, TaskAborted)
}


@dataclass(frozen=True, slots=True)
class HoldRequested(Event):
    """A hold is requested."""

    kind = "hold.requested"
    is_input = True
    is_notable = False

    owner: str
    reason: str

    def _words(self) -> str:
        return because(f"hold {self.owner} requested", self.reason)


@dataclass(frozen=True, slots=True)
class HoldReleaseRequested(Event):
    """The release of a hold is requested."""

    kind = "hold.release_requested"
    is_input = True
    is_notable = False

    owner: str

    def _words(self) -> str:
        return f"release of hold {self.owner} requested"


@dataclass(frozen=True, slots=True)
class HoldSet(Event):
    """A hold is set: no task runs until it is released."""

    kind = "hold.set"

    owner: str
    reason: str

    def _words(self) -> str:
        return because(f"hold {self.owner} set", self.reason)


@dataclass(frozen=True, slots=True)
class HoldReleased(Event):
    """A hold is released."""

    kind = "hold.released"

    owner: str

    def _words(self) -> str:
        return f"hold {self.owner} released"
