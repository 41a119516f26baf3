import pytest

from tests.support.lint_models import brief, node, told


def test_a_parameter_that_changes_its_type_is_told() -> None:
    findings = told(node(default={"speed": 0.5, "gain": 1}, FAST={"speed": 1, "gain": 2}))

    assert brief(findings) == [("TYPE_DIFFERS", ("n", "modes", "FAST", "speed"))]
    assert "speed is integer here and double in __DEFAULT__" in findings[0].message


@pytest.mark.parametrize("value", [(1.0, float("nan")), float("nan")])
def test_a_mode_with_a_value_that_is_never_found_equal_is_told_once(value: float) -> None:
    findings = told(node(default={"a": value, "b": 1}, X={"a": value, "b": 2}))

    assert brief(findings) == [("NEVER_INFERRED", ("n", "modes", "__DEFAULT__", "a"))]


def test_a_parameter_that_the_default_does_not_have_is_no_matter_of_taste() -> None:
    assert told(node(default={"a": 1}, X={"a": 2, "b": 3.0})) == []
