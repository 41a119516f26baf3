"""The record of a task."""

from dataclasses import dataclass

from domain.identifiers import GoalId, TaskId
from domain.inputs import GoalFeedback
from domain.paths.path import Path
from domain.snapshot import TaskPhase, TaskView
from domain.timebase import Instant
from domain.vehicle import VehicleState


@dataclass(slots=True)
class Task:
    """One path to follow, and the progress on it."""

    id: TaskId
    path: Path
    controller: str
    speed_mps: float
    start_index: int
    created_at: Instant
    cause: int
    phase: TaskPhase = TaskPhase.PAUSED
    goal: GoalId | None = None
    """The goal that navigation is following; None: none of this task."""
    stopping: GoalId | None = None
    """The goal that was preempted last: what the vehicle rolls over while it stops is driven."""
    has_run: bool = False
    target_index: int = 0
    distance_m: float = 0.0
    cross_track_error_m: float | None = None
    left_out_m: float = 0.0
    """Length of the path behind the vehicle that it never came near, in m."""
    reason: str | None = None
    ended_at: Instant | None = None
    seen: VehicleState | None = None
    """The vehicle when the progress was updated last; None: that was never."""

    def __post_init__(self) -> None:
        self.target_index = self.start_index

    @property
    def length_m(self) -> float:
        """Return the length of the path from the start of the task."""
        return self.path.length_m - self.path.distance_of(self.start_index)

    @property
    def reached_m(self) -> float:
        """Return the distance reached along the path, from waypoint 0."""
        return self.path.distance_of(self.start_index) + self.distance_m

    def advance(self, feedback: GoalFeedback, seen: VehicleState | None) -> None:
        """Update the progress, which never goes backwards, with the vehicle as it is seen now."""
        begun = self.path.distance_of(self.start_index)
        self.target_index = max(self.target_index, feedback.target_index)
        self.distance_m = max(self.distance_m, feedback.distance_m - begun)
        self.cross_track_error_m = feedback.cross_track_error_m
        self.left_out_m = feedback.left_out_m
        self.seen = seen

    def end(self, phase: TaskPhase, reason: str | None, now: Instant) -> None:
        """Record the end of the task."""
        self.phase, self.reason, self.ended_at = phase, reason, now
        self.goal = self.stopping = None

    def view(self) -> TaskView:
        """Return this task as it is now."""
        done = self.phase is TaskPhase.SUCCEEDED
        return TaskView(
            id=self.id,
            status=self.phase,
            controller=self.controller,
            speed_mps=self.speed_mps,
            waypoint_count=self.path.count,
            length_m=self.length_m,
            start_index=self.start_index,
            target_index=self.target_index,
            progress=1.0 if done else min(self.distance_m / self.length_m, 1.0),
            distance_m=self.distance_m,
            cross_track_error_m=self.cross_track_error_m,
            reason=self.reason,
            created_at=self.created_at,
            ended_at=self.ended_at,
            cause=self.cause,
        )
