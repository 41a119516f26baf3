import pickle

import pytest

from domain.conditions.condition import Condition
from domain.conditions.lexer import ConditionSyntaxError


def test_conditions_with_the_same_text_are_the_same() -> None:
    assert Condition("battery_level >= 0.3") == Condition.parse("battery_level >= 0.3")
    assert len({Condition("estop"), Condition("estop"), Condition("not estop")}) == 2


def test_a_text_that_cannot_be_read_makes_no_condition() -> None:
    with pytest.raises(ConditionSyntaxError, match="expected a name or a value, found the end"):
        Condition("battery_level >=")


def test_a_checkpoint_keeps_a_condition_with_its_tree() -> None:
    condition = Condition("drive_base.mode in [SLOW, 'my mode'] and not error.ESTOP")

    kept = pickle.loads(pickle.dumps(condition))

    assert kept == condition
    assert kept.root == condition.root
