"""Navigation as the supervision uses it, with trackers and vehicles that a test makes up."""

import math
from collections.abc import Callable

import pytest

from domain.commands import Drive, PreemptGoal, SendGoal
from domain.errors import InvalidValueError
from domain.identifiers import GoalId
from domain.inputs import GoalFeedback, GoalResult, VehicleReport
from domain.navigation import Navigation, NavigationMessage, NavigationSettings
from domain.outbox import Outbox
from domain.paths.path import Path
from domain.tasks.settings import TaskSettings
from domain.tasks.vehicle_watch import VehicleWatch
from domain.timebase import Instant, seconds
from domain.tracking.tracker import ControlStep
from domain.vehicle import Point, Pose, VehicleLimits, VehicleState
from tests.support.paths import straight

LIMITS = VehicleLimits()


class Straight:
    """A tracker for paths along the x axis, that steers as it is told."""

    def __init__(self, steering_rad: float = 0.0, fails_with: Exception | None = None) -> None:
        self.steering_rad = steering_rad
        self.fails_with = fails_with

    def control_step(self, state: VehicleState, path: Path, start_index: int) -> ControlStep:
        if self.fails_with is not None:
            raise self.fails_with
        x, y = state.pose.x_m, state.pose.y_m
        distance = min(max(x, 0.0), path.length_m)
        index = max(path.index_after(distance), start_index)
        return ControlStep(self.steering_rad, index, distance, y, Point(x + 2, 0.0))


class Drive20Hz:
    """A vehicle that is wherever a test puts it, and what navigation says of it."""

    def __init__(self, tracker: Straight | None = None, length_m: float = 20.0) -> None:
        self.now: Instant = seconds(100)
        tracker = tracker or Straight()
        self.vehicle = VehicleWatch(TaskSettings(), Outbox())
        self.navigation = Navigation(
            LIMITS, NavigationSettings(), self.vehicle, {"test": lambda _: tracker}
        )
        self.path = straight(length_m)
        self.said: list[NavigationMessage] = []

    def report(self, x_m: float = 0.0, y_m: float = 0.0, speed_mps: float = 0.0) -> None:
        state = VehicleState(Pose(x_m, y_m, 0.0), speed_mps, 0.0)
        self.vehicle.take(VehicleReport(state), self.now)

    def send(self, goal: int = 1, start_index: int = 0, speed_mps: float = 2.8) -> None:
        reached_m = self.path.distance_of(max(start_index - 1, 0))
        given = SendGoal(
            GoalId(goal), self.path, 0, start_index, "test", speed_mps, reached_m=reached_m
        )
        self.navigation.handle(given, self.now)
        self.act()

    def act(self) -> list[NavigationMessage]:
        said = list(self.navigation.advance(self.now))
        self.said += said
        return said

    def step(self, x_m: float, y_m: float = 0.0, speed_mps: float = 2.8) -> list[NavigationMessage]:
        """Let a period pass, at whose end the vehicle is somewhere."""
        self.now += seconds(0.05)
        self.report(x_m, y_m, speed_mps)
        return self.act()

    def stay(self, by_s: float, x_m: float, y_m: float = 0.0, speed_mps: float = 2.8) -> None:
        for _ in range(round(by_s / 0.05)):
            self.step(x_m, y_m, speed_mps)

    @property
    def result(self) -> GoalResult | None:
        return next((m for m in self.said if isinstance(m, GoalResult)), None)

    @property
    def speeds(self) -> list[float]:
        return [m.command.speed_mps for m in self.said if isinstance(m, Drive)]


@pytest.fixture
def drive() -> Drive20Hz:
    return Drive20Hz()


def result_of(drive: Drive20Hz) -> GoalResult:
    assert drive.result is not None
    return drive.result


def test_the_first_step_is_done_when_the_goal_is_sent(drive: Drive20Hz) -> None:
    drive.report()
    drive.send()

    assert [type(message) for message in drive.said] == [Drive, GoalFeedback]


