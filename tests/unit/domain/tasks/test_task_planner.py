import pytest

from domain.errors import (
    FarStartError,
    InvalidValueError,
    UnknownControllerError,
    UnknownTaskError,
)
from domain.messages import Drive, Outputs, PreemptGoal
from domain.snapshot import TaskPhase
from tests.support.driver import Driver, straight


def commands_of(outputs: Outputs) -> list[str]:
    return [type(command).__name__ for command in outputs.commands]


# --- serve ---------------------------------------------------------------------------------------


def test_a_task_that_nothing_holds_is_one_goal_from_its_first_waypoint() -> None:
    robot = Driver()
    served = robot.serve()

    assert commands_of(served) == ["SendGoal"]
    assert robot.goals[0].start_index == 0
    assert (robot.status, robot.state) == ("RUNNING_TASK", "RUNNING")
    assert robot.task.status is TaskPhase.RUNNING


def test_running_for_a_while_sends_nothing_twice() -> None:
    robot = Driver()
    robot.serve()
    robot.live(2.0, speed_mps=2.8)

    assert len(robot.goals) == 1


def test_a_task_served_in_error_is_taken_and_waits() -> None:
    robot = Driver()
    robot.read(estop=True)
    robot.serve()

    assert (robot.status, robot.state) == ("PAUSED_TASK", "ERROR")
    assert robot.task.status is TaskPhase.PAUSED
    assert robot.goals == []


def test_a_task_served_in_error_starts_when_the_error_ends() -> None:
    robot = Driver()
    robot.read(estop=True)
    robot.serve()
    robot.live(0.5)

    assert len(robot.goals) == 1
    assert (robot.status, robot.state) == ("RUNNING_TASK", "RUNNING")
    assert [data["task"] for data in robot.happened("task.started")] == ["t1"]


def test_a_new_task_takes_the_place_of_a_running_one_without_a_stop() -> None:
    robot = Driver()
    robot.serve()
    robot.feedback(9)
    replaced = robot.serve(straight(y_m=0.5))

    assert commands_of(replaced) == ["PreemptGoal", "SendGoal"]
    assert robot.goals[1].start_index == 0
    assert robot.status == "RUNNING_TASK"
    assert robot.core.driving.task("t1").status is TaskPhase.CANCELED
    assert robot.core.driving.task("t1").reason == "replaced by t2"


def test_of_two_tasks_served_in_error_the_last_one_runs() -> None:
    robot = Driver()
    robot.read(estop=True)
    robot.serve()
    robot.serve(straight(y_m=0.5))
    robot.live(0.5)

    assert [goal.path.waypoint(0).y_m for goal in robot.goals] == [0.5]


def test_a_task_may_begin_at_a_later_waypoint() -> None:
    robot = Driver()
    robot.serve(start_index=3)

    assert robot.goals[0].start_index == 3
    assert robot.task.length_m == 17


@pytest.mark.parametrize("start_index", [-1, 20, 21])
def test_a_start_with_no_path_behind_it_is_refused(start_index: int) -> None:
    robot = Driver()
    with pytest.raises(InvalidValueError, match="start_index"):
        robot.serve(start_index=start_index)

    assert robot.core.driving.current_task is None


def test_an_unknown_controller_is_refused_and_the_known_ones_are_named() -> None:
    robot = Driver()
    with pytest.raises(UnknownControllerError) as refused:
        robot.serve(controller="magic")

    assert refused.value.hint == "known: pure_pursuit, stanley"


def test_a_path_that_begins_more_than_five_metres_away_is_refused() -> None:
    robot = Driver()
    with pytest.raises(FarStartError, match=r"begins 5\.1 m from the vehicle"):
        robot.serve(straight(y_m=5.1))
    robot.serve(straight(y_m=5.0))

    assert robot.task.status is TaskPhase.RUNNING


