"""An external controller drives: it is judged by the pose, and stopped whatever it does."""

import math

import pytest

from domain.commands import Drive, PreemptGoal, SendGoal
from domain.controller import (
    ControllerAnswer,
    ControllerFeedback,
    ControllerResult,
    ControllerSettings,
    ControllerStatus,
    GoalOutcome,
)
from domain.external_navigation import TRIES
from domain.identifiers import GoalId
from domain.inputs import TimePassed
from domain.simulation.vehicle_settings import Plant, VehicleSettings
from domain.snapshot import TaskPhase
from domain.timebase import seconds
from tests.support.paths import straight
from tests.support.scripted_controller import ACTION, ControlledRobot

UNCONFIRMED = "did not confirm the end of a goal that was taken back within 1 s"


@pytest.fixture
def robot() -> ControlledRobot:
    return ControlledRobot()


@pytest.fixture
def driving(robot: ControlledRobot) -> ControlledRobot:
    """Return a robot that has driven some metres of 20."""
    robot.submit_task(straight())
    robot.drive(3)
    assert robot.speed_mps > 2
    return robot


def since(robot: ControlledRobot, count: int) -> list[str]:
    """Return the kinds of commands after the first ones."""
    return [type(command).__name__ for command in robot.commands[count:]]


# --- a goal that is driven -----------------------------------------------------------------------


def test_a_goal_goes_to_the_controller_and_nothing_to_the_vehicle(robot: ControlledRobot) -> None:
    outputs = robot.submit_task(straight(), start_index=2, speed_mps=1.5)

    (goal,) = outputs.commands
    assert isinstance(goal, SendGoal)
    assert (goal.start_index, goal.speed_mps) == (2, 1.5)
    robot.drive(3)
    assert [c for c in robot.commands if isinstance(c, Drive)] == []


def test_the_path_is_driven_to_its_end(robot: ControlledRobot) -> None:
    robot.submit_task(straight())
    robot.drive(15)

    assert robot.task.status is TaskPhase.SUCCEEDED
    assert robot.task.progress == 1.0
    assert robot.speed_mps == 0.0
    assert robot.onboard.navigation.wake_at() is None


def test_progress_is_what_the_pose_bears_out(driving: ControlledRobot) -> None:
    driving.be(index_offset=3)
    driving.drive(0.5)
    state = driving.core.driving.vehicle.state
    assert state is not None

    assert driving.task.target_index == int(state.pose.x_m) + 1
    assert driving.task.distance_m == pytest.approx(state.pose.x_m, abs=0.2)


def test_a_controller_that_says_less_than_the_pose_shows_is_believed(
    driving: ControlledRobot,
) -> None:
    known = driving.task.target_index
    driving.give(ControllerFeedback(GoalId(1), known, 0.1))
    driving.be(reports=False)
    driving.advance(0.6)

    assert driving.task.target_index == known


# --- taken back ----------------------------------------------------------------------------------


def test_a_hold_commands_zero_first_and_takes_the_goal_back_in_the_same_step(
    driving: ControlledRobot,
) -> None:
    outputs = driving.hold()

    assert [type(c) for c in outputs.commands] == [Drive, Drive, PreemptGoal]
    assert {c.command.speed_mps for c in outputs.commands if isinstance(c, Drive)} == {0.0}


def test_zero_is_commanded_at_20_hz_until_the_vehicle_stands_and_the_end_is_confirmed(
    driving: ControlledRobot,
) -> None:
    driving.be(heeds_cancel=False)
    driving.hold()
    told = len(driving.commands)
    driving.drive(3)

    # And once more when the hold `navigation` is set.
    assert since(driving, told).count("Drive") == 60 + 1
    driving.be(heeds_cancel=True)
    driving.drive(1)
    told = len(driving.commands)
    driving.drive(2)
    assert since(driving, told) == []


def test_a_task_goes_on_with_one_goal_from_the_waypoint_that_was_confirmed(
    driving: ControlledRobot,
) -> None:
    driving.hold()
    driving.drive(2)
    reached = driving.task.target_index
    driving.release()
    driving.drive(15)

    assert [(g.goal, g.start_index) for g in driving.controller.given] == [(1, 0), (2, reached)]
    assert driving.task.status is TaskPhase.SUCCEEDED


def test_the_next_goal_waits_for_the_end_of_the_one_before(driving: ControlledRobot) -> None:
    driving.be(heeds_cancel=False)
    driving.hold()
    driving.advance(0.2)
    driving.release()
    driving.advance(0.2)
    assert len(driving.controller.given) == 1

    driving.give(ControllerResult(GoalId(1), GoalOutcome.CANCELED))
    assert [goal.goal for goal in driving.controller.given] == [1, 2]