def test_the_next_step_is_due_50_ms_later(drive: Drive20Hz) -> None:
    drive.report()
    drive.send()

    assert drive.navigation.wake_at() == drive.now + seconds(0.05)


def test_a_late_step_is_done_once_and_keeps_to_the_grid(drive: Drive20Hz) -> None:
    drive.report()
    drive.send()
    start = drive.now
    drive.now += seconds(0.17)

    assert len([m for m in drive.act() if isinstance(m, Drive)]) == 1
    assert drive.navigation.wake_at() == start + seconds(0.2)


def test_without_a_goal_nothing_is_due(drive: Drive20Hz) -> None:
    drive.report()

    assert drive.navigation.wake_at() is None
    assert drive.act() == []


def test_after_a_preemption_it_only_steers_until_the_vehicle_stands(drive: Drive20Hz) -> None:
    drive.report()
    drive.send()
    drive.step(1.0)
    drive.said.clear()
    drive.navigation.handle(PreemptGoal(GoalId(1)), drive.now)
    drive.stay(2, 2.0)

    assert set(drive.speeds) == {0.0}
    drive.step(2.0, speed_mps=0.0)
    drive.said.clear()
    drive.stay(2, 2.0)
    assert drive.said == []


def test_what_a_preempted_goal_rolls_over_is_passed(drive: Drive20Hz) -> None:
    drive.report(5.0, speed_mps=2.8)
    drive.send(start_index=5)
    drive.navigation.handle(PreemptGoal(GoalId(1)), drive.now)
    for x_m in (5.5, 6.0, 6.5):
        (_, feedback) = drive.step(x_m)

    assert isinstance(feedback, GoalFeedback)
    assert (feedback.target_index, feedback.left_out_m) == (7, 0.0)


def test_a_goal_preempted_at_standstill_commands_nothing_more(drive: Drive20Hz) -> None:
    drive.report()
    drive.send()
    drive.said.clear()
    drive.navigation.handle(PreemptGoal(GoalId(1)), drive.now)
    drive.stay(2, 0.0, speed_mps=0.0)

    assert drive.said == []


def test_a_preempted_goal_without_a_pose_just_ends(drive: Drive20Hz) -> None:
    drive.report()
    drive.send()
    drive.step(1.0)
    drive.navigation.handle(PreemptGoal(GoalId(1)), drive.now)
    drive.said.clear()
    drive.now += seconds(0.4)
    drive.act()

    assert drive.said == []
    assert drive.navigation.wake_at() is None


def test_the_preemption_of_an_older_goal_leaves_the_newer_one(drive: Drive20Hz) -> None:
    drive.report()
    drive.send(goal=1)
    drive.send(goal=2)
    drive.navigation.handle(PreemptGoal(GoalId(1)), drive.now)

    assert [type(message) for message in drive.step(0.1)] == [Drive, GoalFeedback]


def test_the_speed_rises_by_the_acceleration_and_no_faster(drive: Drive20Hz) -> None:
    drive.report()
    drive.send()
    drive.stay(4, 5.0)

    assert drive.speeds[:3] == pytest.approx([0.05, 0.10, 0.15])
    assert max(drive.speeds) == pytest.approx(2.8)


def test_a_goal_sent_to_a_moving_vehicle_goes_on_from_its_speed(drive: Drive20Hz) -> None:
    drive.report(5.0, speed_mps=2.0)
    drive.send(start_index=5)

    assert drive.speeds == pytest.approx([2.05])


def test_feedback_tells_what_was_commanded(drive: Drive20Hz) -> None:
    drive.report(3.2, y_m=0.1)
    drive.send(start_index=3)
    told, feedback = drive.said
    assert isinstance(feedback, GoalFeedback)
    assert isinstance(told, Drive)

    assert feedback.command == told.command
    assert (feedback.target_index, feedback.distance_m) == (4, 3.2)
    assert feedback.cross_track_error_m == 0.1


