"""The interface of path trackers. A new one is a module beside this and a line in `trackers.py`."""

from dataclasses import dataclass
from typing import Protocol

from domain.paths.path import Path
from domain.vehicle import Point, VehicleState


@dataclass(frozen=True, slots=True)
class ControlStep:
    """The result of a tracker for one control period."""

    steering_angle_rad: float
    """Front wheel angle, left positive; finite and within the limit of the vehicle."""
    target_index: int
    """First waypoint not yet passed; never decreases from one step to the next."""
    distance_m: float
    """Distance of the vehicle along the path, from its first waypoint; m."""
    cross_track_error_m: float
    """Distance from the path; positive: the vehicle is left of it."""
    lookahead: Point
    """The point that the tracker steers to; m."""


class PathTracker(Protocol):
    """Steers along a path. Stateless, so that no state can outlive its task."""

    def control_step(self, state: VehicleState, path: Path, start_index: int) -> ControlStep:
        """Do one control step.

        Args:
            state: State of the vehicle; finite.
            path: The path to follow.
            start_index: First waypoint not yet passed, from the step before; the search goes
                forward from there within a window, never to the globally nearest point.
        """
        ...
