"""Settings of tasks."""

from dataclasses import dataclass

from domain.timebase import Duration, seconds


@dataclass(frozen=True, slots=True)
class TaskSettings:
    """When a task may begin, and when the vehicle counts as lost or as standing."""

    max_start_distance_m: float = 5.0
    """Between the vehicle and the waypoint that a task begins with."""
    pose_stale_after: Duration = seconds(0.3)
    """A pose that is older holds the task."""
    standstill_mps: float = 0.05
    """Below this the vehicle stands still."""