def test_steering_is_cut_to_what_the_vehicle_can() -> None:
    drive = Drive20Hz(Straight(steering_rad=2.0))
    drive.report()
    drive.send()
    told = drive.said[0]
    assert isinstance(told, Drive)

    assert told.command.steering_angle_rad == LIMITS.max_steering_angle_rad


# --- arriving ------------------------------------------------------------------------------------


def test_a_goal_succeeds_once_the_last_waypoint_is_passed(drive: Drive20Hz) -> None:
    drive.report(19.0)
    drive.send(start_index=19)
    drive.step(19.99)
    assert drive.result is None
    said = drive.step(20.01)

    assert [type(message) for message in said] == [GoalFeedback, GoalResult]
    assert result_of(drive).succeeded


def test_a_goal_succeeds_when_the_vehicle_stands_within_30_cm_of_its_end(drive: Drive20Hz) -> None:
    drive.report(19.0)
    drive.send(start_index=19)
    drive.step(19.71, speed_mps=0.06)
    assert drive.result is None, "it still moves"
    drive.step(19.71, speed_mps=0.04)

    assert result_of(drive).succeeded


def test_standing_further_from_the_end_is_not_arriving(drive: Drive20Hz) -> None:
    drive.report(19.0)
    drive.send(start_index=19)
    drive.step(19.69, speed_mps=0.0)

    assert drive.result is None


def test_standing_near_the_end_of_a_short_path_is_not_arriving_before_95_percent() -> None:
    drive = Drive20Hz(length_m=2.0)
    drive.report(1.0)
    drive.send(start_index=1)
    drive.step(1.9, speed_mps=0.0)
    assert drive.result is None
    drive.step(1.91, speed_mps=0.0)

    assert result_of(drive).succeeded


# --- giving up -----------------------------------------------------------------------------------


def test_more_than_three_metres_beside_the_path_for_a_second_is_given_up(drive: Drive20Hz) -> None:
    drive.report(5.0)
    drive.send(start_index=5)
    drive.stay(1.0, 5.0, y_m=3.01)
    assert drive.result is None
    drive.step(5.0, y_m=3.01)

    assert result_of(drive) == GoalResult(GoalId(1), False, "3.0 m from the path for 1 s")


def test_one_moment_back_within_three_metres_begins_the_second_anew(drive: Drive20Hz) -> None:
    drive.report(5.0)
    drive.send(start_index=5)
    drive.stay(0.9, 5.0, y_m=3.5)
    drive.step(5.0, y_m=3.0)
    drive.stay(0.95, 5.0, y_m=3.5)

    assert drive.result is None


def test_twenty_seconds_without_progress_are_given_up(drive: Drive20Hz) -> None:
    drive.report(5.0)
    drive.send(start_index=5)
    drive.stay(19.95, 5.04, speed_mps=0.0)
    assert drive.result is None
    drive.step(5.04, speed_mps=0.0)

    assert result_of(drive).reason == "no progress for 20 s"


def test_a_slow_vehicle_that_comes_on_is_not_given_up(drive: Drive20Hz) -> None:
    drive.report(5.0)
    drive.send(start_index=5)
    for number in range(60):
        drive.stay(1, 5.0 + 0.06 * number, speed_mps=0.06)

    assert drive.result is None


def test_a_pose_that_is_too_old_is_given_up(drive: Drive20Hz) -> None:
    drive.report()
    drive.send()
    drive.now += seconds(0.31)
    drive.act()

    assert result_of(drive).reason == "no pose of the vehicle for 0.3 s"


def test_a_goal_without_any_pose_is_given_up_at_once(drive: Drive20Hz) -> None:
    drive.send()

    assert not result_of(drive).succeeded


@pytest.mark.parametrize("steering_rad", [math.nan, math.inf, -math.inf])
def test_a_command_that_is_no_number_is_never_sent(steering_rad: float) -> None:
    drive = Drive20Hz(Straight(steering_rad=steering_rad))
    drive.report()
    drive.send()

    assert [type(message) for message in drive.said] == [GoalResult]
    assert result_of(drive).reason == "test commands a steering angle that is not finite"


