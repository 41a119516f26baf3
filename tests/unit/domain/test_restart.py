"""A restart is told once, with what was kept, before anything is brought back."""

from domain.actor import NOBODY
from domain.identifiers import ChangeId, TaskId
from domain.inputs import NodeReport, Restored
from domain.kept import (
    Kept,
    KeptChange,
    KeptEmergencyStop,
    KeptError,
    KeptHold,
    KeptProgress,
    KeptTarget,
    KeptTask,
)
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox, Outputs
from domain.paths.path import Path
from domain.restart import Restart
from domain.supervision import Supervision, SupervisionSettings
from tests.support.models import BASE, active, actuation_model
from tests.support.paths import straight

HOLD = KeptHold("operator", "lunch", "http:10.0.0.7", 5)


def told(restored: Restored) -> Outputs:
    outbox = Outbox()
    Restart(outbox).take_restored(restored, 7)
    return outbox.take()


def words(*kept: Kept, stop_because: str = "") -> str:
    (event,) = told(Restored(kept, boot=2, stop_because=stop_because)).events
    return event.event.words


def task(number: int, ended_as: str | None = None) -> tuple[Kept, Kept]:
    identity = TaskId(f"t{number}")
    path: Path = straight(10.0)
    return (
        KeptTask(identity, path, "pure_pursuit", 1.0, 0, 0, 1),
        KeptProgress(identity, True, 4, 2.0, 0.0, ended_as=ended_as),
    )


def test_an_operator_is_told_in_one_sentence_what_is_as_it_was() -> None:
    kept = [
        KeptTarget(BASE, active("FAST"), 1),
        KeptChange(ChangeId("c4"), BASE, 3, 9, mode="FAST"),
        *task(1, "succeeded"),
        *task(2),
        HOLD,
        KeptHold("gate", "closed", "http:10.0.0.8", 6),
        KeptError("estop", "ESTOP", 4, "pressed"),
        KeptEmergencyStop(True, "http:10.0.0.7", "smoke", 6),
    ]

    assert words(*kept) == (
        "restored after a restart: 1 requested target, 1 change failed, 1 task held, 2 holds, "
        "1 error to acknowledge, emergency stop engaged"
    )


def test_a_restart_after_which_nothing_was_kept_is_told_as_well() -> None:
    assert words() == "restored after a restart: nothing was kept"


def test_an_emergency_stop_that_was_released_is_nothing_to_tell() -> None:
    released = KeptEmergencyStop(False, "http:10.0.0.7", "fine", 6)

    assert words(released, HOLD) == "restored after a restart: 1 hold"


def test_why_the_emergency_stop_is_engaged_whatever_was_kept_is_told() -> None:
    because = "the stored state cannot be read"

    assert words(stop_because=because) == (
        f"restored after a restart: emergency stop engaged: {because}"
    )


def test_the_first_run_of_a_robot_is_nothing_to_tell() -> None:
    assert told(Restored()) == Outputs()


def test_events_go_on_with_the_ids_that_no_earlier_run_told() -> None:
    (event,) = told(Restored(boot=2, next_event=10_001)).events

    assert (event.id, event.at, event.cause, event.actor) == (10_001, 7, None, NOBODY)


def test_an_event_of_a_later_input_has_the_next_id() -> None:
    core = Supervision(actuation_model(), SupervisionSettings(), 0)
    restored = core.handle(Restored(boot=2, next_event=501), 0)
    later = core.handle(NodeReport(BASE, state=LifecycleState.INACTIVE), 1)

    (event,) = restored.events
    ids = [event.id for event in later.events]
    assert event.id == 501
    assert ids == [502, *ids[1:]]
