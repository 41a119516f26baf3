"""What is kept over a restart: one value per kind and name."""

from domain.identifiers import TaskId
from domain.kept import Keeping, KeptEmergencyStop, KeptHold, KeptProgress
from domain.outbox import Outbox

HOLD = KeptHold("operator", "lunch", "http:10.0.0.7", 5)


def test_a_value_that_changes_twice_in_a_step_is_told_once_as_it_is_at_the_end() -> None:
    outbox = Outbox()
    outbox.keep(HOLD)
    outbox.keep(KeptHold("operator", "dinner", "http:10.0.0.7", 5))
    outbox.keep(KeptEmergencyStop(True, "http:10.0.0.7", "smoke", 6))
    assert [item.value for item in outbox.take().kept] == [
        KeptHold("operator", "dinner", "http:10.0.0.7", 5),
        KeptEmergencyStop(True, "http:10.0.0.7", "smoke", 6),
    ]


def test_a_hold_that_is_set_and_released_in_a_step_is_forgotten() -> None:
    outbox = Outbox()
    outbox.keep(HOLD)
    outbox.forget(KeptHold, "operator")
    assert outbox.take().kept == (Keeping(KeptHold, "operator", None),)


def test_what_was_told_is_not_told_again() -> None:
    outbox = Outbox()
    outbox.keep(HOLD)
    outbox.take()
    assert outbox.take().kept == ()


def test_the_progress_of_a_task_goes_by_the_id_of_the_task() -> None:
    progress = KeptProgress(TaskId("t3"), True, 4, 12.5, 0.0)
    assert progress.name == "t3"