@pytest.mark.parametrize(
    "error", [ZeroDivisionError("by zero"), TypeError("odd"), InvalidValueError("odd")]
)
def test_a_tracker_that_fails_ends_its_goal_with_the_reason(error: Exception) -> None:
    drive = Drive20Hz(Straight(fails_with=error))
    drive.report()
    drive.send()

    assert result_of(drive).reason == f"test failed: {type(error).__name__}: {error}"


@pytest.mark.parametrize(
    "end", [lambda drive: drive.stay(30, 5.0, speed_mps=0.0), lambda drive: drive.step(20.5)]
)
def test_after_its_end_a_goal_commands_nothing(
    drive: Drive20Hz, end: Callable[[Drive20Hz], object]
) -> None:
    drive.report(5.0)
    drive.send(start_index=5)
    end(drive)
    drive.said.clear()
    drive.stay(1, 5.0)

    assert drive.said == []
    assert drive.navigation.wake_at() is None


# --- what was left out ---------------------------------------------------------------------------


def test_an_end_that_is_passed_with_a_part_left_out_is_no_success(drive: Drive20Hz) -> None:
    drive.report(5.0)
    drive.send(start_index=5)
    drive.step(12.0)
    drive.step(20.5)

    assert not result_of(drive).succeeded
    # What is within 3 m of the places where it was is passed.
    assert result_of(drive).reason == "the end is passed, but 6.5 m were skipped"


def test_what_an_earlier_goal_of_the_task_left_out_counts(drive: Drive20Hz) -> None:
    drive.report(19.0)
    goal = SendGoal(GoalId(1), drive.path, 0, 19, "test", 2.8, reached_m=19.0, left_out_m=1.5)
    drive.navigation.handle(goal, drive.now)
    drive.act()
    drive.step(20.5)

    assert result_of(drive).reason == "the end is passed, but 1.5 m were skipped"


def test_a_stretch_within_three_metres_was_not_left_out_however_fast_it_went(
    drive: Drive20Hz,
) -> None:
    drive.report(15.0)
    drive.send(start_index=15)
    drive.step(17.9)
    drive.step(20.5)

    assert result_of(drive).succeeded


def test_a_goal_sent_before_any_pose_begins_from_rest(drive: Drive20Hz) -> None:
    drive.navigation.handle(SendGoal(GoalId(1), drive.path, 0, 0, "test", 2.8), drive.now)
    drive.report()
    drive.act()

    assert drive.speeds == [0.05]


def test_navigation_says_where_it_steers_to_and_what_was_left_out(drive: Drive20Hz) -> None:
    drive.report(x_m=3.0)
    goal = SendGoal(GoalId(1), drive.path, 0, 3, "test", 2.8, reached_m=3.0, left_out_m=0.4)
    drive.navigation.handle(goal, drive.now)
    _, feedback = drive.act()

    assert isinstance(feedback, GoalFeedback)
    assert feedback.lookahead == Point(5.0, 0.0)
    assert feedback.left_out_m == 0.4


def test_progress_counts_from_when_the_goal_was_sent(drive: Drive20Hz) -> None:
    drive.report(x_m=-1.0)
    drive.send()
    drive.stay(19.9, -1.0, speed_mps=0.0)
    assert drive.result is None
    drive.stay(0.1, -1.0, speed_mps=0.0)

    assert result_of(drive).reason == "no progress for 20 s"


def test_a_vehicle_beside_the_path_leaves_out_what_it_passes(drive: Drive20Hz) -> None:
    drive.report()
    drive.send()
    drive.step(0.5, y_m=3.1)
    drive.step(1.0, y_m=3.1)
    (_, feedback) = drive.step(1.5, y_m=3.1)

    # It began on the path, and so was near the first half metre.
    assert isinstance(feedback, GoalFeedback)
    assert feedback.left_out_m == pytest.approx(1.0)


