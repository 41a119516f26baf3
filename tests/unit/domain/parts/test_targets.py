from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from domain.parts.targets import Targets
from domain.snapshot import Because, EffectiveTarget
from domain.state_and_mode import ModeName
from tests.support.models import ACTUATION, ARM, BASE, active, actuation_model


def test_nothing_is_pursued_of_a_part_that_nothing_was_asked_of() -> None:
    targets = Targets(ModeInference(actuation_model()))

    assert targets.asked(BASE) is None
    assert targets.effective(BASE) is None


def test_what_somebody_asks_is_pursued_because_it_was_requested() -> None:
    inference = ModeInference(actuation_model())
    targets = Targets(inference)

    changed = targets.ask({ACTUATION: active("PERFORMANCE"), BASE: active("FAST")})

    assert targets.asked(BASE) == active("FAST")
    pursued = EffectiveTarget(LifecycleState.ACTIVE, ModeName("FAST"), Because.REQUESTED)
    assert targets.effective(BASE) == pursued
    assert inference.target(BASE) == active("FAST")
    assert targets.asked(ARM) is None
    assert changed == {ACTUATION, BASE}, "none of them is where it should be from now on"