def test_where_the_vehicle_was_unknown_the_distance_is_judged_at_the_start() -> None:
    robot = Driver(pose=False)
    robot.serve(straight(y_m=8.0))
    assert robot.status == "PAUSED_TASK"
    robot.report()

    assert robot.task.status is TaskPhase.ABORTED
    assert robot.task.reason == "the path begins 8.0 m from the vehicle; at most 5 m"
    assert robot.goals == []


# --- holds ---------------------------------------------------------------------------------------


def test_an_error_takes_the_goal_back_and_stops_in_the_same_step() -> None:
    robot = Driver()
    robot.serve()
    robot.report(speed_mps=2.8, steering_rad=0.2)
    stopped = robot.read(estop=True)

    assert commands_of(stopped) == ["PreemptGoal", "Drive"]
    assert [drive.command.speed_mps for drive in robot.sent(Drive)] == [0.0]
    assert (robot.status, robot.state) == ("PAUSED_TASK", "ERROR")
    assert robot.task.status is TaskPhase.PAUSING


def test_a_stop_leaves_the_wheels_as_they_are() -> None:
    robot = Driver()
    robot.serve()
    robot.report(speed_mps=2.8, steering_rad=0.2)
    robot.hold()

    assert robot.sent(Drive)[0].command.steering_angle_rad == 0.2


def test_a_held_task_is_paused_once_the_vehicle_is_seen_to_stand() -> None:
    robot = Driver()
    robot.serve()
    robot.hold()
    robot.report(speed_mps=0.06)
    assert robot.task.status == "PAUSING"
    robot.report(speed_mps=0.04)

    assert robot.task.status is TaskPhase.PAUSED
    assert robot.task.reason == "lunch"


def test_a_released_task_goes_on_from_the_first_waypoint_not_yet_passed() -> None:
    robot = Driver()
    robot.serve()
    robot.feedback(7)
    robot.hold()
    robot.report()
    robot.release()

    assert [goal.start_index for goal in robot.goals] == [0, 7]
    assert robot.happened("task.resumed") == [{"task": "t1", "goal": 2, "target_index": 7}]


def test_a_task_goes_on_even_while_it_is_still_pausing() -> None:
    robot = Driver()
    robot.serve()
    robot.feedback(7)
    robot.hold()
    robot.report(speed_mps=1.0)
    robot.release()

    assert robot.task.status is TaskPhase.RUNNING
    assert len(robot.goals) == 2


def test_progress_never_goes_back_over_pauses() -> None:
    robot = Driver()
    robot.serve()
    for index in (3, 9, 9, 5, 15):
        robot.feedback(index)
        robot.hold()
        robot.release()

    assert [goal.start_index for goal in robot.goals] == [0, 3, 9, 9, 9, 15]


def test_only_the_last_of_several_holds_lets_the_task_go_on() -> None:
    robot = Driver()
    robot.serve()
    robot.hold("operator", "lunch")
    robot.hold("gate", "closed")
    robot.release("operator")
    assert robot.status == "PAUSED_TASK"
    assert robot.task.reason == "closed"
    robot.release("gate")

    assert robot.status == "RUNNING_TASK"
    assert len(robot.goals) == 2


def test_a_hold_is_kept_across_a_replaced_task() -> None:
    robot = Driver()
    robot.serve()
    robot.hold()
    robot.serve(straight(y_m=0.5))
    assert robot.status == "PAUSED_TASK"
    robot.release()

    assert [goal.path.waypoint(0).y_m for goal in robot.goals] == [0.0, 0.5]


def test_a_hold_without_a_task_holds_the_next_one() -> None:
    robot = Driver()
    robot.hold()
    robot.serve()

    assert robot.goals == []
    assert robot.task.status is TaskPhase.PAUSED