@pytest.mark.parametrize(("left_out_m", "arrives"), [(0.4, True), (0.6, False)])
def test_what_was_left_out_counts_against_what_was_to_be_driven(
    drive: Drive20Hz, left_out_m: float, arrives: bool
) -> None:
    """95 % of the 10 m from waypoint 10 on, and not of the whole path."""
    drive.report(x_m=20.0)
    goal = SendGoal(
        GoalId(1), drive.path, 10, 19, "test", 2.8, reached_m=20.0, left_out_m=left_out_m
    )
    drive.navigation.handle(goal, drive.now)
    drive.act()

    assert result_of(drive).succeeded is arrives


@pytest.mark.parametrize(("y_m", "arrives"), [(0.2, True), (-0.2, True), (0.29, False)])
def test_standing_beside_the_end_is_arriving_only_near_it(
    drive: Drive20Hz, y_m: float, arrives: bool
) -> None:
    drive.report(x_m=19.8, speed_mps=1.0)
    drive.send(start_index=20)
    assert drive.result is None
    drive.step(19.85, y_m, speed_mps=0.0)

    assert (drive.result is not None) is arrives


# --- after a restart of the service --------------------------------------------------------------


def go_on(drive: Drive20Hz, seen: VehicleState | None) -> None:
    """Send a goal of which an earlier run had driven 20 m."""
    given = SendGoal(GoalId(1), drive.path, 0, 21, "test", 2.8, reached_m=20.0, seen=seen)
    drive.navigation.handle(given, drive.now)
    drive.act()


def seen_at(x_m: float, speed_mps: float) -> VehicleState:
    return VehicleState(Pose(x_m, 0.0, 0.0), speed_mps, 0.0)


def left_out_m(drive: Drive20Hz) -> list[float]:
    return [m.left_out_m for m in drive.said if isinstance(m, GoalFeedback)]


def test_what_the_vehicle_rolled_while_the_service_was_away_is_driven() -> None:
    drive = Drive20Hz(length_m=60.0)
    drive.report(x_m=26.5)
    go_on(drive, seen_at(20.0, 2.8))

    assert drive.result is None
    assert left_out_m(drive) == [0.0]
    assert [m.distance_m for m in drive.said if isinstance(m, GoalFeedback)] == [26.5]


def test_a_vehicle_that_was_carried_on_along_its_path_is_not_taken_for_one_that_rolled() -> None:
    drive = Drive20Hz(length_m=60.0)
    drive.report(x_m=27.0)
    go_on(drive, seen_at(20.0, 0.0))

    assert result_of(drive).reason.startswith("7.0 m from where the path goes on")


def test_a_vehicle_that_stopped_beside_its_path_approaches_it_again() -> None:
    drive = Drive20Hz(length_m=60.0)
    drive.report(x_m=24.0, y_m=4.5)
    go_on(drive, seen_at(20.0, 2.8))

    assert drive.result is None, "6 m away, and yet by itself"


def test_a_vehicle_that_was_carried_away_is_not_driven_back() -> None:
    drive = Drive20Hz(length_m=60.0)
    drive.report(x_m=24.0, y_m=9.0)
    go_on(drive, seen_at(20.0, 2.8))

    assert result_of(drive).reason.startswith("9.8 m from where the path goes on")


def test_a_vehicle_that_drove_slowly_when_it_was_seen_may_have_become_faster() -> None:
    drive = Drive20Hz(length_m=60.0)
    drive.report(x_m=23.8)
    go_on(drive, seen_at(20.0, 1.5))

    assert left_out_m(drive) == [0.0]


def test_a_goal_that_begins_anew_has_nothing_to_take_up() -> None:
    drive = Drive20Hz(length_m=60.0)
    drive.report(x_m=27.0)
    go_on(drive, None)

    assert result_of(drive).reason.startswith("7.0 m from where the path goes on")