def test_a_task_that_replaces_another_waits_for_the_end_of_its_goal(
    driving: ControlledRobot,
) -> None:
    driving.be(heeds_cancel=False)
    outputs = driving.submit_task(straight())
    assert [type(c) for c in outputs.commands] == [Drive, PreemptGoal]

    driving.give(ControllerResult(GoalId(1), GoalOutcome.CANCELED))
    assert [goal.goal for goal in driving.controller.given] == [1, 2]


def test_a_goal_that_still_waits_is_dropped_by_a_hold(driving: ControlledRobot) -> None:
    driving.be(heeds_cancel=False)
    driving.hold()
    driving.release()
    driving.hold()
    driving.give(ControllerResult(GoalId(1), GoalOutcome.CANCELED))

    assert [goal.goal for goal in driving.controller.given] == [1]


def test_a_controller_that_ignores_that_its_goal_is_taken_back_is_told(
    driving: ControlledRobot,
) -> None:
    driving.be(heeds_cancel=False)
    driving.cancel_task()
    driving.drive(3)

    assert driving.holds == {"navigation": f"the controller {UNCONFIRMED}"}
    assert driving.speed_mps == 0.0
    assert driving.controller.asked_back == 3, "it is asked once a second, after the vehicle braked"
    driving.be(heeds_cancel=True)
    driving.drive(1.5)
    assert driving.holds == {}


def test_what_is_rolled_over_while_stopping_counts_as_driven(driving: ControlledRobot) -> None:
    driving.give(ControllerFeedback(GoalId(1), driving.task.target_index, 0.1))
    before = driving.task.distance_m
    driving.hold()
    driving.drive(1)

    assert driving.task.distance_m > before


# --- a controller that is silent or gone ---------------------------------------------------------


def test_without_a_controller_tasks_are_held_and_begin_once_it_is_there() -> None:
    robot = ControlledRobot(is_there=False)
    assert robot.holds == {"navigation": f"no controller was seen at {ACTION} yet"}
    robot.submit_task(straight())
    assert robot.controller.given == []

    robot.give(ControllerStatus(available=True))
    assert robot.holds == {}
    assert len(robot.controller.given) == 1


def test_a_controller_that_dies_is_told_and_the_task_goes_on_with_its_successor(
    driving: ControlledRobot,
) -> None:
    driving.controller.die()
    driving.drive(3)
    reason = f"the controller gave no feedback for 1 s, and {UNCONFIRMED}"
    assert driving.holds == {"navigation": reason}
    assert (driving.task.status, driving.speed_mps) == (TaskPhase.PAUSED, 0.0)

    driving.give(ControllerStatus(available=False, reason=f"there is no controller at {ACTION}"))
    assert driving.holds == {"navigation": f"there is no controller at {ACTION}"}
    driving.controller.start_again()
    driving.give(ControllerStatus(available=True))
    driving.drive(15)
    assert driving.task.status is TaskPhase.SUCCEEDED
    assert len(driving.controller.given) == 2


def test_a_successor_that_does_not_know_the_goal_confirms_its_end(
    driving: ControlledRobot,
) -> None:
    driving.controller.die()
    driving.drive(3)
    driving.controller.start_again()
    driving.drive(1.5)

    assert driving.holds == {}
    assert driving.task.status is TaskPhase.RUNNING


def test_a_controller_that_is_gone_stops_the_vehicle_at_once(driving: ControlledRobot) -> None:
    outputs = driving.give(ControllerStatus(available=False, reason="gone"))
    kinds = [type(command) for command in outputs.commands]

    assert kinds[0] is Drive
    assert PreemptGoal in kinds
    assert driving.holds == {"navigation": "gone"}


@pytest.mark.parametrize(
    ("manners", "reason"),
    [
        ({"answers": False}, "the controller did not answer a goal within 1 s"),
        ({"reports": False}, "the controller gave no feedback for 1 s"),
    ],
)
def test_a_controller_that_never_says_anything_is_tried_a_few_times(
    robot: ControlledRobot, manners: dict[str, bool], reason: str
) -> None:
    robot.be(**manners)
    robot.submit_task(straight())
    robot.drive(8)

    assert len(robot.controller.given) == TRIES
    assert (robot.task.status, robot.task.reason) == (TaskPhase.ABORTED, reason)
    assert robot.speed_mps == 0.0


def test_a_stall_of_our_own_is_no_silence_of_the_controller(driving: ControlledRobot) -> None:
    late = driving.now + seconds(2)
    state = driving.core.driving.vehicle.state
    assert state is not None
    for given in driving.robot.advance(late):
        driving.onboard.take_in(given, late)
    index = driving.task.target_index
    driving.onboard.take_in(ControllerFeedback(GoalId(1), index, 0.5), late)
    driving.onboard.handle(TimePassed(), late)

    assert driving.holds == {}


