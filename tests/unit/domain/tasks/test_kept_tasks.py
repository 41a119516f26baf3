"""What is kept of tasks and when, and what becomes of it after a restart."""

from dataclasses import replace

import pytest

from domain.identifiers import TaskId
from domain.kept import Keeping, Kept, KeptProgress, KeptTask
from domain.outbox import Outbox
from domain.snapshot import TaskPhase
from domain.tasks.kept_tasks import TaskKeeper, tasks_of
from domain.tasks.task import Task
from domain.timebase import seconds
from domain.vehicle import Pose, VehicleState
from tests.support.paths import straight

PATH = straight()
T1 = TaskId("t1")
ASKED = KeptTask(T1, PATH, "stanley", 2.8, 2, created_at=5, cause=3)
DRIVEN = KeptProgress(
    T1, True, 9, 6.5, 0.25, -0.1, seen=VehicleState(Pose(8.5, 0.0, 0.0), 2.0, 0.0)
)


def task(number: int = 1) -> Task:
    return Task(TaskId(f"t{number}"), PATH, "stanley", 2.8, 2, created_at=5, cause=3)


class Keeper:
    """A keeper, and what it wants to be kept."""

    def __init__(self) -> None:
        self.outbox = Outbox()
        self.keeper = TaskKeeper(self.outbox)

    def told(self) -> list[Keeping]:
        return list(self.outbox.take().kept)


def only(*kept: Kept, now: int = 100) -> Task:
    """Return the one task that comes back."""
    tasks, left_out = tasks_of(kept, now)
    assert left_out == {}
    (back,) = tasks
    return back


# --- what is kept --------------------------------------------------------------------------------


def test_a_new_task_is_kept_as_it_was_asked_for() -> None:
    kept = Keeper()
    kept.keeper.add(task())

    assert [item.value for item in kept.told()] == [ASKED]


def test_progress_is_kept_without_the_path_and_at_most_four_times_a_second() -> None:
    kept, driven = Keeper(), task()
    kept.keeper.note(driven, seconds(1))
    kept.told()
    times = [1.05, 1.1, 1.24, 1.25, 1.3, 1.49, 1.5, 2.0]
    written = []
    for at_s in times:
        kept.keeper.note_driven(driven, seconds(at_s))
        written += [at_s for item in kept.told() if item.kind is KeptProgress]

    assert written == [1.25, 1.5, 2.0]


def test_progress_is_kept_with_the_vehicle_as_it_was_then() -> None:
    kept, driven = Keeper(), task()
    driven.seen = DRIVEN.seen
    kept.keeper.note(driven, 7)

    (item,) = kept.told()
    assert isinstance(item.value, KeptProgress)
    assert item.value.seen == DRIVEN.seen


def test_an_end_is_kept_with_its_reason_and_its_time() -> None:
    kept, driven = Keeper(), task()
    driven.end(TaskPhase.ABORTED, "no progress", 77)
    kept.keeper.note(driven, 77)

    (item,) = kept.told()
    assert item.value == KeptProgress(
        T1, False, 2, 0.0, 0.0, ended_as="ABORTED", reason="no progress", ended_at=77
    )


def test_why_a_task_is_held_is_not_kept_since_its_holds_are() -> None:
    kept, held = Keeper(), task()
    held.reason = "lunch"
    kept.keeper.note(held, 7)

    assert [item.value for item in kept.told()] == [KeptProgress(T1, False, 2, 0.0, 0.0)]


def test_a_task_that_is_dropped_is_forgotten_with_its_progress() -> None:
    kept = Keeper()
    kept.keeper.forget(T1)

    assert kept.told() == [Keeping(KeptTask, T1, None), Keeping(KeptProgress, T1, None)]


# --- how it comes back ---------------------------------------------------------------------------


def test_a_task_that_had_not_ended_comes_back_paused_and_as_far_as_it_was() -> None:
    back = only(ASKED, DRIVEN)

    assert (back.id, back.path, back.phase, back.has_run) == (T1, PATH, TaskPhase.PAUSED, True)
    assert (back.target_index, back.distance_m, back.left_out_m) == (9, 6.5, 0.25)
    assert (back.seen, back.cross_track_error_m) == (DRIVEN.seen, -0.1)
    assert (back.created_at, back.cause, back.ended_at) == (5, 3, None)


def test_a_task_of_which_nothing_was_driven_comes_back_at_its_start() -> None:
    back = only(ASKED)

    assert (back.has_run, back.target_index, back.distance_m, back.seen) == (False, 2, 0.0, None)


def test_a_task_that_ended_comes_back_with_its_end() -> None:
    back = only(ASKED, replace(DRIVEN, ended_as="CANCELED", reason="canceled", ended_at=60))

    assert (back.phase, back.reason, back.ended_at) == (TaskPhase.CANCELED, "canceled", 60)
    assert back.view().distance_m == 6.5


def test_no_time_is_later_than_now() -> None:
    back = only(ASKED, replace(DRIVEN, ended_as="SUCCEEDED", ended_at=60), now=4)

    assert (back.created_at, back.ended_at) == (4, 4)


def test_the_oldest_comes_first_however_it_was_kept() -> None:
    kept = [replace(ASKED, id=TaskId(f"t{number}")) for number in (10, 9, 100, 1)]

    assert [back.id for back in tasks_of(kept, 100)[0]] == ["t1", "t9", "t10", "t100"]


def test_progress_without_its_task_is_nothing() -> None:
    assert tasks_of([DRIVEN], 100) == ([], {})


@pytest.mark.parametrize(
    ("asked", "driven", "why"),
    [
        (replace(ASKED, start_index=20), None, "its path has no such waypoint"),
        (replace(ASKED, start_index=-1), None, "its path has no such waypoint"),
        (ASKED, replace(DRIVEN, target_index=21), "its path has no such waypoint"),
        (ASKED, replace(DRIVEN, target_index=1), "its path has no such waypoint"),
        (ASKED, replace(DRIVEN, ended_as="PARKED"), "this version knows no PARKED as an end"),
        (ASKED, replace(DRIVEN, ended_as="RUNNING"), "this version knows no RUNNING as an end"),
    ],
)
def test_what_makes_no_sense_is_left_out_and_told(
    asked: KeptTask, driven: KeptProgress | None, why: str
) -> None:
    other = replace(ASKED, id=TaskId("t2"))
    tasks, left_out = tasks_of([asked, other, *([driven] if driven else [])], 100)

    assert [back.id for back in tasks] == ["t2"]
    assert left_out == {"t1": why}
