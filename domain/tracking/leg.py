"""One line that a vehicle follows, up to the limits of its error and of time without progress."""

from dataclasses import dataclass
from math import inf, isfinite

from domain.paths.path import Path
from domain.timebase import Duration, Instant, to_seconds
from domain.tracking.tracker import ControlStep, PathTracker
from domain.vehicle import VehicleState


class GivenUpError(Exception):
    """The goal is aborted; the message says why."""


@dataclass(frozen=True, slots=True)
class LegLimits:
    """When a line is given up."""

    max_cross_track_m: float
    """Cross-track error, m, that is too large if it lasts."""
    max_cross_track_for: Duration
    no_progress_for: Duration
    """This long without `least_progress_m` of progress."""
    least_progress_m: float


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
        self._name = name
        self._controller = controller
        self._tracker = tracker
        self._target_index = target_index
        self.distance_m = 0.0
        """Distance of the vehicle along the line, m."""
        self._best_m = -inf
        """Largest distance along the line that counted as progress."""
        self._best_at = now
        self._off_since: Instant | None = None

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
        error_m = abs(step.cross_track_error_m)
        if error_m <= limits.max_cross_track_m:
            self._off_since = None
        elif self._off_since is None:
            self._off_since = now
        elif now - self._off_since >= limits.max_cross_track_for:
            long_s = to_seconds(limits.max_cross_track_for)
            raise GivenUpError(f"{error_m:.1f} m from {self._name} for {long_s:g} s")
        if step.distance_m >= self._best_m + limits.least_progress_m:
            self._best_m, self._best_at = step.distance_m, now
        elif now - self._best_at >= limits.no_progress_for:
            raise GivenUpError(f"no progress for {to_seconds(limits.no_progress_for):g} s")