# --- a controller that lies or fails -------------------------------------------------------------


@pytest.mark.parametrize(
    ("manners", "reason"),
    [
        ({"index_offset": 12}, "passed waypoint"),
        ({"index_offset": -3}, "went back from waypoint"),
        ({"index_offset": 100}, "of 21"),
        ({"progress": math.nan}, "its progress is nan"),
        ({"progress": 2.0}, "its progress is 2"),
        ({"progress": -0.5}, "its progress is -0.5"),
        ({"aborts_at_m": 5.0}, "the controller aborted the goal: an obstacle does not move"),
    ],
)
def test_what_cannot_be_true_aborts_the_task_and_the_vehicle_stands(
    driving: ControlledRobot, manners: dict[str, float], reason: str
) -> None:
    driving.be(**manners)
    driving.drive(5)

    assert driving.task.status is TaskPhase.ABORTED
    assert reason in str(driving.task.reason)
    assert driving.speed_mps == 0.0
    assert driving.controller.goal is None


def test_a_controller_that_says_falsely_that_it_arrived_and_drives_on_gets_no_goal(
    driving: ControlledRobot,
) -> None:
    driving.be(reaches_at_m=8.0)
    driving.drive(5)

    assert driving.task.status is TaskPhase.ABORTED
    assert "stands 11" in str(driving.task.reason)
    reason = "the controller drives without a goal: start it again"
    assert driving.holds == {"navigation": reason}
    assert driving.speed_mps == 0.0
    driving.drive(5)
    assert driving.speed_mps == 0.0
    driving.controller.die()
    driving.give(ControllerStatus(available=False, reason="gone"))
    driving.give(ControllerStatus(available=True))
    driving.drive(1)
    assert driving.holds == {}


def test_a_vehicle_that_does_not_stop_has_not_arrived() -> None:
    robot = ControlledRobot(vehicle=VehicleSettings(plant=Plant(braking_mps2=0.2)))
    robot.submit_task(straight())
    robot.drive(3)
    robot.give(ControllerResult(GoalId(1), GoalOutcome.SUCCEEDED))
    robot.drive(2)
    assert robot.task.ended_at is None
    robot.drive(1.5)

    assert robot.task.status is TaskPhase.ABORTED
    assert "it arrived, but the vehicle moves at" in str(robot.task.reason)


def test_a_rejected_goal_aborts_the_task_with_the_reason(robot: ControlledRobot) -> None:
    robot.be(accepts=False)
    robot.submit_task(straight())
    robot.drive(1)

    assert robot.task.status is TaskPhase.ABORTED
    assert robot.task.reason == "the controller rejected the goal: its map has no such place"


def test_a_goal_that_somebody_else_canceled_aborts_the_task(driving: ControlledRobot) -> None:
    outputs = driving.give(ControllerResult(GoalId(1), GoalOutcome.CANCELED))

    assert isinstance(outputs.commands[0], Drive)
    assert driving.task.reason == "somebody else canceled the goal at the controller"


def test_what_is_said_of_another_goal_is_left_aside(driving: ControlledRobot) -> None:
    driving.give(ControllerFeedback(GoalId(7), 999, 9.0))
    driving.give(ControllerAnswer(GoalId(7), accepted=False))
    driving.give(ControllerResult(GoalId(7), GoalOutcome.ABORTED))

    assert driving.task.status is TaskPhase.RUNNING


def test_a_controller_may_confirm_the_end_of_a_goal_when_the_vehicle_stands() -> None:
    robot = ControlledRobot(vehicle=VehicleSettings(plant=Plant(braking_mps2=1.0)))
    robot.be(heeds_cancel=False)
    robot.submit_task(straight(50.0))
    robot.drive(5)
    robot.cancel_task()
    while robot.speed_mps > 0.0:
        robot.drive(0.5)
        assert robot.holds == {}

    robot.give(ControllerResult(GoalId(1), GoalOutcome.CANCELED))
    robot.drive(3)

    assert robot.holds == {}
    assert robot.controller.asked_back == 1


def test_deadlines_are_settings() -> None:
    settings = ControllerSettings(ACTION, taken_back_within=seconds(3))
    robot = ControlledRobot(settings)
    robot.be(heeds_cancel=False)
    robot.submit_task(straight())
    robot.drive(2)
    robot.cancel_task()
    robot.drive(2.5)
    assert robot.holds == {}
    robot.drive(1)
    assert list(robot.holds) == ["navigation"]
