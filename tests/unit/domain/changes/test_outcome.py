from domain.changes.outcome import MOST_TOLD, joined, missed_target
from domain.changes.record import Change
from domain.identifiers import ChangeId
from domain.inputs import ModeRequest, NodeReport
from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from tests.support.models import BASE, FAST, active, actuation_model


def test_of_many_reasons_the_first_are_told_and_how_many_there_are_besides() -> None:
    assert joined(["a", "b"]) == "a; b"
    many = joined([f"n{number}" for number in range(MOST_TOLD + 3)])
    assert many.endswith("; n19; and 3 more")


def test_a_part_that_is_elsewhere_although_all_steps_succeeded_is_told() -> None:
    inference = ModeInference(actuation_model())
    change = Change(ChangeId("c1"), BASE, ModeRequest(BASE, FAST), {BASE: active(FAST)}, 0, 1)
    inference.set_targets(change.targets)
    inference.report(NodeReport(BASE, state=LifecycleState.INACTIVE))
    assert missed_target(change, inference) == "drive_base is inactive, not active.FAST"
    inference.report(NodeReport(BASE, state=LifecycleState.ACTIVE, mode=FAST))
    assert missed_target(change, inference) is None
