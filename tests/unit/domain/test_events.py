"""Events as values: their names, their data, and their words for an operator."""

from dataclasses import fields

import pytest

from domain.events import (
    CHANGE_ENDS,
    EVENTS,
    TASK_ENDS,
    ChangeFailed,
    ChangeRequested,
    ChangeSucceeded,
    DeviationBegan,
    EmergencyStopEngaged,
    ErrorCleared,
    ErrorRaised,
    Event,
    HoldSet,
    NodeNotRestored,
    NodeReported,
    NodeRestoring,
    PartActualChanged,
    RecordedEvent,
    SignalPending,
    StepEnded,
    SystemStateChanged,
    TaskAborted,
    TaskPausing,
    TaskServed,
)
from domain.identifiers import ChangeId, TaskId
from domain.lifecycle import LifecycleState, Transition
from domain.snapshot import ChangeStatus, StepStatus, SystemState, TaskPhase
from domain.state_and_mode import PartName
from tests.support.models import active, inactive
from tests.support.scenarios import ALL_GOOD, NEVER_STALE, STRAIGHT, Step, happened

ARM, BASE, ACTUATION = PartName("arm"), PartName("drive_base"), PartName("actuation")
T1 = TaskId("t1")
IDLE, ERROR = SystemState.IDLE, SystemState.ERROR


# --- words ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            SystemStateChanged(ERROR, IDLE, ("ESTOP", "GPS_LOST"), 6),
            "IDLE -> ERROR: ESTOP, GPS_LOST",
        ),
        (SystemStateChanged(IDLE, ERROR, (), 0), "ERROR -> IDLE"),
        (SystemStateChanged(ERROR, ERROR, ("ESTOP",), 2), "ERROR: ESTOP"),
        (ErrorRaised("ESTOP", "it is pressed", True, None), "ESTOP: it is pressed"),
        (ErrorCleared("ESTOP"), "ESTOP cleared"),
        (
            PartActualChanged(ACTUATION, active("FAST"), inactive(), None, of_system=True),
            "actuation: inactive -> active.FAST",
        ),
        (
            DeviationBegan(ARM, active("FAST"), inactive(), "arm is unreachable"),
            "arm is inactive, target active.FAST: arm is unreachable",
        ),
        (ChangeFailed(ChangeId("c1"), ARM, "arm refused"), "arm: change failed: arm refused"),
        (ChangeSucceeded(ChangeId("c1"), ARM, None), "arm: change succeeded"),
        (
            StepEnded(ChangeId("c1"), ARM, "activate", StepStatus.TIMED_OUT, "no answer"),
            "arm: activate timed out: no answer",
        ),
        (TaskServed(T1, 5, 20.04), "task t1 accepted, 20.0 m"),
        (TaskPausing(T1, "lunch"), "task t1 pausing: lunch"),
        (TaskAborted(T1, "off the path", 0.418), "task t1 aborted at 42%: off the path"),
        (HoldSet("operator", ""), "hold operator set"),
        (EmergencyStopEngaged("a child"), "emergency stop engaged: a child"),
        (
            NodeRestoring(BASE, active("FAST")),
            "drive_base reappeared and is restored to active.FAST",
        ),
        (
            NodeNotRestored(BASE, active("FAST"), "ESTOP is on"),
            "drive_base reappeared and is not restored: ESTOP is on",
        ),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words


def test_detail_is_left_out_of_a_short_list() -> None:
    assert not SignalPending("gps_accuracy", "GPS_LOST").notable
    assert not PartActualChanged(ARM, active(), inactive(), None).notable
    assert PartActualChanged(ACTUATION, active(), inactive(), None, of_system=True).notable


# --- data ----------------------------------------------------------------------------------------


def test_data_is_what_clients_see_labels_texts_and_lists() -> None:
    reported = NodeReported(ARM, LifecycleState.ACTIVE, parameters={"gains": (1.0, 2.0)})

    assert RecordedEvent(3, 7, None, "", reported).data == {
        "node": "arm",
        "state": "active",
        "parameters": {"gains": (1.0, 2.0)},
    }
    assert SystemStateChanged(ERROR, IDLE, ("ESTOP",), 2).data()["errors"] == ["ESTOP"]
    assert PartActualChanged(ARM, active("FAST"), inactive(), None).data() == {
        "part": "arm",
        "actual": "active.FAST",
        "was": "inactive",
        "reason": None,
    }


def test_what_was_not_requested_is_left_out() -> None:
    request = ChangeRequested(ARM, transition=Transition.ACTIVATE)
    assert request.data() == {"part": "arm", "transition": "activate"}


# --- all kinds -----------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", EVENTS.values(), ids=EVENTS)
def test_every_kind_describes_itself(kind: type[Event]) -> None:
    assert kind.__doc__, "the reference of events begins with it"
    assert kind.optional <= {item.name for item in fields(kind)}  # type: ignore[arg-type]
    assert kind.hidden <= {item.name for item in fields(kind)}  # type: ignore[arg-type]
    assert "words" in dir(kind)
    assert kind.words.fget is not Event.words.fget, "every event has words of its own"  # type: ignore[attr-defined]


def test_every_end_of_a_change_and_of_a_task_has_an_event() -> None:
    assert set(CHANGE_ENDS) == set(ChangeStatus) - {ChangeStatus.RUNNING}
    assert set(TASK_ENDS) == {TaskPhase.SUCCEEDED, TaskPhase.CANCELED, TaskPhase.ABORTED}


def test_the_words_fit_all_that_really_happens() -> None:
    def ask(t_s: float, method: str, path: str, **body: object) -> Step:
        return {"t_s": t_s, "request": {"method": method, "path": path, "body": body}}

    simulation = happened(
        ALL_GOOD,
        {"t_s": 1, "change": {"part": "actuation", "mode": "PERFORMANCE"}},
        {"t_s": 2, "task": {"waypoints": STRAIGHT}},
        ask(3, "PUT", "/emergency_stop", engaged=True, reason="a child"),
        ask(5, "PUT", "/emergency_stop", engaged=False),
        ask(6, "PUT", "/holds/operator", reason="lunch"),
        ask(7, "DELETE", "/holds/operator"),
        {"t_s": 8, "change": {"part": "drive_base", "mode": "SLOW"}},
        {"t_s": 8, "node": "drive_base", "fault": "die"},
        {"t_s": 9, "task": {"waypoints": STRAIGHT, "start_index": 8}},
        {"t_s": 10, "task": None},
        {"t_s": 11, "task": {"waypoints": STRAIGHT, "start_index": 9}},
        until_s=40,
        robot=NEVER_STALE,
    )

    words = {item.kind: item.event.words for item in simulation.events}

    assert simulation.refusals == []
    assert {"task.succeeded", "task.canceled", "node.unreachable", "change.failed"} <= set(words)
    assert words["task.succeeded"].startswith("task t3 succeeded at 100%")
    assert all(words.values())
