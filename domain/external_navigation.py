"""Has an external controller follow one path at a time, and judges it like one on board.

The controller commands the vehicle itself. What it says of its progress counts only as far as the
pose of the vehicle bears it out. A goal is taken back by asking for it *and* by commanding speed 0,
until the vehicle is at standstill and the controller has confirmed the end of the goal; only then
it gets another one.

Deterministic and advanced like `Navigation`, in whose place it is; see docs/decisions/0059.
"""

import math
from dataclasses import dataclass
from typing import TypeAlias

from domain.commands import Drive, PreemptGoal, SendGoal
from domain.controller import (
    ControllerAnswer,
    ControllerFeedback,
    ControllerMessage,
    ControllerResult,
    ControllerSettings,
    ControllerStatus,
    GoalOutcome,
    NavigationStatus,
)
from domain.inputs import GoalFeedback, GoalResult
from domain.navigation import NavigationSettings
from domain.paths.approach import ApproachLimits
from domain.tasks.kept_tasks import LOST_AT_MOST
from domain.tasks.vehicle_watch import VehicleWatch
from domain.timebase import Duration, Instant, seconds, to_seconds
from domain.tracking.claimed_progress import ClaimedProgress
from domain.tracking.coverage import Coverage
from domain.tracking.line_watch import GivenUpError
from domain.tracking.pace import PERIOD
from domain.vehicle import VehicleLimits

TRIES = 3
"""After so many goals in a row of which nothing was reported the task is aborted."""

SUSPECT_FOR: Duration = seconds(3.0)
"""For so long after it said falsely that it arrived, a controller must not move the vehicle."""

ExternalMessage: TypeAlias = (
    Drive | SendGoal | PreemptGoal | GoalFeedback | GoalResult | NavigationStatus
)


@dataclass(slots=True)
class _Run:
    """One goal that the controller has, or may have."""

    goal: SendGoal
    progress: ClaimedProgress
    heard_at: Instant
    """When it was sent, accepted, or had feedback last."""
    is_accepted: bool = False
    has_reported: bool = False
    taken_back_at: Instant | None = None
    """When the controller was asked last to end it; None: it may drive."""
    confirmed_by: Instant = 0
    """When it is asked again, and that is told."""
    slowest_mps: float = math.inf
    """Least speed since then, without its sign."""
    brakes_until: Instant = 0
    """So long the vehicle may need to stop."""
    said_arrived_at: Instant | None = None
    """When the controller said that it reached the end; None: it did not."""
    fault: str = ""
    """Why no other goal is sent until this one has ended; empty: the controller works."""
    is_overdue: bool = False
    """Whether the controller did not confirm in time that this goal has ended."""


