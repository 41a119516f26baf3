from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from domain.commands import Drive, PreemptGoal, SendGoal
from domain.errors import (
    FarStartError,
    InvalidValueError,
    UnknownControllerError,
    UnknownTaskError,
)
from domain.identifiers import GoalId
from domain.inputs import GoalFeedback, Restored, VehicleReport
from domain.kept import KeptProgress, KeptTask
from domain.outbox import Outputs
from domain.paths.path import Path
from domain.snapshot import TaskPhase
from domain.supervision import SupervisionSettings
from domain.tasks.task_planner import MIN_CRUISE_MPS, RESTART_REASON, check_cruise
from domain.timebase import seconds
from domain.vehicle import DriveCommand, Point, Pose, VehicleLimits, VehicleState
from tests.support.good import GOOD
from tests.support.paths import straight
from tests.support.scripted_robot import ScriptedRobot


def commands_of(outputs: Outputs) -> list[str]:
    return [type(command).__name__ for command in outputs.commands]


# --- serve ---------------------------------------------------------------------------------------


def test_a_task_that_nothing_holds_is_one_goal_from_its_first_waypoint(
    robot: ScriptedRobot,
) -> None:
    served = robot.submit_task()

    assert commands_of(served) == ["SendGoal"]
    assert robot.goals[0].start_index == 0
    assert (robot.status, robot.state) == ("RUNNING_TASK", "RUNNING")
    assert robot.task.status is TaskPhase.RUNNING


