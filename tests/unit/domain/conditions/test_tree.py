import pytest

from domain.conditions.parser import parse
from domain.conditions.tree import ATTRIBUTES, Operator, TopicKind, comparisons, leaves


@pytest.mark.parametrize(
    "text",
    [
        "battery_level >= 0.3",
        "signal('x y') != 'my mode'",
        "signal('task')",
        "x == 'true'",
        "x == true",
        "not part('left/arm').reachable",
        'part("it\'s").converged',
        "drive_base.parameters.pid.kp < -1.5",
        "part('l/r').errors.SILENT",
        "error.ESTOP and not hold('reaction:LIMP')",
        "a.mode in [SLOW, 'my mode', 3] or (x or y) and z",
        "vehicle.speed_mps < 0.05 or false",
    ],
)
def test_a_tree_is_shown_as_it_can_be_written(text: str) -> None:
    root = parse(text)

    assert parse(root.text) == root
    assert parse(root.text).text == root.text


def test_words_that_need_quotes_keep_them() -> None:
    assert parse("x in ['true', 'in', 'a-b', 'plain']").text == "x in ['true', 'in', 'a-b', plain]"


def test_each_operator_has_an_opposite() -> None:
    assert all(operator.opposite.opposite is operator for operator in Operator)


def test_a_list_is_shown_as_one_threshold() -> None:
    (leaf,) = comparisons(parse("a.mode not in [SLOW, 'my mode']"))

    assert leaf.threshold == "[SLOW, 'my mode']"


def test_leaves_stand_from_left_to_right() -> None:
    assert [leaf.text for leaf in leaves(parse("(a or true) and (b < 1 or c)"))] == (
        ["a", "true", "b < 1", "c"]
    )


def test_what_has_attributes_has_at_least_one() -> None:
    assert set(ATTRIBUTES) <= set(TopicKind)
    assert all(ATTRIBUTES.values())