def test_a_hold_set_again_keeps_who_set_it_first_and_takes_the_new_reason() -> None:
    robot = Driver()
    robot.hold(reason="lunch")
    since = robot.core.driving.holds["operator"].since
    robot.wait(0.1)
    robot.hold(reason="still lunch")
    hold = robot.core.driving.holds["operator"]

    assert (hold.since, hold.reason) == (since, "still lunch")
    assert len(robot.happened("hold.set")) == 1


# --- cancel and end ------------------------------------------------------------------------------


def test_cancel_stops_and_ends_the_task_at_once() -> None:
    robot = Driver()
    robot.serve()
    canceled = robot.cancel()

    assert commands_of(canceled) == ["PreemptGoal", "Drive"]
    assert (robot.status, robot.state) == ("NO_TASK", "IDLE")
    assert robot.task.status is TaskPhase.CANCELED


def test_cancel_while_pausing_leaves_nothing_to_resume() -> None:
    robot = Driver()
    robot.serve()
    robot.hold()
    robot.report(speed_mps=1.0)
    robot.cancel()
    robot.release()

    assert len(robot.goals) == 1
    assert robot.status == "NO_TASK"


def test_cancel_without_a_task_changes_nothing() -> None:
    robot = Driver()
    outputs = robot.cancel()

    assert (outputs.commands, outputs.events) == ((), ())


def test_a_goal_that_succeeds_ends_the_task_with_its_whole_progress() -> None:
    robot = Driver()
    robot.serve()
    robot.feedback(20)
    ended = robot.arrive()

    assert commands_of(ended) == ["Drive"]
    assert (robot.task.status, robot.task.progress) == (TaskPhase.SUCCEEDED, 1.0)
    assert (robot.status, robot.state) == ("NO_TASK", "IDLE")


def test_a_goal_that_is_given_up_ends_the_task_with_the_reason() -> None:
    robot = Driver()
    robot.serve()
    robot.arrive(succeeded=False, reason="no progress for 20 s")

    assert robot.task.status is TaskPhase.ABORTED
    assert robot.task.reason == "no progress for 20 s"
    assert robot.stops == 1


def test_what_navigation_says_late_of_a_goal_taken_back_is_void() -> None:
    robot = Driver()
    robot.serve()
    robot.hold()
    robot.feedback(15)
    robot.arrive()

    assert robot.task.status is TaskPhase.PAUSING
    assert robot.task.target_index == 0


def test_what_navigation_says_late_does_not_touch_the_task_that_came_after() -> None:
    robot = Driver()
    robot.serve()
    robot.serve(straight(y_m=0.5))
    robot.feedback(15, robot.goals[0])

    assert robot.task.target_index == 0


def test_progress_counts_by_distance_from_where_the_task_began() -> None:
    robot = Driver()
    robot.report(x_m=10.0)
    robot.serve(start_index=10)
    robot.feedback(15)

    assert robot.task.distance_m == 4.5
    assert robot.task.progress == 0.45


def test_each_event_of_a_task_leads_back_to_what_caused_it() -> None:
    robot = Driver()
    robot.serve()
    robot.read(estop=True)
    by_id = {event.id: event for event in robot.events}
    pausing = next(event for event in robot.events if event.kind == "task.pausing")
    way = [pausing.kind]
    while (cause := by_id[pausing.id].cause) is not None:
        pausing = by_id[cause]
        way.append(pausing.kind)

    assert way == ["task.pausing", "hold.set", "error.raised", "signal.read"]


def test_ended_tasks_can_be_read_and_unknown_ones_not() -> None:
    robot = Driver()
    robot.serve()
    robot.cancel()

    assert robot.core.driving.task("t1").ended_at == robot.now
    with pytest.raises(UnknownTaskError):
        robot.core.driving.task("t2")


def test_not_one_command_to_drive_follows_a_goal_that_is_taken_back() -> None:
    robot = Driver()
    robot.serve()
    robot.hold()
    after = robot.commands[robot.commands.index(PreemptGoal(robot.goals[0].goal)) :]

    assert all(c.command.speed_mps == 0 for c in after if isinstance(c, Drive))
