from domain.findings import Blocker
from domain.parts.claims import Claim, Claims
from domain.parts.mode_inference import ModeInference
from domain.state_and_mode import PartName, StateAndMode
from tests.support.models import ACTUATION, BASE, active, inactive, nested_model

ROBOT = PartName("robot")
BLOCKER = Blocker("REACTION", "slow down", (ACTUATION,))


def against(
    part: PartName, in_force: StateAndMode | None = None, **targets: StateAndMode
) -> list[tuple[str, ...]]:
    """Return the paths of what is against some targets, where MODERATE is claimed."""
    inference = ModeInference(nested_model())
    inference.set_targets({BASE: in_force})
    claims = Claims(inference)
    claimed = {ACTUATION: active("MODERATE"), BASE: active("SLOW")}
    claims.set([Claim(ACTUATION, claimed, BLOCKER)])
    wanted = {PartName(name): target for name, target in targets.items()}
    return [blocker.path for blocker in claims.against(part, wanted)]


def test_another_target_of_a_claimed_part_is_against_it() -> None:
    assert against(ACTUATION, actuation=active("PERFORMANCE")) == [(ACTUATION,)]
    assert against(BASE, drive_base=active("FAST")) == [(BASE, ACTUATION)]
    assert against(ROBOT, robot=active(), drive_base=active("FAST")) == [(ROBOT, ACTUATION)]


def test_the_claimed_target_and_others_are_not() -> None:
    assert against(ACTUATION, actuation=active("MODERATE"), drive_base=active("SLOW")) == []
    assert against(ROBOT, robot=active()) == []


def test_a_node_that_rests_on_purpose_may_be_brought_back_to_rest() -> None:
    assert against(BASE, inactive(), drive_base=inactive()) == []
    assert against(BASE, active("SLOW"), drive_base=inactive()) == [(BASE, ACTUATION)]
