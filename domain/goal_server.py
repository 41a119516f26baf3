"""Drives a vehicle along the goals of others, as an action server: trackers without supervision.

Deterministic and advanced like navigation, which it feeds with goals and with reports of the
vehicle. A newer goal replaces the one before. A goal that was reached or canceled ends when the
vehicle is at standstill; one that is aborted ends at once, and speed 0 is commanded before that is
told.
"""

from dataclasses import dataclass
from typing import TypeAlias

from domain.arrays import Floats
from domain.commands import Drive, PreemptGoal, SendGoal
from domain.controller import GoalOutcome
from domain.errors import InvalidValueError
from domain.identifiers import GoalId
from domain.inputs import DriveStatus, GoalFeedback, GoalResult, VehicleReport
from domain.navigation import Navigation, NavigationSettings
from domain.outbox import Outbox
from domain.paths.path import Path
from domain.tasks.settings import TaskSettings
from domain.tasks.task_planner import check_cruise
from domain.tasks.vehicle_watch import VehicleWatch
from domain.timebase import Duration, Instant, seconds, to_seconds
from domain.tracking.pace import PERIOD
from domain.vehicle import VehicleLimits

REPLACED = "replaced by a newer goal"

_STOP_FOR: Duration = seconds(2.0)
"""Speed 0 is commanded so long after a goal whose vehicle is not known to be at standstill."""


@dataclass(frozen=True, slots=True)
class WaypointGoal:
    """What a client asks for; it can be driven."""

    path: Path
    start_index: int
    """The waypoint to begin with: those before it have been driven."""
    speed_mps: float
    """Largest speed on the path."""

    @classmethod
    def checked(
        cls,
        waypoints: Floats,
        start_index: int,
        speed_mps: float,
        limits: VehicleLimits,
    ) -> "WaypointGoal":
        """Return a goal that the vehicle can drive.

        Args:
            waypoints: Shape (n, 3): x m, y m, yaw rad.
            start_index: The waypoint to begin with.
            speed_mps: Largest speed on the path.
            limits: Of the vehicle.

        Raises:
            InvalidValueError: The waypoints are no path, there is no waypoint of that index, or
                the vehicle cannot drive the speed.
        """
        path = Path(waypoints)
        if not 0 <= start_index < path.count:
            message = f"start_index {start_index} is not within 0 to {path.count - 1}"
            raise InvalidValueError(message, "start_index")
        check_cruise(speed_mps, limits)
        return cls(path, start_index, speed_mps)


@dataclass(frozen=True, slots=True)
class GoalProgress:
    """How far a goal has come."""

    goal: GoalId
    target_index: int
    """First waypoint that is not yet passed."""
    progress: float
    """Share of the path that was driven, from 0 to 1."""


@dataclass(frozen=True, slots=True)
class GoalEnded:
    """A goal has ended; nothing more is told of it."""

    goal: GoalId
    end: GoalOutcome
    message: str = ""
    """Why it was not reached; empty: it was."""


GoalMessage: TypeAlias = Drive | GoalProgress | GoalEnded


@dataclass(slots=True)
class _Current:
    """The goal that is driven or stopped."""

    id: GoalId
    length_m: float
    closes_as: GoalOutcome | None = None
    """How it ends when the vehicle is at standstill; None: it is still driven."""
    due: Instant = 0
    """By then the vehicle has to be at standstill."""


