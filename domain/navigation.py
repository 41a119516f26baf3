"""Follows one path at a time, like an action server: goal, feedback, preemption, result.

Deterministic and advanced like the simulated robot. The task planner decides whether to drive;
navigation aborts a goal only when a limit is reached. After a preemption it stops the vehicle, and
steers along the path until the vehicle is at standstill: one that brakes in a bend with the wheels
held leaves its path.

Source: smart_polaris, `controller_action_interface.py`; limits: docs/explanation/semantics.md.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from domain.commands import Drive, PreemptGoal, SendGoal
from domain.inputs import GoalFeedback, GoalResult
from domain.paths.approach import (
    ALIGNED_RAD,
    MAY_MISS_SHARE,
    TURNED_RAD,
    Approach,
    ApproachLimits,
    FarFromPathError,
    approach_mps,
    approach_radius_m,
    is_on_path,
    near_path_m,
    on_path_m,
    plan_approach,
)
from domain.paths.path import Path
from domain.paths.speed_profile import SpeedLimits, SpeedProfile
from domain.tasks.kept_tasks import LOST_AT_MOST
from domain.tasks.vehicle_watch import VehicleWatch
from domain.timebase import Duration, Instant, seconds, to_seconds
from domain.tracking.coverage import Coverage
from domain.tracking.leg import Leg
from domain.tracking.line_watch import GivenUpError, LegLimits
from domain.tracking.pace import PERIOD, Pace
from domain.tracking.pure_pursuit import PurePursuit
from domain.tracking.slow_down import SlowDown, is_slow
from domain.tracking.tracker import ControlStep, PathTracker
from domain.tracking.trackers import TRACKERS
from domain.vehicle import DriveCommand, VehicleLimits, VehicleState

COVERED_SHARE = 0.95
"""A goal succeeds only if more than this share of the length is covered."""

NavigationMessage: TypeAlias = Drive | GoalFeedback | GoalResult
Trackers: TypeAlias = Mapping[str, Callable[[VehicleLimits], PathTracker]]


@dataclass(frozen=True, slots=True)
class NavigationSettings:
    """Limits at which a goal is aborted, and speed limits."""

    max_cross_track_m: float | None = None
    """Largest cross-track error, m; None: 3 m, less for a small vehicle."""
    max_cross_track_for: Duration = seconds(1.0)
    """A larger cross-track error for this long aborts the goal."""
    no_progress_for: Duration = seconds(20.0)
    """This long without `least_progress_m` of progress aborts the goal."""
    least_progress_m: float = 0.05
    end_tolerance_m: float = 0.3
    """A standstill within this distance, m, of the last waypoint counts as arrival; less for a
    small vehicle."""
    speed: SpeedLimits = field(default_factory=SpeedLimits)

    def cross_track_m(self, limits: VehicleLimits) -> float:
        """Return the largest cross-track error of a vehicle, m."""
        if self.max_cross_track_m is not None:
            return self.max_cross_track_m
        return near_path_m(limits)

    def leg_limits(self, limits: VehicleLimits) -> LegLimits:
        """Return when a vehicle is given up that does not follow its line."""
        return LegLimits(
            self.cross_track_m(limits),
            self.max_cross_track_for,
            self.no_progress_for,
            self.least_progress_m,
        )


_LEAST_END_TOLERANCE_M = 0.05
_LOOP_RADII = 4.0
"""An approach turns within this multiple of the radius of its arcs."""
_ROUNDING_M = 1e-6


@dataclass(slots=True)
class _Run:
    """One goal while it is followed."""

    goal: SendGoal
    path: Path
    """The path as the vehicle sees it."""
    profile: SpeedProfile
    pace: Pace
    coverage: Coverage
    next_at: Instant
    target_index: int
    """First waypoint not yet passed, also beside the path."""
    distance_m: float
    """Distance of the vehicle along the path, m."""
    leg: Leg | None = None
    """What is followed now: the path, or the way onto it; None: not yet known."""
    approach: Approach | None = None
    """The way onto the path; None: the vehicle is on it."""
    is_preempted: bool = False
    """Whether it only stops."""
    was_approaching: bool = False
    """Whether the goal that it takes up ended before the vehicle was on the path, or may have."""
    slow_down: SlowDown | None = None
    """It brakes, and its way onto the path begins thereafter."""
    rolled_m: float = 0.0
    """Length of the way on which it braked."""

    @property
    def is_approaching(self) -> bool:
        """Tell whether it is not yet on the path."""
        is_new = self.leg is None and self.was_approaching
        return self.approach is not None or self.slow_down is not None or is_new


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
        near_m = settings.cross_track_m(limits)
        self.approach_limits = ApproachLimits(
            limits, settings.speed, near_m, vehicle.settings.max_start_distance_m
        )
        """From where paths are approached, and how."""
        self._leg_limits = settings.leg_limits(limits)
        self._run: _Run | None = None
        self._preempted: _Run | None = None
        """The goal that was preempted last: what is known of its path still holds."""

    def handle(self, command: SendGoal | PreemptGoal, now: Instant) -> None:
        """Accept a goal, whose first control step is due at once, or preempt it."""
        if isinstance(command, SendGoal):
            self._begin(command, now)
        elif self._run is not None and self._run.goal.goal == command.goal:
            self._preempt(self._run)

    def _begin(self, goal: SendGoal, now: Instant) -> None:
        state = self._vehicle.state
        speed = 0.0 if state is None else max(state.speed_mps, 0.0)
        before = self._preempted
        if before is not None and not _goes_on(goal, before):
            before = self._preempted = None
        path = goal.path.for_vehicle(self._limits)
        reached_m = max(goal.reached_m, path.distance_of(goal.first_index))
        if before is None:
            coverage = self._coverage(goal, path, reached_m)
            was_approaching = self._goes_on_unseen(goal, coverage, state)
        else:
            coverage, was_approaching = before.coverage, before.is_approaching
        self._run = _Run(
            goal=goal,
            path=path,
            profile=SpeedProfile(path, goal.speed_mps, self.settings.speed, self._limits),
            pace=Pace(self.settings.speed, self._limits, speed),
            coverage=coverage,
            next_at=now,
            target_index=goal.start_index,
            distance_m=reached_m,
            was_approaching=was_approaching,
        )

    def _coverage(self, goal: SendGoal, path: Path, reached_m: float) -> Coverage:
        braking = min(self.settings.speed.braking_mps2, self._limits.braking_mps2 or math.inf)
        near_m = self.approach_limits.near_m
        return Coverage(path, reached_m, goal.left_out_m, near_m, braking)

    def _goes_on_unseen(
        self, goal: SendGoal, coverage: Coverage, state: VehicleState | None
    ) -> bool:
        """Take up what the vehicle drove while the service restarted.

        Returns:
            Whether it may have come to where it is by itself: it may also be beside the path then,
            since it stopped with its wheels as they were.
        """
        seen = goal.seen
        if seen is None or state is None:
            return False
        unseen_s = to_seconds(LOST_AT_MOST)
        gained_mps = self.settings.speed.acceleration_mps2 * unseen_s
        seen_mps = abs(seen.speed_mps)
        fastest_mps = max(min(seen_mps + gained_mps, goal.speed_mps), seen_mps)
        coverage.go_on_from(replace(seen, speed_mps=fastest_mps), unseen_s)
        return coverage.may_have_rolled(state)

    def _preempt(self, run: _Run) -> None:
        self._preempted, run.is_preempted = run, True
        if self._vehicle.stands or (run.leg is None and run.slow_down is None):
            self._run = None

    def wake_at(self) -> Instant | None:
        """Return when the next control step is due; None: there is no goal."""
        return None if self._run is None else self._run.next_at

    def advance(self, now: Instant) -> tuple[NavigationMessage, ...]:
        """Do the control step that is due by `now`, if any; missed steps are not made up for."""
        run = self._run
        if run is None or run.next_at > now:
            return ()
        self._skip_missed(now)
        try:
            return self._stop(run, now) if run.is_preempted else self._control(run, now)
        except GivenUpError as error:
            self._run = None
            if run.is_preempted:
                return ()
            return (GoalResult(run.goal.goal, succeeded=False, reason=str(error)),)

    def catch_up(self, now: Instant) -> tuple[NavigationMessage, ...]:
        """Do as `advance` does, while what is due is late by our own fault."""
        if self._vehicle.fresh_state(now) is None:
            # The pose is old by our own fault: that is no reason to give up a goal.
            self._skip_missed(now)
            return ()
        return self.advance(now)

    def _skip_missed(self, now: Instant) -> None:
        """Do the next control step after `now`, at a time of the same raster."""
        run = self._run
        if run is not None and run.next_at <= now:
            run.next_at += ((now - run.next_at) // PERIOD + 1) * PERIOD

    def _control(self, run: _Run, now: Instant) -> tuple[NavigationMessage, ...]:
        """Do one control step.

        Raises:
            GivenUpError: A limit was reached.
        """
        state = self._fresh_state(now)
        self._prepare(run, state, now)
        if run.slow_down is not None:
            return self._brake(run, run.slow_down, state, now)
        assert run.leg is not None
        step = run.leg.follow(state)
        run.leg.judge(step, self._leg_limits, now)
        error_m = self._locate(run, step, state)
        limit_mps = run.profile.speed_at(step.distance_m)
        if run.approach is not None:
            limit_mps = run.approach.speed_mps
        elif abs(error_m) > on_path_m(self._limits):
            limit_mps = min(limit_mps, run.pace.braked_mps(approach_mps(self._limits)))
        command = run.pace.command(
            limit_mps, step.steering_angle_rad, step.cross_track_error_m, state, now
        )
        feedback = _feedback(run, step, error_m, command)
        if run.approach is None and self._has_arrived(run, state):
            self._run = None
            return feedback, GoalResult(run.goal.goal, succeeded=True)
        return Drive(command), feedback

    def _brake(
        self, run: _Run, slow_down: SlowDown, state: VehicleState, now: Instant
    ) -> tuple[NavigationMessage, ...]:
        """Brake until the way onto the path can be driven.

        Raises:
            GivenUpError: The vehicle does not brake.
        """
        slow_down.judge(state, self.settings.no_progress_for, now)
        step, steering_rad = slow_down.follow(state)
        run.coverage.note(state, None)
        command = run.pace.command(slow_down.speed_mps, steering_rad, 0.0, state, now)
        return Drive(command), _feedback(run, step, step.cross_track_error_m, command)

    def _stop(self, run: _Run, now: Instant) -> tuple[NavigationMessage, ...]:
        """Steer along the path, without driving, until the vehicle is at standstill.

        Raises:
            GivenUpError: There is nothing to steer by.
        """
        state = self._fresh_state(now)
        if self._vehicle.stands:
            self._run = None
            return ()
        if run.slow_down is not None:
            run.coverage.note(state, None)
            step, steering_rad = run.slow_down.follow(state)
            error_m = step.cross_track_error_m
        else:
            assert run.leg is not None
            step = run.leg.follow(state)
            steering_rad = step.steering_angle_rad
            error_m = self._locate(run, step, state)
        command = run.pace.stop(steering_rad, state)
        return Drive(command), _feedback(run, step, error_m, command)

    def _fresh_state(self, now: Instant) -> VehicleState:
        state = self._vehicle.fresh_state(now)
        if state is None:
            limit_s = to_seconds(self._vehicle.settings.pose_stale_after)
            raise GivenUpError(f"no pose of the vehicle for {limit_s:g} s")
        return state

    # --- what is followed ------------------------------------------------------------------------

    def _prepare(self, run: _Run, state: VehicleState, now: Instant) -> None:
        """Decide what is followed now: the way onto the path, and then the path.

        Raises:
            GivenUpError: The vehicle is too far from the path.
        """
        if run.slow_down is not None:
            if not run.slow_down.is_over(state):
                return
            run.rolled_m, run.slow_down = run.rolled_m + run.slow_down.rolled_m(state), None
        if run.leg is None:
            self._take_up(run, state)
            run.approach = self._plan(run, state)
            if run.approach is not None:
                self._begin_approach(run, run.approach, state, now)
        elif run.approach is not None and self._is_there(run, run.approach, run.leg, state):
            run.leg = run.approach = None
        if run.leg is None and run.slow_down is None:
            run.leg = self._leg_along_the_path(run, now)

    def _begin_approach(
        self, run: _Run, approach: Approach, state: VehicleState, now: Instant
    ) -> None:
        if is_slow(state, approach.speed_mps):
            run.leg = self._leg_onto_the_path(approach, now)
            return
        leg = self._leg_along_the_path(run, now)
        run.slow_down, run.approach = SlowDown(leg, approach.speed_mps, state, now), None

    def _leg_along_the_path(self, run: _Run, now: Instant) -> Leg:
        name = run.goal.controller
        tracker = self._trackers[name](self._limits)
        return Leg(run.path, "the path", name, tracker, run.target_index, now)

    def _leg_onto_the_path(self, approach: Approach, now: Instant) -> Leg:
        # Whatever tracker the task has: this one also follows tight curves with slow wheels.
        tracker = PurePursuit(self._limits)
        return Leg(approach.way, "its way onto the path", "pure_pursuit", tracker, 0, now)

    def _take_up(self, run: _Run, state: VehicleState) -> None:
        """Find a vehicle that passed its path unseen, or while it braked, further on along it."""
        has_jumped = run.coverage.least_missed_m(state) > _may_miss_m(run)
        run.coverage.note(state, None)
        if has_jumped:
            return
        pose, index = state.pose, run.target_index
        here = run.path.project(pose.x_m, pose.y_m, index)
        # A projection searches ahead within a window.
        while (ahead := run.path.index_after(here.distance_m)) > index:
            index = ahead
            here = run.path.project(pose.x_m, pose.y_m, index)
        missed_m = run.coverage.missed_m(here.distance_m)
        if is_on_path(here, pose, self._limits, TURNED_RAD) and missed_m <= _may_miss_m(run):
            run.coverage.note(state, here.distance_m)
            run.target_index, run.distance_m = index, max(run.distance_m, here.distance_m)

    def _plan(self, run: _Run, state: VehicleState) -> Approach | None:
        """Return the way onto the path; None: the vehicle is on it.

        Raises:
            GivenUpError: The vehicle is too far from the path.
        """
        limits, from_m = self.approach_limits, self.approach_limits.from_m + run.rolled_m
        if run.was_approaching:
            from_m += _LOOP_RADII * approach_radius_m(self._limits)
        try:
            return plan_approach(
                run.path,
                state.pose,
                run.target_index,
                run.coverage.reached_m,
                run.goal.speed_mps,
                _may_miss_m(run),
                replace(limits, from_m=from_m),
            )
        except FarFromPathError as error:
            message = f"{error}, which is approached from at most {limits.from_m:g} m"
            raise GivenUpError(message) from error

    def _is_there(self, run: _Run, approach: Approach, leg: Leg, state: VehicleState) -> bool:
        """Tell whether the way onto the path has been driven."""
        if leg.distance_m < approach.length_m:
            return False
        pose = state.pose
        here = run.path.project(pose.x_m, pose.y_m, run.target_index)
        is_there = is_on_path(here, pose, self._limits, ALIGNED_RAD)
        return is_there or leg.distance_m >= leg.path.length_m

    # --- where the vehicle is --------------------------------------------------------------------

    def _locate(self, run: _Run, step: ControlStep, state: VehicleState) -> float:
        """Note what was passed of the path; return the cross-track error, m."""
        if run.approach is None:
            run.target_index, run.distance_m = step.target_index, step.distance_m
            run.coverage.note(state, step.distance_m)
            return step.cross_track_error_m
        run.coverage.note(state, None)
        here = run.path.project(state.pose.x_m, state.pose.y_m, run.target_index)
        # A loop of the way may come near to the path further on than where it meets it.
        along_m = max(step.distance_m - run.approach.length_m, 0.0)
        most_m = run.approach.meets_m + along_m
        run.distance_m = max(run.distance_m, min(here.distance_m, most_m))
        run.target_index = run.path.index_after(run.distance_m)
        return here.cross_track_error_m

    def _has_arrived(self, run: _Run, state: VehicleState) -> bool:
        """Tell whether the goal is reached.

        Raises:
            GivenUpError: The end is passed, but too much of the path was left out.
        """
        path, left_out_m = run.path, run.coverage.left_out_m
        begun = path.distance_of(run.goal.first_index)
        covered = (run.distance_m - begun - left_out_m) / (path.length_m - begun)
        is_past_end = run.distance_m >= path.length_m
        if covered <= COVERED_SHARE:
            if is_past_end:
                raise GivenUpError(f"the end is passed, but {left_out_m:.1f} m were skipped")
            return False
        if is_past_end:
            return True
        end = path.waypoint(path.count - 1)
        left_m = math.hypot(end.x_m - state.pose.x_m, end.y_m - state.pose.y_m)
        tolerance_m = self.settings.end_tolerance_m * min(self._limits.scale, 1.0)
        return self._vehicle.stands and left_m <= max(tolerance_m, _LEAST_END_TOLERANCE_M)


def _goes_on(goal: SendGoal, before: _Run) -> bool:
    """Tell whether a goal takes up the one that was preempted before."""
    is_same = goal.path is before.goal.path and goal.first_index == before.goal.first_index
    return is_same and goal.reached_m >= before.coverage.reached_m - _ROUNDING_M


def _may_miss_m(run: _Run) -> float:
    """Return the length of the path that may still be missing, m."""
    whole_m = run.path.length_m - run.path.distance_of(run.goal.first_index)
    return max(MAY_MISS_SHARE * whole_m - run.coverage.left_out_m, 0.0)


def _feedback(run: _Run, step: ControlStep, error_m: float, command: DriveCommand) -> GoalFeedback:
    return GoalFeedback(
        run.goal.goal,
        run.target_index,
        run.distance_m,
        error_m,
        step.lookahead,
        command,
        run.coverage.left_out_m,
    )
