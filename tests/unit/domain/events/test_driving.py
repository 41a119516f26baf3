"""What is told of the vehicle, its task and its holds."""

import pytest

from domain.events.driving import (
    TASK_ENDS,
    DriveAvailable,
    DriveUnavailable,
    GoalEnded,
    HoldReleased,
    HoldSet,
    TaskAborted,
    TaskPausing,
    TaskRequested,
    TaskResumed,
    TaskServed,
    VehicleReported,
    VehicleStandstillUnknown,
    VehicleStillMoving,
    VehicleStopped,
)
from domain.events.event import Event
from domain.identifiers import GoalId, TaskId
from domain.snapshot import TaskPhase

T1 = TaskId("t1")


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (VehicleReported(1.0, 2.5, 0.25), "vehicle at x 1.00 m, y 2.50 m, 0.25 m/s"),
        (
            VehicleStillMoving(2.577, 4.5),
            "the vehicle should stand, but moved at 2.58 m/s, 4.5 s after the stop began",
        ),
        (
            VehicleStandstillUnknown(4.5),
            "the vehicle should stand, but there was no pose to show it, "
            "4.5 s after the stop began",
        ),
        (DriveAvailable(), "drive commands reach the vehicle"),
        (
            DriveUnavailable("the drive process has ended"),
            "drive commands do not reach the vehicle: the drive process has ended",
        ),
        (VehicleStopped(55.0), "the vehicle stands, 55.0 s after the stop began"),
        (GoalEnded(GoalId(3), False, "off the path"), "goal 3 aborted: off the path"),
        (
            TaskRequested(5, 20.04, 0, "stanley", 2.8),
            "task requested: 5 waypoints, 20.0 m by stanley at 2.8 m/s",
        ),
        (TaskServed(T1, 5, 20.04), "task t1 accepted, 20.0 m"),
        (TaskPausing(T1, "lunch"), "task t1 pausing: lunch"),
        (TaskResumed(T1, GoalId(2), 4), "task t1 resumed"),
        (TaskAborted(T1, "off the path", 0.418), "task t1 aborted at 42%: off the path"),
        (HoldSet("operator", ""), "hold operator set"),
        (HoldSet("gate", "closed"), "hold gate set: closed"),
        (HoldReleased("gate"), "hold gate released"),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words


def test_every_end_of_a_task_has_an_event() -> None:
    assert set(TASK_ENDS) == {TaskPhase.SUCCEEDED, TaskPhase.CANCELED, TaskPhase.ABORTED}
    assert all(end.kind == f"task.{phase.lower()}" for phase, end in TASK_ENDS.items())
