"""What tells those apart that put targets in force."""

from domain.parts.mode_inference import ModeInference
from domain.parts.system_model import Rule
from domain.reactions.displacer import Displacer, key_of
from domain.reactions.fallback import Fallback
from domain.reactions.rule_watch import RuleWatch
from domain.snapshot import Because
from tests.support.models import ACTUATION, ARM, MODERATE, active, actuation_model, inactive

SLOW = Rule("slow", active("PERFORMANCE"), (ARM, inactive()), active(MODERATE))
RULE: Displacer = RuleWatch(ACTUATION, SLOW, 0, ModeInference(actuation_model()))
FALLBACK: Displacer = Fallback(ACTUATION, MODERATE)


def test_a_rule_is_known_by_its_name_and_a_fallback_by_its_mode() -> None:
    target = active(MODERATE)
    assert key_of(RULE) == (Because.RULE, ACTUATION, "slow", target)
    assert key_of(FALLBACK) == (Because.INVARIANT, ACTUATION, None, target)


def test_each_says_in_whose_name_it_acts_and_why_it_ends() -> None:
    assert (RULE.actor.label, RULE.relief) == (
        "rule:slow",
        "no longer true that manipulator is inactive",
    )
    assert (FALLBACK.actor.label, FALLBACK.relief) == (
        "invariant:actuation",
        "its guards hold again",
    )
