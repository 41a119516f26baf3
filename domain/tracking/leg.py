"""One line that a vehicle follows, up to the limits of its error and of time without progress."""

from math import isfinite

from domain.paths.path import Path
from domain.timebase import Instant
from domain.tracking.line_watch import GivenUpError, LegLimits, LineWatch
from domain.tracking.tracker import ControlStep, PathTracker
from domain.vehicle import VehicleState


class Leg:
    """A line, the tracker that follows it, and how far it came."""

    def __init__(
        self,
        path: Path,
        name: str,
        controller: str,
        tracker: PathTracker,
        target_index: int,
        now: Instant,
    ) -> None:
        """Begin.

        Args:
            path: The line.
            name: Of the line, for a person: "the path".
            controller: Name of the tracker.
            tracker: Steers along the line.
            target_index: First waypoint not yet passed.
            now: The current time.
        """
        self.path = path
        self._controller = controller
        self._tracker = tracker
        self._target_index = target_index
        self.distance_m = 0.0
        """Distance of the vehicle along the line, m."""
        self._watch = LineWatch(name, now)

    def follow(self, state: VehicleState) -> ControlStep:
        """Do one control step.

        Raises:
            GivenUpError: The tracker fails, or commands what is not a number.
        """
        try:
            step = self._tracker.control_step(state, self.path, self._target_index)
        except Exception as error:
            # Trackers may be third-party code: a fault aborts the goal, not the supervision.
            kind = type(error).__name__
            raise GivenUpError(f"{self._controller} failed: {kind}: {error}") from error
        if not isfinite(step.steering_angle_rad):
            raise GivenUpError(f"{self._controller} commands a steering angle that is not finite")
        self._target_index, self.distance_m = step.target_index, step.distance_m
        return step

    def judge(self, step: ControlStep, limits: LegLimits, now: Instant) -> None:
        """Give up a line that the vehicle does not follow.

        Raises:
            GivenUpError: A limit was reached.
        """
        self._watch.judge(step.cross_track_error_m, step.distance_m, limits, now)
