"""What every path tracker does; a new one is a file beside this and a line in `trackers.py`."""

from dataclasses import dataclass
from typing import Protocol

from domain.paths.path import Path
from domain.vehicle import Point, VehicleState


@dataclass(frozen=True, slots=True)
class ControlStep:
    """What a tracker says for one control period."""

    steering_angle_rad: float
    """Of the front wheels, left positive; finite, and within the limit of the vehicle."""
    target_index: int
    """First waypoint that is not yet passed; never falls from one step to the next."""
    distance_m: float
    """How far along the path the vehicle is, from its first waypoint; m."""
    cross_track_error_m: float
    """Distance from the path; positive: the vehicle is left of it."""
    lookahead: Point
    """The point that is steered to; m."""


class PathTracker(Protocol):
    """Steers along a path. It keeps nothing between steps, so that none can outlive its task."""

    def control_step(self, state: VehicleState, path: Path, start_index: int) -> ControlStep:
        """Steer towards `path` by one control period.

        Args:
            state: Of the vehicle; finite.
            path: What to follow.
            start_index: First waypoint not yet passed, as the step before said; the search begins
                there and goes forward within a window, never to the nearest point of all.
        """
        ...