def test_running_for_a_while_sends_nothing_twice(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.advance(2.0, speed_mps=2.8)

    assert len(robot.goals) == 1


def test_a_task_served_in_error_is_taken_and_waits(robot: ScriptedRobot) -> None:
    robot.read(estop=True)
    robot.submit_task()

    assert (robot.status, robot.state) == ("PAUSED_TASK", "ERROR")
    assert robot.task.status is TaskPhase.PAUSED
    assert robot.goals == []


def test_a_task_served_in_error_starts_when_the_error_ends(robot: ScriptedRobot) -> None:
    robot.read(estop=True)
    robot.submit_task()
    robot.advance(0.5)

    assert len(robot.goals) == 1
    assert (robot.status, robot.state) == ("RUNNING_TASK", "RUNNING")
    assert [data["task"] for data in robot.happened("task.started")] == ["t1"]


def test_a_new_task_takes_the_place_of_a_running_one_without_a_stop(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.feedback(9)
    replaced = robot.submit_task(straight(y_m=0.5))

    assert commands_of(replaced) == ["PreemptGoal", "SendGoal"]
    assert robot.goals[1].start_index == 0
    assert robot.status == "RUNNING_TASK"
    assert robot.core.driving.task("t1").status is TaskPhase.CANCELED
    assert robot.core.driving.task("t1").reason == "replaced by t2"


def test_of_two_tasks_served_in_error_the_last_one_runs(robot: ScriptedRobot) -> None:
    robot.read(estop=True)
    robot.submit_task()
    robot.submit_task(straight(y_m=0.5))
    robot.advance(0.5)

    assert [goal.path.waypoint(0).y_m for goal in robot.goals] == [0.5]


def test_a_task_may_begin_at_a_later_waypoint(robot: ScriptedRobot) -> None:
    robot.submit_task(start_index=3)

    assert robot.goals[0].start_index == 3
    assert robot.task.length_m == 17


@pytest.mark.parametrize("start_index", [-1, 20, 21])
def test_a_start_with_no_path_behind_it_is_refused(robot: ScriptedRobot, start_index: int) -> None:
    with pytest.raises(InvalidValueError, match="start_index"):
        robot.submit_task(start_index=start_index)

    assert robot.core.driving.current_task is None


def test_an_unknown_controller_is_refused_and_the_known_ones_are_named(
    robot: ScriptedRobot,
) -> None:
    with pytest.raises(UnknownControllerError) as refused:
        robot.submit_task(controller="magic")

    assert refused.value.hint == "known: pure_pursuit, stanley"


def test_a_path_that_begins_more_than_five_metres_away_is_refused(robot: ScriptedRobot) -> None:
    with pytest.raises(FarStartError, match=r"begins 5\.1 m from the vehicle"):
        robot.submit_task(straight(y_m=5.1))
    robot.submit_task(straight(y_m=5.0))

    assert robot.task.status is TaskPhase.RUNNING


def test_where_the_vehicle_was_unknown_the_distance_is_judged_at_the_start() -> None:
    robot = ScriptedRobot(pose=False)
    robot.submit_task(straight(y_m=8.0))
    assert robot.status == "PAUSED_TASK"
    robot.report()

    assert robot.task.status is TaskPhase.ABORTED
    assert robot.task.reason == "the path begins 8.0 m from the vehicle; at most 5 m"
    assert robot.goals == []


# --- holds ---------------------------------------------------------------------------------------


def test_an_error_takes_the_goal_back_and_stops_in_the_same_step(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.report(speed_mps=2.8, steering_rad=0.2)
    stopped = robot.read(estop=True)

    assert commands_of(stopped) == ["PreemptGoal", "Drive"]
    assert [drive.command.speed_mps for drive in robot.sent(Drive)] == [0.0]
    assert (robot.status, robot.state) == ("PAUSED_TASK", "ERROR")
    assert robot.task.status is TaskPhase.PAUSING


def test_a_stop_leaves_the_wheels_as_they_are(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.report(speed_mps=2.8, steering_rad=0.2)
    robot.hold()

    assert robot.sent(Drive)[0].command.steering_angle_rad == 0.2


def test_a_held_task_is_paused_once_the_vehicle_is_seen_to_stand(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.hold()
    robot.report(speed_mps=0.06)
    assert robot.task.status == "PAUSING"
    robot.report(speed_mps=0.04)

    assert robot.task.status is TaskPhase.PAUSED
    assert robot.task.reason == "lunch"


def test_a_released_task_goes_on_from_the_first_waypoint_not_yet_passed(
    robot: ScriptedRobot,
) -> None:
    robot.submit_task()
    robot.feedback(7)
    robot.hold()
    robot.report()
    robot.release()

    assert [goal.start_index for goal in robot.goals] == [0, 7]
    assert robot.happened("task.resumed") == [{"task": "t1", "goal": 2, "target_index": 7}]


def test_a_task_goes_on_even_while_it_is_still_pausing(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.feedback(7)
    robot.hold()
    robot.report(speed_mps=1.0)
    robot.release()

    assert robot.task.status is TaskPhase.RUNNING
    assert len(robot.goals) == 2


def test_progress_never_goes_back_over_pauses(robot: ScriptedRobot) -> None:
    robot.submit_task()
    for index in (3, 9, 9, 5, 15):
        robot.feedback(index)
        robot.hold()
        robot.release()

    assert [goal.start_index for goal in robot.goals] == [0, 3, 9, 9, 9, 15]


def test_only_the_last_of_several_holds_lets_the_task_go_on(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.hold("operator", "lunch")
    robot.hold("gate", "closed")
    robot.release("operator")
    assert robot.status == "PAUSED_TASK"
    assert robot.task.reason == "closed"
    robot.release("gate")

    assert robot.status == "RUNNING_TASK"
    assert len(robot.goals) == 2


def test_a_hold_is_kept_across_a_replaced_task(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.hold()
    robot.submit_task(straight(y_m=0.5))
    assert robot.status == "PAUSED_TASK"
    robot.release()

    assert [goal.path.waypoint(0).y_m for goal in robot.goals] == [0.0, 0.5]


def test_a_hold_without_a_task_holds_the_next_one(robot: ScriptedRobot) -> None:
    robot.hold()
    robot.submit_task()

    assert robot.goals == []
    assert robot.task.status is TaskPhase.PAUSED


def test_a_hold_set_again_keeps_who_set_it_first_and_takes_the_new_reason(
    robot: ScriptedRobot,
) -> None:
    robot.hold(reason="lunch")
    since = robot.core.driving.holds["operator"].since
    robot.stay_silent(0.1)
    robot.hold(reason="still lunch")
    hold = robot.core.driving.holds["operator"]

    assert (hold.since, hold.reason) == (since, "still lunch")
    assert len(robot.happened("hold.set")) == 1


# --- cancel and end ------------------------------------------------------------------------------


def test_cancel_stops_and_ends_the_task_at_once(robot: ScriptedRobot) -> None:
    robot.submit_task()
    canceled = robot.cancel_task()

    assert commands_of(canceled) == ["PreemptGoal", "Drive"]
    assert (robot.status, robot.state) == ("NO_TASK", "IDLE")
    assert robot.task.status is TaskPhase.CANCELED


def test_cancel_while_pausing_leaves_nothing_to_resume(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.hold()
    robot.report(speed_mps=1.0)
    robot.cancel_task()
    robot.release()

    assert len(robot.goals) == 1
    assert robot.status == "NO_TASK"


def test_cancel_without_a_task_changes_nothing(robot: ScriptedRobot) -> None:
    outputs = robot.cancel_task()

    assert (outputs.commands, outputs.events) == ((), ())


def test_a_goal_that_succeeds_ends_the_task_with_its_whole_progress(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.feedback(20)
    ended = robot.arrive()

    assert commands_of(ended) == ["Drive"]
    assert (robot.task.status, robot.task.progress) == (TaskPhase.SUCCEEDED, 1.0)
    assert (robot.status, robot.state) == ("NO_TASK", "IDLE")


def test_a_goal_that_is_given_up_ends_the_task_with_the_reason(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.arrive(succeeded=False, reason="no progress for 20 s")

    assert robot.task.status is TaskPhase.ABORTED
    assert robot.task.reason == "no progress for 20 s"
    assert robot.stops == 1


def test_what_the_vehicle_rolls_over_while_it_stops_is_driven(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.hold()
    robot.feedback(15, robot.goals[0])
    robot.release()

    assert robot.task.target_index == 15
    assert robot.goals[-1].start_index == 15


def test_a_goal_taken_back_has_no_result(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.hold()
    robot.arrive()

    assert robot.task.status is TaskPhase.PAUSING


def test_what_navigation_says_late_does_not_touch_the_task_that_came_after(
    robot: ScriptedRobot,
) -> None:
    robot.submit_task()
    robot.submit_task(straight(y_m=0.5))
    robot.feedback(15, robot.goals[0])

    assert robot.task.target_index == 0


def test_progress_counts_by_distance_from_where_the_task_began(robot: ScriptedRobot) -> None:
    robot.report(x_m=10.0)
    robot.submit_task(start_index=10)
    robot.feedback(15)

    assert robot.task.distance_m == 4.5
    assert robot.task.progress == 0.45


def test_each_event_of_a_task_leads_back_to_what_caused_it(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.read(estop=True)
    by_id = {event.id: event for event in robot.events}
    pausing = next(event for event in robot.events if event.kind == "task.pausing")
    way = [pausing.kind]
    while (cause := by_id[pausing.id].cause) is not None:
        pausing = by_id[cause]
        way.append(pausing.kind)

    assert way == ["task.pausing", "hold.set", "error.raised", "signal.read"]


def test_ended_tasks_can_be_read_and_unknown_ones_not(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.cancel_task()

    assert robot.core.driving.task("t1").ended_at == robot.now
    with pytest.raises(UnknownTaskError):
        robot.core.driving.task("t2")


def test_not_one_command_to_drive_follows_a_goal_that_is_taken_back(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.hold()
    after = robot.commands[robot.commands.index(PreemptGoal(robot.goals[0].goal)) :]

    assert all(c.command.speed_mps == 0 for c in after if isinstance(c, Drive))


def test_what_is_left_of_a_path_that_stands_still_is_nothing_to_drive(robot: ScriptedRobot) -> None:
    path = Path(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
    with pytest.raises(InvalidValueError) as refused:
        robot.submit_task(path, start_index=1)

    assert refused.value.message == "no path is left after this waypoint"
    assert refused.value.pointer == "start_index"


@pytest.mark.parametrize("speed_mps", [0.099, 11.3])
def test_a_speed_that_the_vehicle_does_not_go_is_refused(speed_mps: float) -> None:
    limits = VehicleLimits()
    with pytest.raises(InvalidValueError, match="is not within") as refused:
        check_cruise(speed_mps, limits)

    assert refused.value.pointer == "speed_mps"
    check_cruise(MIN_CRUISE_MPS, limits)
    check_cruise(limits.max_speed_mps, limits)


def test_a_refused_start_names_the_nearest_waypoint_with_a_path_behind_it(
    robot: ScriptedRobot,
) -> None:
    robot.report(x_m=19.9)
    with pytest.raises(FarStartError) as refused:
        robot.submit_task(straight())
    assert refused.value.hint == "waypoint 19 is 0.9 m away: start there with start_index"
    robot.report(x_m=40.0)
    with pytest.raises(FarStartError) as refused:
        robot.submit_task(straight())

    assert refused.value.nearest is None


# --- what is told --------------------------------------------------------------------------------


def told(robot: ScriptedRobot, *kinds: str) -> list[tuple[str, str, dict[str, object]]]:
    """Return events of tasks and holds: kind, kind of the cause, and data."""
    by_id = {event.id: event for event in robot.events}
    return [
        (event.kind, by_id[event.cause].kind if event.cause else "", dict(event.data))
        for event in robot.events
        if event.kind.startswith(kinds)
    ]


def test_the_life_of_a_task_is_told_with_what_caused_each_turn(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.feedback(7)
    robot.hold()
    robot.report()
    robot.release()
    robot.arrive()

    assert told(robot, "task.") == [
        (
            "task.requested",
            "",
            {
                "waypoints": 21,
                "length_m": 20.0,
                "start_index": 0,
                "controller": "pure_pursuit",
                "speed_mps": 2.8,
            },
        ),
        ("task.served", "task.requested", {"task": "t1", "waypoints": 21, "length_m": 20.0}),
        ("task.started", "task.served", {"task": "t1", "goal": 1, "target_index": 0}),
        ("task.pausing", "hold.set", {"task": "t1", "reason": "lunch"}),
        ("task.paused", "vehicle.reported", {"task": "t1", "reason": "lunch"}),
        ("task.resumed", "hold.released", {"task": "t1", "goal": 2, "target_index": 7}),
        ("task.succeeded", "goal.ended", {"task": "t1", "reason": None, "progress": 1.0}),
    ]


def test_a_hold_is_told_when_it_is_set_and_when_it_goes(robot: ScriptedRobot) -> None:
    robot.hold("gate", "closed")
    robot.hold("gate", "still closed")
    robot.release("gate")
    robot.release("gate")

    assert told(robot, "hold.set", "hold.released") == [
        ("hold.set", "hold.requested", {"owner": "gate", "reason": "closed"}),
        ("hold.released", "hold.release_requested", {"owner": "gate"}),
    ]


def test_a_task_served_while_held_and_standing_is_told_as_paused_because_of_that(
    robot: ScriptedRobot,
) -> None:
    robot.hold()
    robot.submit_task()

    assert told(robot, "task.")[2:] == [
        ("task.paused", "task.served", {"task": "t1", "reason": "lunch"})
    ]


def test_a_task_served_while_held_and_still_rolling_is_pausing(robot: ScriptedRobot) -> None:
    robot.report(speed_mps=1.0)
    robot.hold()
    robot.submit_task()

    assert robot.task.status is TaskPhase.PAUSING


def test_what_ends_a_task_is_told_with_how_far_it_came(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.feedback(10)
    robot.stay_silent(0.1)
    robot.submit_task(straight(y_m=0.5))
    robot.stay_silent(0.1)
    robot.cancel_task()

    assert told(robot, "task.canceled") == [
        (
            "task.canceled",
            "task.requested",
            {"task": "t1", "reason": "replaced by t2", "progress": 0.475},
        ),
        (
            "task.canceled",
            "task.cancel_requested",
            {"task": "t2", "reason": "canceled", "progress": 0.0},
        ),
    ]
    assert robot.core.driving.task("t1").ended_at == seconds(0.1)
    assert robot.core.driving.task("t2").created_at == seconds(0.1)
    assert robot.core.driving.task("t2").ended_at == seconds(0.2)


def test_a_task_that_begins_too_far_away_once_that_is_known_ends_with_that_cause() -> None:
    robot = ScriptedRobot(pose=False)
    robot.submit_task(straight(y_m=8.0))
    robot.stay_silent(0.1)
    robot.report()

    reason = "the path begins 8.0 m from the vehicle; at most 5 m"
    assert told(robot, "task.aborted") == [
        ("task.aborted", "hold.released", {"task": "t1", "reason": reason, "progress": 0.0})
    ]
    assert robot.task.ended_at == seconds(0.1)


def test_how_navigation_ended_it_and_when_can_be_read_afterwards(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.stay_silent(0.1)
    robot.arrive(succeeded=False, reason="no progress for 20 s")

    assert (robot.task.ended_at, robot.task.reason) == (seconds(0.1), "no progress for 20 s")


def test_a_task_that_just_goes_on_is_told_as_changed_and_one_that_waits_is_not(
    robot: ScriptedRobot,
) -> None:
    assert robot.submit_task().task_changed
    assert robot.feedback(3).task_changed
    assert robot.hold().task_changed
    assert robot.hold(reason="still lunch").task_changed
    assert not robot.hold(reason="still lunch").task_changed
    assert robot.cancel_task().task_changed
    assert not robot.cancel_task().task_changed


def test_a_goal_tells_navigation_everything_about_the_task(robot: ScriptedRobot) -> None:
    robot.report(x_m=3.0)
    path = straight()
    robot.submit_task(path, start_index=3, controller="stanley")
    goal = robot.goals[0].goal
    ahead, command = Point(9.0, 0.0), DriveCommand(2.8, 0.0)
    robot.give(GoalFeedback(goal, 8, 7.5, 0.0, ahead, command, left_out_m=0.7))
    robot.hold()
    robot.release()
    seen = VehicleState(Pose(3.0, 0.0, 0.0), 0.0, 0.0)

    assert robot.goals == [
        SendGoal(GoalId(1), path, 3, 3, "stanley", 2.8, 3.0, 0.0),
        SendGoal(GoalId(2), path, 3, 8, "stanley", 2.8, 7.5, 0.7, seen),
    ]


@pytest.mark.parametrize(
    ("start_index", "words"), [(-1, "start_index -1 is not within 0 to 19"), (20, "0 to 19")]
)
def test_a_refused_start_says_which_ones_there_are(
    robot: ScriptedRobot, start_index: int, words: str
) -> None:
    with pytest.raises(InvalidValueError, match=words) as refused:
        robot.submit_task(start_index=start_index)

    assert refused.value.pointer == "start_index"


def test_a_task_can_be_traced_to_who_asked_for_it(robot: ScriptedRobot) -> None:
    robot.submit_task()
    asked = next(event for event in robot.events if event.kind == "task.requested")

    assert robot.task.cause == asked.id
    assert asked.actor.label == "operator"


def test_a_hold_of_a_task_that_has_no_goal_any_more_does_not_make_it_pause_again(
    robot: ScriptedRobot,
) -> None:
    robot.submit_task()
    robot.hold("gate", "closed")
    robot.report()
    robot.hold("operator", "lunch")

    assert robot.task.status is TaskPhase.PAUSED
    assert len(robot.preempted) == 1


def test_the_last_waypoint_but_one_is_a_start(robot: ScriptedRobot) -> None:
    robot.report(x_m=19.0)
    robot.submit_task(start_index=19)

    assert robot.task.length_m == 1


def test_an_unknown_controller_is_named(robot: ScriptedRobot) -> None:
    with pytest.raises(UnknownControllerError, match="there is no controller 'magic'"):
        robot.submit_task(controller="magic")


def test_the_nearest_waypoint_is_found_in_both_directions_and_up_to_the_limit(
    robot: ScriptedRobot,
) -> None:
    diagonal = Path(
        np.array([[10.0, 9.0, 0.0], [6.0, 5.0, 0.0], [3.0, 4.0, 0.0], [30.0, 0.0, 0.0]])
    )
    with pytest.raises(FarStartError) as refused:
        robot.submit_task(diagonal)

    assert refused.value.nearest == (2, 5.0)


def test_without_a_pose_there_is_no_nearest_waypoint_and_no_refusal() -> None:
    robot = ScriptedRobot(pose=False)
    robot.submit_task(straight(y_m=50.0))

    assert robot.task.status is TaskPhase.PAUSING


def test_a_speed_is_refused_with_what_the_vehicle_can() -> None:
    with pytest.raises(InvalidValueError) as refused:
        check_cruise(0.05, VehicleLimits(max_speed_mps=3.0))

    assert refused.value.message == "speed 0.05 m/s is not within 0.1 to 3 m/s"


def test_the_nearest_waypoint_is_the_one_near_where_the_vehicle_is(robot: ScriptedRobot) -> None:
    robot.give(VehicleReport(VehicleState(Pose(10.0, 4.0, 0.0), 0.0, 0.0)))
    places = [[0.0, 0.0, 0.0], [10.0, -4.0, 0.0], [10.0, 1.0, 0.0], [30.0, 0.0, 0.0]]
    with pytest.raises(FarStartError) as refused:
        robot.submit_task(Path(np.array(places)))

    assert refused.value.nearest == (2, 3.0)


# --- over a restart ------------------------------------------------------------------------------


def restarted(before: ScriptedRobot, settings: SupervisionSettings | None = None) -> ScriptedRobot:
    """Return a robot whose service was started anew, before it hears of its vehicle."""
    robot = ScriptedRobot(pose=False, good=False, settings=settings, start=before.now)
    robot.give(Restored(before.all_kept(), boot=2, next_task=8))
    return robot


def test_a_task_is_kept_when_it_is_accepted(robot: ScriptedRobot) -> None:
    robot.submit_task(straight(30.0), start_index=2)

    kept = robot.kept[KeptTask, "t1"]
    assert isinstance(kept, KeptTask)
    assert (kept.path.count, kept.start_index, kept.speed_mps) == (31, 2, 2.8)


def test_the_first_progress_of_a_run_is_kept_at_once(robot: ScriptedRobot) -> None:
    """Also what a vehicle rolled over unseen while the service was restarted."""
    robot.submit_task()
    robot.feedback(4)

    assert (robot.progress().has_run, robot.progress().distance_m) == (True, 3.5)


def test_progress_is_kept_at_once_when_the_task_is_held(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.feedback(3)
    robot.hold()
    assert (robot.progress().target_index, robot.progress().distance_m) == (3, 2.5)

    robot.feedback(4)
    robot.report()
    assert robot.task.status is TaskPhase.PAUSED
    assert (robot.progress().target_index, robot.progress().distance_m) == (4, 3.5)


def test_progress_is_kept_while_the_task_drives(robot: ScriptedRobot) -> None:
    robot.submit_task()
    for waypoint in range(1, 11):
        robot.advance(0.1, speed_mps=2.8)
        robot.feedback(waypoint)

    assert robot.task.distance_m - robot.progress().distance_m <= 3.0, "0.3 s ago"


@pytest.mark.parametrize("succeeded", [True, False])
def test_how_a_task_ended_is_kept(robot: ScriptedRobot, succeeded: bool) -> None:
    robot.submit_task()
    robot.arrive(succeeded=succeeded, reason="" if succeeded else "no progress")
    after = restarted(robot)

    assert after.task == robot.task
    assert "restart" not in after.core.driving.holds
    assert after.status == "NO_TASK"


def test_a_task_that_replaces_another_is_the_only_one_that_waits(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.submit_task()
    after = restarted(robot)

    assert [(task.id, task.status) for task in after.core.driving.tasks()] == [
        ("t2", "PAUSED"),
        ("t1", "CANCELED"),
    ]


def test_a_task_that_is_no_longer_shown_is_no_longer_kept(
    robot: ScriptedRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("domain.tasks.task_log.MAX_KEPT", 2)
    for _ in range(3):
        robot.submit_task()

    assert robot.kept[KeptTask, "t1"] is robot.kept[KeptProgress, "t1"] is None
    assert [task.id for task in restarted(robot).core.driving.tasks()] == ["t3", "t2"]


def test_after_a_restart_the_task_waits_for_a_person(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.feedback(9)
    robot.hold()
    robot.release()
    after = restarted(robot)
    assert (after.task.id, after.task.status, after.task.distance_m) == ("t1", "PAUSED", 8.5)
    hold = after.core.driving.holds["restart"]
    assert (hold.by, hold.since, hold.reason) == ("", after.now, RESTART_REASON)
    assert after.happened("hold.set") == [{"owner": "restart", "reason": RESTART_REASON}]
    assert [event["task"] for event in after.happened("task.paused")] == ["t1"]

    after.advance(5.0)
    assert after.goals == []
    assert after.task.reason == RESTART_REASON
    assert after.status == "PAUSED_TASK"


def test_the_task_goes_on_from_where_it_was_when_the_hold_is_released(
    robot: ScriptedRobot,
) -> None:
    robot.submit_task()
    robot.report(2.0, 8.4)
    robot.feedback(9)
    robot.hold()
    after = restarted(robot)
    after.advance(0.5)
    after.release("restart")
    assert after.goals == [], "somebody else holds it as well"
    after.release()

    (goal,) = after.goals
    assert (goal.start_index, goal.reached_m, goal.path.count) == (9, 8.5, 21)
    assert goal.seen is not None
    assert (goal.seen.pose.x_m, goal.seen.speed_mps) == (8.4, 2.0)
    after.arrive()
    assert (after.task.status, after.task.progress) == ("SUCCEEDED", 1.0)


def test_where_the_vehicle_was_seen_stays_with_the_progress_until_there_is_more(
    robot: ScriptedRobot,
) -> None:
    robot.submit_task()
    robot.report(2.0, 8.4)
    robot.feedback(9)
    robot.hold()
    after = restarted(robot)
    after.read(**GOOD)
    after.report(0.0, 12.0)
    after.release()
    after.release("restart")
    after.hold()
    after.release()
    after.feedback(13)
    after.hold()
    after.release()

    assert [goal.seen.pose.x_m for goal in after.goals if goal.seen] == [8.4, 8.4, 12.0]


def test_a_task_that_never_ran_is_checked_for_its_start_when_it_does(robot: ScriptedRobot) -> None:
    robot.hold()
    robot.submit_task()
    after = restarted(robot)
    after.advance(0.5)
    after.report(x_m=9.0)
    after.release()
    after.release("restart")

    assert after.task.status is TaskPhase.ABORTED
    assert after.task.reason is not None
    assert after.task.reason.startswith("the path begins 9.0 m from the vehicle")


def test_the_hold_of_the_restart_ends_with_the_task_and_not_with_its_replacement(
    robot: ScriptedRobot,
) -> None:
    robot.submit_task()
    after = restarted(robot)
    after.advance(0.5)
    after.submit_task()
    assert (after.task.id, after.task.status, after.goals) == ("t8", "PAUSED", [])

    after.cancel_task()
    assert dict(after.core.driving.holds) == {}
    assert after.happened("hold.released")[-1] == {"owner": "restart"}
    after.submit_task()
    assert (after.task.id, after.task.status) == ("t9", "RUNNING")


def test_a_second_restart_holds_the_task_again(robot: ScriptedRobot) -> None:
    robot.submit_task()
    first = restarted(robot)
    first.kept = robot.kept | first.kept
    first.advance(0.5)
    first.release("restart")
    second = restarted(first)

    assert second.task.status is TaskPhase.PAUSED
    assert "restart" in second.core.driving.holds


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"controller": "magic"}, "there is no controller 'magic'"),
        ({"speed_mps": 20.0}, "speed 20 m/s is not within 0.1 to 11.2 m/s"),
    ],
)
def test_a_task_that_cannot_be_driven_any_more_is_aborted_and_told(
    robot: ScriptedRobot, change: dict[str, Any], reason: str
) -> None:
    robot.submit_task()
    kept = robot.kept[KeptTask, "t1"]
    assert isinstance(kept, KeptTask)
    robot.kept[KeptTask, "t1"] = replace(kept, **change)
    after = restarted(robot)

    assert (after.task.status, after.task.reason) == ("ABORTED", reason)
    assert [event["reason"] for event in after.happened("task.aborted")] == [reason]
    assert "restart" not in after.core.driving.holds
    assert after.progress().ended_as == "ABORTED"


def test_a_task_whose_end_was_lost_is_not_driven_after_a_newer_one(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.submit_task()
    robot.kept[KeptProgress, "t1"] = None
    after = restarted(robot)

    assert [(task.id, task.status, task.reason) for task in after.core.driving.tasks()][1:] == [
        ("t1", "ABORTED", "how it ended was not written down")
    ]
    assert after.task.status is TaskPhase.PAUSED


def test_a_first_run_begins_without_a_task(robot: ScriptedRobot) -> None:
    after = ScriptedRobot(pose=False, good=False)

    assert after.give(Restored()) == Outputs()
    after.advance(0.5)
    after.submit_task()
    assert (after.task.id, after.task.status) == ("t1", "RUNNING")
