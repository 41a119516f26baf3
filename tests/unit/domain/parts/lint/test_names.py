import pytest

from tests.support.lint_models import brief, guarded, node, told

GUARDED = {"FAST": guarded("battery_level > 0.3")}


@pytest.mark.parametrize("name", ["task", "robot", "error", "vehicle", "hold", "part", "signal"])
def test_a_part_named_by_a_word_of_conditions_is_told(name: str) -> None:
    findings = told(node(default={"a": 1}, FAST={"a": 2}), node(name, default={"a": 1}), n=GUARDED)

    assert brief(findings) == [("RESERVED_WORD", (name,))]
    assert f"part('{name}')" in findings[0].message


def test_a_word_in_a_namespace_is_a_name_as_any_other() -> None:
    assert told(node(default={"a": 1}, FAST={"a": 2}), node("left/task"), n=GUARDED) == []
