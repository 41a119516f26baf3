from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parts.deviations import Deviations
from domain.parts.mode_inference import ModeInference
from tests.support.models import BASE, actuation_model, inactive


def test_a_deviation_counts_from_when_it_was_first_seen_until_it_is_gone() -> None:
    inference = ModeInference(actuation_model())
    deviations = Deviations(inference)
    assert deviations.look(BASE, 1) is None

    inference.set_targets({BASE: inactive()})
    assert deviations.look(BASE, 2) is True
    assert deviations.look(BASE, 3) is None
    assert deviations.since(BASE) == 2

    inference.report(NodeReport(BASE, state=LifecycleState.INACTIVE))
    assert deviations.look(BASE, 4) is False
    assert deviations.since(BASE) is None
