from domain.conditions.condition import Condition


def test_conditions_with_the_same_text_are_the_same() -> None:
    assert Condition("battery_level >= 0.3") == Condition("battery_level >= 0.3")
