"""What a controller says of its progress, as far as the pose of the vehicle bears it out."""

from math import hypot, isfinite

from domain.paths.path import Path
from domain.timebase import Instant
from domain.tracking.coverage import Coverage
from domain.tracking.line_watch import GivenUpError, LegLimits, LineWatch
from domain.vehicle import VehicleState

COVERED_SHARE = 0.95
"""A goal succeeds only if more than this share of the length is covered."""

_WHOLE = 1.001
"""A share is rounded on its way."""


class ClaimedProgress:
    """Progress along a path that both the controller and the pose of the vehicle confirm."""

    def __init__(
        self,
        coverage: Coverage,
        first_index: int,
        start_index: int,
        claim_tolerance_m: float,
        now: Instant,
    ) -> None:
        """Begin.

        Args:
            coverage: Of the path, as far as it was driven before.
            first_index: Waypoint at which the task began.
            start_index: First waypoint not yet passed.
            claim_tolerance_m: How far ahead of the vehicle a waypoint may be, m, that is said to be
                passed.
            now: The current time.
        """
        self._path: Path = coverage.path
        self._coverage = coverage
        self._begun_m = self._path.distance_of(first_index)
        self._start_index = self._claimed = start_index
        self._claim_tolerance_m = claim_tolerance_m
        self._watch = LineWatch("the path", now)
        self._was_near = False
        """Whether the vehicle was on the path already, and not only on its way to it."""
        self.target_index = start_index
        """First waypoint that is not known to be passed."""
        self.distance_m = coverage.reached_m
        """Confirmed distance along the path, m."""
        self.error_m = 0.0
        """Cross-track error, m."""

    @property
    def left_out_m(self) -> float:
        """Return the length of the path that the vehicle never came near, m."""
        return self._coverage.left_out_m

    def claim(self, target_index: int, progress: float, state: VehicleState) -> None:
        """Take what the controller says.

        Args:
            target_index: First waypoint that is not yet passed.
            progress: Share of the path that was driven, 0 to 1.
            state: Of the vehicle.

        Raises:
            GivenUpError: It cannot be true.
        """
        if not (isfinite(progress) and 0.0 <= progress <= _WHOLE):
            raise GivenUpError(f"the controller says that its progress is {progress:g}")
        if target_index >= self._path.count:
            count = self._path.count
            raise GivenUpError(f"the controller drives to waypoint {target_index} of {count}")
        if target_index < self._claimed:
            words = f"went back from waypoint {self._claimed} to {target_index}"
            raise GivenUpError(f"the controller {words}")
        if target_index > self._start_index:
            here = self._path.project(state.pose.x_m, state.pose.y_m, self.target_index)
            ahead_m = self._path.distance_of(target_index - 1) - here.distance_m
            if ahead_m > self._claim_tolerance_m:
                words = f"passed waypoint {target_index - 1}, which is {ahead_m:.1f} m ahead of the"
                raise GivenUpError(f"the controller says that it {words} vehicle")
        self._claimed = target_index

    def follow(self, state: VehicleState, limits: LegLimits, now: Instant) -> None:
        """Note where the vehicle is while the controller drives it.

        Raises:
            GivenUpError: A limit was reached.
        """
        self._note(state, self._path.distance_of(self._claimed), self._claimed)
        self._was_near = self._was_near or abs(self.error_m) <= limits.max_cross_track_m
        self._watch.judge(self.error_m if self._was_near else 0.0, self.distance_m, limits, now)

    def roll(self, state: VehicleState) -> None:
        """Note where the vehicle is while it only stops: what it rolls over is driven."""
        self._note(state, self._path.length_m, self._path.count - 1)

    def why_not_arrived(self, state: VehicleState, tolerance_m: float) -> str:
        """Return in words why the end of the path is not reached; empty: it is.

        Args:
            state: Of the vehicle, at standstill.
            tolerance_m: Largest distance to the last waypoint, m.
        """
        self.roll(state)
        end = self._path.waypoint(self._path.count - 1)
        left_m = hypot(end.x_m - state.pose.x_m, end.y_m - state.pose.y_m)
        if left_m > tolerance_m:
            return f"the vehicle stands {left_m:.1f} m from the last waypoint"
        whole_m = self._path.length_m - self._begun_m
        driven_m = self.distance_m - self._begun_m - self.left_out_m
        if driven_m <= COVERED_SHARE * whole_m:
            return f"{whole_m - driven_m:.1f} m of the path were skipped"
        return ""

    def _note(self, state: VehicleState, most_m: float, most_index: int) -> None:
        here = self._path.project(state.pose.x_m, state.pose.y_m, self.target_index)
        self.error_m = here.cross_track_error_m
        self.distance_m = max(self.distance_m, min(here.distance_m, most_m))
        passed = min(self._path.index_after(self.distance_m), most_index)
        self.target_index = max(self.target_index, passed)
        self._coverage.note(state, self.distance_m)