class GoalServer:
    """Follows one goal at a time with one tracker.

    `now` must never decrease from call to call. What follows from an input is told by the next
    `advance`, which is due at once.
    """

    def __init__(
        self,
        limits: VehicleLimits,
        tasks: TaskSettings,
        navigation: NavigationSettings,
        controller: str,
        supervised_within: Duration,
    ) -> None:
        """Begin without a goal, and without a pose.

        Args:
            limits: Of the vehicle.
            tasks: From where a path may begin, and when a pose is stale.
            navigation: Limits at which a goal is aborted, and speed limits.
            controller: Name of the tracker.
            supervised_within: A supervisor that was heard and is silent for longer is gone.
        """
        self._watch = VehicleWatch(tasks, Outbox())
        self._navigation = Navigation(limits, navigation, self._watch)
        self._stop_within = navigation.no_progress_for
        self._controller = controller
        self._supervised_within = supervised_within
        self._current: _Current | None = None
        self._count = 0
        self._trouble = ""
        self._untold: list[GoalMessage] = []
        self._stop_at: Instant | None = None
        """When speed 0 is commanded next; None: the vehicle is left to itself, or driven."""
        self._stop_until: Instant = 0
        self._supervised_at: Instant | None = None
        """When the supervisor was heard last; None: there is none, and nobody misses it."""

    @property
    def goal(self) -> GoalId | None:
        """Return the goal that has not ended yet; None: there is none."""
        return None if self._current is None else self._current.id

    # --- inputs ----------------------------------------------------------------------------------

    def begin(self, asked: WaypointGoal, now: Instant) -> GoalId:
        """Replace the current goal, if any, by another; return its number."""
        current = self._current
        if current is not None:
            self._end(current, current.closes_as or GoalOutcome.ABORTED, REPLACED)
        if self._is_unsupervised(now):
            self._supervised_at = None
        self._count += 1
        goal = GoalId(self._count)
        self._current = _Current(goal, asked.path.length_m)
        self._stop_at = None
        given = SendGoal(
            goal,
            asked.path,
            0,
            asked.start_index,
            self._controller,
            asked.speed_mps,
            reached_m=self._reached_m(asked),
        )
        self._navigation.handle(given, now)
        if self._trouble:
            self.abort(self._trouble, now)
        return goal

    def cancel(self, goal: GoalId, now: Instant) -> None:
        """Stop the vehicle, and end the goal as canceled then; one that has ended stays so."""
        current = self._current
        if current is None or current.id != goal or current.closes_as is not None:
            return
        self._navigation.handle(PreemptGoal(goal), now)
        self._close(current, GoalOutcome.CANCELED, now)

    def report(self, report: VehicleReport, now: Instant) -> None:
        """Take a report of the vehicle.

        Raises:
            InvalidValueError: A number is not finite.
        """
        self._watch.check(report)
        self._watch.take(report, now)

    def hear_supervisor(self, now: Instant) -> None:
        """Learn that somebody supervises the vehicle: without them, nobody would stop it."""
        self._supervised_at = now

    def note_drive(self, status: DriveStatus, now: Instant) -> None:
        """Learn whether commands reach the vehicle; a goal is aborted if they do not."""
        self._trouble = "" if status.available else f"commands do not arrive: {status.reason}"
        if self._trouble:
            self.abort(self._trouble, now)

    def abort(self, why: str, now: Instant) -> None:
        """Stop the vehicle, and end the current goal, if there is one, at once.

        Args:
            why: For the client, in words.
            now: The current time.
        """
        current = self._current
        if current is None:
            return
        self._navigation.handle(PreemptGoal(current.id), now)
        self._begin_stop(now)
        self._end(current, GoalOutcome.ABORTED, why)

    # --- time ------------------------------------------------------------------------------------

    def wake_at(self) -> Instant | None:
        """Return when something is due next; None: not before there is new input."""
        due = (self._navigation.wake_at(), self._stop_at)
        return min((at for at in due if at is not None), default=None)

    def advance(self, now: Instant) -> tuple[GoalMessage, ...]:
        """Return what is due by `now`: commands, how far the goal has come, and how it ended."""
        self._watch.pass_time(now)
        current = self._current
        if current is not None and current.closes_as is None and self._is_unsupervised(now):
            limit_s = to_seconds(self._supervised_within)
            self.abort(f"no word of the supervisor for {limit_s:g} s", now)
        for message in self._navigation.advance(now):
            self._take(message, now)
        self._judge_stop(now)
        told, self._untold = tuple(self._untold), []
        return told

    # --- inside ----------------------------------------------------------------------------------

    def _is_unsupervised(self, now: Instant) -> bool:
        """Tell whether there was a supervisor, and it is gone; control steps look often enough."""
        heard_at = self._supervised_at
        return heard_at is not None and now - heard_at > self._supervised_within

    def _take(self, message: Drive | GoalFeedback | GoalResult, now: Instant) -> None:
        """Take what navigation says; of a goal that has ended, only its commands count."""
        current = self._current
        if isinstance(message, Drive):
            self._untold.append(message)
        elif current is None or message.goal != current.id:
            return
        elif isinstance(message, GoalFeedback):
            driven = min(max(message.distance_m / current.length_m, 0.0), 1.0)
            self._untold.append(GoalProgress(current.id, message.target_index, driven))
        elif message.succeeded:
            self._close(current, GoalOutcome.SUCCEEDED, now)
        else:
            self.abort(message.reason, now)

    def _close(self, current: _Current, end: GoalOutcome, now: Instant) -> None:
        """End a goal when the vehicle is at standstill."""
        current.closes_as, current.due = end, now + self._stop_within
        self._begin_stop(now)

    def _begin_stop(self, now: Instant) -> None:
        self._untold.append(self._stop())
        self._stop_at, self._stop_until = now + PERIOD, now + _STOP_FOR

    def _judge_stop(self, now: Instant) -> None:
        """Command speed 0 as long as the vehicle should stop, and end its goal once it stands."""
        if self._stop_at is None or now < self._stop_at:
            return
        if self._navigation.wake_at() is None:
            # Else navigation brakes, and steers along the path meanwhile.
            self._untold.append(self._stop())
        current = self._current
        if current is not None and current.closes_as is not None:
            self._judge_closing(current, now)
        is_over = self._watch.stands or now >= self._stop_until
        self._stop_at = None if self._current is None and is_over else now + PERIOD

    def _judge_closing(self, current: _Current, now: Instant) -> None:
        """End a goal whose vehicle has to stop, as soon as it is known whether it does."""
        assert current.closes_as is not None
        if self._watch.stands:
            canceled = current.closes_as is GoalOutcome.CANCELED
            self._end(current, current.closes_as, "canceled" if canceled else "")
        elif self._watch.is_lost:
            self._fail_to_stop(current, "there is no pose of the vehicle", now)
        elif now >= current.due:
            self._fail_to_stop(current, "the vehicle does not stop", now)

    def _fail_to_stop(self, current: _Current, why: str, now: Instant) -> None:
        self._begin_stop(now)
        self._end(current, GoalOutcome.ABORTED, why)

    def _end(self, current: _Current, end: GoalOutcome, message: str) -> None:
        self._untold.append(
            GoalEnded(current.id, end, "" if end is GoalOutcome.SUCCEEDED else message)
        )
        self._current = None

    def _stop(self) -> Drive:
        return Drive(self._watch.stop_command())

    def _reached_m(self, asked: WaypointGoal) -> float:
        """Return how much of the path was driven before a goal, m.

        The vehicle is somewhere between the last waypoint that was passed and the first one that
        was not.
        """
        if asked.start_index == 0:
            return 0.0
        path, index = asked.path, asked.start_index
        passed_m, state = path.distance_of(index - 1), self._watch.state
        if state is None:
            return passed_m
        here = path.project(state.pose.x_m, state.pose.y_m, index)
        return min(max(here.distance_m, passed_m), path.distance_of(index))
