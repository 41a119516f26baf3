from domain.identifiers import GoalId, TaskId
from domain.inputs import GoalFeedback
from domain.snapshot import TaskPhase, TaskView
from domain.tasks.task import Task
from domain.vehicle import DriveCommand, Point
from tests.support.paths import straight


def task(start_index: int = 0) -> Task:
    return Task(TaskId("t1"), straight(), "stanley", 2.8, start_index, created_at=5, cause=3)


def feedback(target_index: int, distance_m: float) -> GoalFeedback:
    point, command = Point(0.0, 0.0), DriveCommand(1.0, 0.0)
    return GoalFeedback(GoalId(1), target_index, distance_m, -0.1, point, command)


def test_it_begins_at_its_start_with_nothing_covered() -> None:
    view = task(start_index=4).view()

    assert (view.start_index, view.target_index) == (4, 4)
    assert (view.length_m, view.distance_m, view.progress) == (16.0, 0.0, 0.0)
    assert view.cross_track_error_m is None


def test_it_advances_and_never_goes_back() -> None:
    driven = task()
    driven.advance(feedback(8, 7.5), None)
    driven.advance(feedback(6, 5.5), None)
    view = driven.view()

    assert (view.target_index, view.distance_m) == (8, 7.5)
    assert view.cross_track_error_m == -0.1


def test_a_vehicle_behind_the_start_has_covered_nothing() -> None:
    driven = task(start_index=4)
    driven.advance(feedback(4, 3.2), None)

    assert driven.view().distance_m == 0.0


def test_one_that_succeeded_is_done_to_the_last_bit() -> None:
    driven = task()
    driven.advance(feedback(20, 19.8), None)
    driven.end(TaskPhase.SUCCEEDED, None, 90)
    view = driven.view()

    assert (view.progress, view.ended_at) == (1.0, 90)


def test_one_that_was_given_up_keeps_what_it_had_covered() -> None:
    driven = task()
    driven.advance(feedback(11, 10.0), None)
    driven.end(TaskPhase.ABORTED, "no progress for 20 s", 90)
    view = driven.view()

    assert (view.progress, view.reason) == (0.5, "no progress for 20 s")


def test_all_that_is_known_of_it_can_be_seen() -> None:
    driven = task(start_index=4)
    driven.advance(feedback(12, 11.0), None)

    assert driven.view() == TaskView(
        id=TaskId("t1"),
        status=TaskPhase.PAUSED,
        controller="stanley",
        speed_mps=2.8,
        waypoint_count=21,
        length_m=16.0,
        start_index=4,
        target_index=12,
        progress=7.0 / 16.0,
        distance_m=7.0,
        cross_track_error_m=-0.1,
        reason=None,
        created_at=5,
        ended_at=None,
        cause=3,
    )
    assert driven.reached_m == 11.0


def test_progress_is_never_more_than_the_whole() -> None:
    driven = task()
    driven.advance(feedback(20, 20.5), None)

    assert driven.view().progress == 1.0


def test_one_that_ended_has_no_goal() -> None:
    driven = task()
    driven.goal = GoalId(7)
    driven.end(TaskPhase.CANCELED, "canceled", 90)

    assert driven.goal is None
