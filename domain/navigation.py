"""Follows one path at a time, like an action server: goal, feedback, preemption, result.

Deterministic and advanced like the simulated robot. The task planner decides whether to drive;
navigation aborts a goal only when a limit is reached. No drive command follows a preemption.

Source: smart_polaris, `controller_action_interface.py`; limits: docs/explanation/semantics.md.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from domain.commands import Drive, PreemptGoal, SendGoal
from domain.inputs import GoalFeedback, GoalResult
from domain.paths.speed_profile import SpeedLimits, SpeedProfile
from domain.tasks.vehicle_watch import VehicleWatch
from domain.timebase import Duration, Instant, seconds, to_seconds
from domain.tracking.tracker import ControlStep, PathTracker
from domain.tracking.trackers import TRACKERS
from domain.vehicle import DriveCommand, VehicleLimits, VehicleState

PERIOD: Duration = seconds(0.05)
"""Period of the control loop."""

COVERED_SHARE = 0.95
"""A goal succeeds only if more than this share of the length is covered."""

NavigationMessage: TypeAlias = Drive | GoalFeedback | GoalResult
Trackers: TypeAlias = Mapping[str, Callable[[VehicleLimits], PathTracker]]


@dataclass(frozen=True, slots=True)
class NavigationSettings:
    """Limits at which a goal is aborted, and speed limits."""

    max_cross_track_m: float = 3.0
    max_cross_track_for: Duration = seconds(1.0)
    """A cross-track error above `max_cross_track_m` for this long aborts the goal."""
    no_progress_for: Duration = seconds(20.0)
    """This long without `least_progress_m` of progress aborts the goal."""
    least_progress_m: float = 0.05
    end_tolerance_m: float = 0.3
    """A standstill within this distance of the last waypoint counts as arrival."""
    speed: SpeedLimits = field(default_factory=SpeedLimits)


@dataclass(slots=True)
class _Run:
    """One goal while it is followed."""

    goal: SendGoal
    tracker: PathTracker
    profile: SpeedProfile
    next_at: Instant
    target_index: int
    speed_mps: float
    """Last commanded speed; the next one exceeds it by no more than the acceleration allows."""
    best_m: float
    """Largest distance along the path that counted as progress."""
    best_at: Instant
    reached_m: float
    """Distance along the path up to which passed and skipped stretches are known."""
    left_out_m: float
    """Total length of stretches that were further away than `max_cross_track_m`."""
    off_path_since: Instant | None = None


_PASSED_STEP_M = 0.25


class _GivenUpError(Exception):
    """The goal is aborted; the message says why."""


class Navigation:
    """Navigation of one vehicle; a new goal replaces the current one.

    `now` must never decrease from call to call.
    """

    def __init__(
        self,
        limits: VehicleLimits,
        settings: NavigationSettings,
        vehicle: VehicleWatch,
        trackers: Trackers = TRACKERS,
    ) -> None:
        """Begin without a goal.

        Args:
            limits: Limits of the vehicle.
            settings: Limits at which a goal is aborted, and speed limits.
            vehicle: The vehicle state that the supervision holds.
            trackers: Path trackers by name.
        """
        self._limits = limits
        self.settings = settings
        self._vehicle = vehicle
        self._trackers = trackers
        self._run: _Run | None = None

    def handle(self, command: SendGoal | PreemptGoal, now: Instant) -> None:
        """Accept a goal, whose first control step is due at once, or preempt it."""
        if isinstance(command, SendGoal):
            self._begin(command, now)
        elif self._run is not None and self._run.goal.goal == command.goal:
            self._run = None

    def _begin(self, goal: SendGoal, now: Instant) -> None:
        state = self._vehicle.state
        speed = 0.0 if state is None else max(state.speed_mps, 0.0)
        self._run = _Run(
            goal=goal,
            tracker=self._trackers[goal.controller](self._limits),
            profile=SpeedProfile(goal.path, goal.speed_mps, self.settings.speed, self._limits),
            next_at=now,
            target_index=goal.start_index,
            speed_mps=speed,
            best_m=-math.inf,
            best_at=now,
            reached_m=max(goal.reached_m, goal.path.distance_of(goal.first_index)),
            left_out_m=goal.left_out_m,
        )

    def wake_at(self) -> Instant | None:
        """Return when the next control step is due; None: there is no goal."""
        return None if self._run is None else self._run.next_at

    def advance(self, now: Instant) -> tuple[NavigationMessage, ...]:
        """Do the control step that is due by `now`, if any; missed steps are not made up for."""
        run = self._run
        if run is None or run.next_at > now:
            return ()
        self.skip_missed(now)
        try:
            return self._control(run, now)
        except _GivenUpError as error:
            self._run = None
            return (GoalResult(run.goal.goal, succeeded=False, reason=str(error)),)

    def skip_missed(self, now: Instant) -> None:
        """Do the next control step after `now`, at a time of the same raster."""
        run = self._run
        if run is not None and run.next_at <= now:
            run.next_at += ((now - run.next_at) // PERIOD + 1) * PERIOD

    def _control(self, run: _Run, now: Instant) -> tuple[NavigationMessage, ...]:
        """Do one control step.

        Raises:
            _GivenUpError: A limit was reached.
        """
        state = self._fresh_state(now)
        step = self._steer(run, state)
        self._judge(run, step, now)
        self._note_passed(run, step, state)
        run.target_index = step.target_index
        command = self._command(run, step)
        feedback = GoalFeedback(
            run.goal.goal,
            step.target_index,
            step.distance_m,
            step.cross_track_error_m,
            step.lookahead,
            command,
            run.left_out_m,
        )
        if self._has_arrived(run, step, state):
            self._run = None
            return feedback, GoalResult(run.goal.goal, succeeded=True)
        return Drive(command), feedback

    def _fresh_state(self, now: Instant) -> VehicleState:
        state = self._vehicle.fresh_state(now)
        if state is None:
            limit_s = to_seconds(self._vehicle.settings.pose_stale_after)
            raise _GivenUpError(f"no pose of the vehicle for {limit_s:g} s")
        return state

    def _steer(self, run: _Run, state: VehicleState) -> ControlStep:
        """Ask the tracker; an exception or an invalid answer aborts the goal."""
        try:
            step = run.tracker.control_step(state, run.goal.path, run.target_index)
        except Exception as error:
            # Trackers may be third-party code: a fault aborts the goal, not the supervision.
            kind = type(error).__name__
            raise _GivenUpError(f"{run.goal.controller} failed: {kind}: {error}") from error
        if not math.isfinite(step.steering_angle_rad):
            raise _GivenUpError(
                f"{run.goal.controller} commands a steering angle that is not finite"
            )
        return step

    def _judge(self, run: _Run, step: ControlStep, now: Instant) -> None:
        settings = self.settings
        if abs(step.cross_track_error_m) > settings.max_cross_track_m:
            if run.off_path_since is None:
                run.off_path_since = now
            elif now - run.off_path_since >= settings.max_cross_track_for:
                error_m = abs(step.cross_track_error_m)
                raise _GivenUpError(
                    f"{error_m:.1f} m from the path for "
                    f"{to_seconds(settings.max_cross_track_for):g} s"
                )
        else:
            run.off_path_since = None
        if step.distance_m >= run.best_m + settings.least_progress_m:
            run.best_m, run.best_at = step.distance_m, now
        elif now - run.best_at >= settings.no_progress_for:
            raise _GivenUpError(f"no progress for {to_seconds(settings.no_progress_for):g} s")

    def _note_passed(self, run: _Run, step: ControlStep, state: VehicleState) -> None:
        """Sort the path since the last step into passed and skipped stretches.

        A vehicle that cannot steer a hairpin is projected onto the path behind it: it skipped the
        hairpin.
        """
        path, pose = run.goal.path, state.pose
        while run.reached_m < step.distance_m:
            until_m = min(run.reached_m + _PASSED_STEP_M, step.distance_m)
            middle = path.point_at((run.reached_m + until_m) / 2)
            away_m = math.hypot(middle.x_m - pose.x_m, middle.y_m - pose.y_m)
            if away_m > self.settings.max_cross_track_m:
                run.left_out_m += until_m - run.reached_m
            run.reached_m = until_m

    def _command(self, run: _Run, step: ControlStep) -> DriveCommand:
        """Return steering within its limit, and a speed that rises no faster than allowed."""
        limit = self._limits.max_steering_angle_rad
        steering = min(max(step.steering_angle_rad, -limit), limit)
        gained = self.settings.speed.acceleration_mps2 * to_seconds(PERIOD)
        run.speed_mps = min(run.profile.speed_at(step.distance_m), run.speed_mps + gained)
        return DriveCommand(run.speed_mps, steering)

    def _has_arrived(self, run: _Run, step: ControlStep, state: VehicleState) -> bool:
        """Tell whether the goal is reached.

        Raises:
            _GivenUpError: The end is passed, but too much of the path was skipped.
        """
        path = run.goal.path
        begun = path.distance_of(run.goal.first_index)
        covered = (step.distance_m - begun - run.left_out_m) / (path.length_m - begun)
        is_past_end = step.distance_m >= path.length_m
        if covered <= COVERED_SHARE:
            if is_past_end:
                raise _GivenUpError(f"the end is passed, but {run.left_out_m:.1f} m were skipped")
            return False
        if is_past_end:
            return True
        end = path.waypoint(path.count - 1)
        left_m = math.hypot(end.x_m - state.pose.x_m, end.y_m - state.pose.y_m)
        return self._vehicle.stands and left_m <= self.settings.end_tolerance_m