class ExternalNavigation:
    """Navigation of one vehicle by a controller in a program of its own.

    `now` must never decrease from call to call.
    """

    def __init__(
        self,
        limits: VehicleLimits,
        settings: NavigationSettings,
        controller: ControllerSettings,
        vehicle: VehicleWatch,
        start: Instant,
    ) -> None:
        """Begin without a controller, and so without a goal.

        Args:
            limits: Limits of the vehicle.
            settings: Limits at which a goal is aborted.
            controller: Its deadlines.
            vehicle: The vehicle state that the supervision holds.
            start: The current time.
        """
        self._limits = limits
        self.settings = settings
        self._controller = controller
        self._vehicle = vehicle
        near_m = settings.cross_track_m(limits)
        self.approach_limits = ApproachLimits(
            limits, settings.speed, near_m, vehicle.settings.max_start_distance_m
        )
        """From where a path may begin."""
        self._leg_limits = settings.leg_limits(limits)
        self._run: _Run | None = None
        self._rolling: _Run | None = None
        """The goal that ended last, as long as the vehicle rolls on."""
        self._waiting: SendGoal | None = None
        """The goal that is sent once the one before has ended."""
        self._futile = 0
        """Goals in a row of which the controller reported nothing."""
        self._suspect_until: Instant | None = None
        """Until then the vehicle must not move without a goal; None: it may."""
        self._rogue = ""
        """Why the controller gets no goal until it is started again; empty: it gets one."""
        self._is_stopping = False
        self._next_at = start
        """Next time of the raster."""
        self._absent = f"no controller was seen at {controller.name} yet"
        """Why there is no controller; empty: there is one."""
        self._told: str | None = None
        """What was told of it last; None: nothing yet."""
        self._said: list[ExternalMessage] = []
        """What was decided and is not yet passed on."""

    # --- what happens ----------------------------------------------------------------------------

    def handle(self, command: SendGoal | PreemptGoal, now: Instant) -> None:
        """Send a goal, once the one before has ended, or take it back."""
        if isinstance(command, SendGoal):
            if self._run is not None and self._run.taken_back_at is None:
                self._take_back(self._run, now)
            self._waiting = command
            self._send_waiting(now)
        elif self._waiting is not None and self._waiting.goal == command.goal:
            self._waiting = None
        elif self._run is not None and self._run.goal.goal == command.goal:
            self._take_back(self._run, now)

    def take(self, given: ControllerMessage, now: Instant) -> None:
        """Take what the controller, or whoever watches it, says."""
        if isinstance(given, ControllerStatus):
            self._take_status(given, now)
        elif (run := self._run) is not None and run.goal.goal == given.goal:
            if isinstance(given, ControllerAnswer):
                self._take_answer(run, given, now)
            elif isinstance(given, ControllerFeedback):
                self._take_feedback(run, given, now)
            else:
                self._take_result(run, given, now)
        self._tell()

    def wake_at(self) -> Instant | None:
        """Return when something has to be commanded or judged next; None: there is no goal."""
        is_idle = self._run is None and self._suspect_until is None and not self._is_stopping
        return None if is_idle and self._told is not None and not self._said else self._next_at

    def advance(self, now: Instant) -> tuple[ExternalMessage, ...]:
        """Command and judge what is due by `now`; return it with what was decided before."""
        if self._next_at <= now:
            self._next_at += ((now - self._next_at) // PERIOD + 1) * PERIOD
            self._step(now)
            self._tell()
        return self.catch_up(now)

    def catch_up(self, _: Instant) -> tuple[ExternalMessage, ...]:
        """Return what was decided, and judge no deadline: we are late by our own fault."""
        said, self._said = self._said, []
        return tuple(said)

    # --- goals -----------------------------------------------------------------------------------

    def _send_waiting(self, now: Instant) -> None:
        goal = self._waiting
        if goal is None or self._run is not None or self._absent or self._rogue:
            return
        self._waiting, self._rolling, self._is_stopping = None, None, False
        self._suspect_until = None
        self._run = _Run(goal, self._progress_of(goal, now), now)
        self._next_at = now + PERIOD
        self._said.append(goal)

    def _progress_of(self, goal: SendGoal, now: Instant) -> ClaimedProgress:
        path = goal.path.for_vehicle(self._limits)
        reached_m = max(goal.reached_m, path.distance_of(goal.first_index))
        braking = min(self.settings.speed.braking_mps2, self._limits.braking_mps2 or math.inf)
        near_m = self.approach_limits.near_m
        coverage = Coverage(path, reached_m, goal.left_out_m, near_m, braking)
        if goal.seen is not None:
            coverage.go_on_from(goal.seen, to_seconds(LOST_AT_MOST))
        tolerance_m = self._controller.claim_tolerance_m
        return ClaimedProgress(coverage, goal.first_index, goal.start_index, tolerance_m, now)

    def _take_back(self, run: _Run, now: Instant) -> None:
        """Stop the vehicle, and ask the controller to end a goal."""
        if run.taken_back_at is not None:
            return
        self._stop(now)
        if run.said_arrived_at is not None:
            self._end(run, now)
            return
        self._ask_for_end(run, now)

    def _ask_for_end(self, run: _Run, now: Instant) -> None:
        run.taken_back_at, run.slowest_mps = now, math.inf
        run.confirmed_by = now + self._controller.taken_back_within
        run.brakes_until = now + self._vehicle.braking_time()
        self._said.append(PreemptGoal(run.goal.goal))

    def _stop(self, now: Instant) -> None:
        """Command speed 0, and again with each step until the vehicle is known to stand."""
        if not self._is_stopping:
            self._is_stopping = True
            self._next_at = now + PERIOD
        self._said.append(Drive(self._vehicle.stop_command()))

    def _give_up(self, run: _Run, reason: str, now: Instant) -> None:
        """Abort a goal that the controller may still drive."""
        self._take_back(run, now)
        self._said.append(GoalResult(run.goal.goal, succeeded=False, reason=reason))

    def _distrust(self, run: _Run, reason: str, now: Instant) -> None:
        """Take back a goal that may not be driven, and send none until it has ended."""
        if self._futile >= TRIES - 1:
            # Else it would be sent again and again to one that never reports anything.
            self._futile = 0
            self._give_up(run, reason, now)
        else:
            run.fault = reason
            self._take_back(run, now)

    def _end(self, run: _Run, now: Instant) -> None:
        """Note that the controller does not have a goal any more."""
        self._run, self._rolling = None, run
        self._futile = self._futile + 1 if run.fault and not run.has_reported else 0
        self._send_waiting(now)

    # --- what the controller says ----------------------------------------------------------------

    def _take_status(self, status: ControllerStatus, now: Instant) -> None:
        run = self._run
        self._absent = "" if status.available else status.reason
        if status.available:
            self._rogue = ""
        if run is None or run.said_arrived_at is not None:
            return
        if not status.available:
            self._take_back(run, now)
        elif run.taken_back_at is not None:
            # It has no goal any more, whatever became of it.
            self._end(run, now)

    def _take_answer(self, run: _Run, answer: ControllerAnswer, now: Instant) -> None:
        if answer.accepted:
            run.is_accepted, run.heard_at = True, now
            return
        self._end_by_itself(run, f"the controller rejected the goal{_why(answer.reason)}", now)

    def _take_feedback(self, run: _Run, given: ControllerFeedback, now: Instant) -> None:
        # A goal of which there is feedback was accepted, even if that is not yet known.
        run.is_accepted = run.has_reported = True
        run.heard_at = now
        state = self._vehicle.fresh_state(now)
        if state is None or run.taken_back_at is not None or run.said_arrived_at is not None:
            return
        try:
            run.progress.claim(given.target_index, given.progress, state)
        except GivenUpError as error:
            self._give_up(run, str(error), now)

    def _take_result(self, run: _Run, result: ControllerResult, now: Instant) -> None:
        if result.end is GoalOutcome.SUCCEEDED and run.taken_back_at is None:
            # The vehicle has to stand there in any case.
            if run.said_arrived_at is None:
                run.said_arrived_at = now
                self._stop(now)
            return
        words = {
            GoalOutcome.CANCELED: "somebody else canceled the goal at the controller",
            GoalOutcome.UNKNOWN: "the controller does not know the goal any more",
        }.get(result.end, "the controller aborted the goal")
        self._end_by_itself(run, f"{words}{_why(result.reason)}", now)

    def _end_by_itself(self, run: _Run, reason: str, now: Instant) -> None:
        """End a goal that the controller has ended; unless it was taken back, it is aborted."""
        was_driving = run.taken_back_at is None
        if was_driving:
            self._stop(now)
        self._end(run, now)
        if was_driving:
            self._abort(run, reason)

    def _abort(self, run: _Run, reason: str) -> None:
        self._said.append(GoalResult(run.goal.goal, succeeded=False, reason=reason))

    # --- what time shows -------------------------------------------------------------------------

    def _step(self, now: Instant) -> None:
        if self._is_stopping:
            if self._run is None and self._vehicle.stands and not self._rogue:
                self._is_stopping, self._rolling = False, None
            else:
                self._said.append(Drive(self._vehicle.stop_command()))
        elif self._suspect_until is not None:
            self._judge_suspect(self._suspect_until, now)
        if self._run is not None:
            self._judge(self._run, now)
        self._locate(now)

    def _judge(self, run: _Run, now: Instant) -> None:
        if run.said_arrived_at is not None:
            self._judge_arrival(run, run.said_arrived_at, now)
        elif run.taken_back_at is not None:
            self._judge_taking_back(run, now)
        elif not run.is_accepted:
            if now - run.heard_at >= self._controller.accepted_within:
                within_s = to_seconds(self._controller.accepted_within)
                reason = f"the controller did not answer a goal within {within_s:g} s"
                self._distrust(run, reason, now)
        elif now - run.heard_at >= self._controller.silent_for:
            silent_s = to_seconds(self._controller.silent_for)
            self._distrust(run, f"the controller gave no feedback for {silent_s:g} s", now)
        else:
            self._follow(run, now)

    def _follow(self, run: _Run, now: Instant) -> None:
        state = self._vehicle.fresh_state(now)
        if state is None:
            return
        try:
            run.progress.follow(state, self._leg_limits, now)
        except GivenUpError as error:
            self._give_up(run, str(error), now)

    def _judge_taking_back(self, run: _Run, now: Instant) -> None:
        """Ask again for the end of a goal that is not confirmed in time, and tell of it.

        A controller may confirm it when the vehicle stands: time counts from when that brakes no
        more.
        """
        state = self._vehicle.fresh_state(now)
        if state is not None and now <= run.brakes_until:
            speed_mps = abs(state.speed_mps)
            if speed_mps < run.slowest_mps < math.inf:
                run.confirmed_by = now + self._controller.taken_back_within
            run.slowest_mps = min(run.slowest_mps, speed_mps)
        if now >= run.confirmed_by:
            run.is_overdue = True
            self._ask_for_end(run, now)

    def _judge_arrival(self, run: _Run, said_at: Instant, now: Instant) -> None:
        """Judge whether a goal was reached, once the vehicle stands or has to."""
        state = self._vehicle.fresh_state(now)
        if state is not None and self._vehicle.stands:
            why = run.progress.why_not_arrived(state, self._controller.end_tolerance_m)
        elif now - said_at < self._controller.stands_within:
            return
        elif state is None:
            why = "there is no pose of the vehicle"
        else:
            why = f"the vehicle moves at {state.speed_mps:.2f} m/s"
        self._end(run, now)
        if why:
            self._suspect_until = now + SUSPECT_FOR
            self._abort(run, f"the controller says that it arrived, but {why}")
        else:
            self._said.append(GoalResult(run.goal.goal, succeeded=True))

    def _judge_suspect(self, until: Instant, now: Instant) -> None:
        """Stop a vehicle that goes on although its controller said that it arrived."""
        if self._vehicle.moves:
            self._suspect_until = None
            self._rogue = "the controller drives without a goal: start it again"
            self._stop(now)
        elif now >= until:
            self._suspect_until = None

    def _locate(self, now: Instant) -> None:
        """Tell how far the goal came that is driven, or the one before while the vehicle rolls."""
        run, state = self._run or self._rolling, self._vehicle.fresh_state(now)
        if run is None or state is None or not run.is_accepted:
            return
        if self._is_stopping:
            run.progress.roll(state)
        progress = run.progress
        self._said.append(
            GoalFeedback(
                run.goal.goal,
                progress.target_index,
                progress.distance_m,
                progress.error_m,
                None,
                None,
                progress.left_out_m,
            )
        )

    def _tell(self) -> None:
        """Tell whether goals can be driven, if that changed."""
        trouble = self._absent or self._rogue or self._fault()
        if trouble != self._told:
            self._told = trouble
            self._said.append(NavigationStatus(not trouble, trouble))

    def _fault(self) -> str:
        """Return why no other goal is sent until the one at the controller has ended."""
        run = self._run
        if run is None or not run.is_overdue:
            return "" if run is None else run.fault
        within_s = to_seconds(self._controller.taken_back_within)
        late = f"the end of a goal that was taken back within {within_s:g} s"
        if run.fault:
            return f"{run.fault}, and did not confirm {late}"
        return f"the controller did not confirm {late}"


def _why(reason: str) -> str:
    return f": {reason}" if reason else ""
