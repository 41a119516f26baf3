"""Settings of tasks."""

from dataclasses import dataclass

from domain.timebase import Duration, seconds


@dataclass(frozen=True, slots=True)
class TaskSettings:
    """When a task may begin, and when the vehicle counts as lost or at standstill."""

    max_start_distance_m: float = 5.0
    """Largest distance from the vehicle to the first waypoint of a task."""
    pose_stale_after: Duration = seconds(0.3)
    """A pose older than this holds the task."""
    standstill_mps: float = 0.05
    """Below this speed the vehicle counts as at standstill."""
    braking_mps2: float = 1.0
    """Deceleration that the vehicle is trusted with; a stop that takes longer is told."""
