"""Which side of a comparison is compared, and what becomes of an operand that stands alone."""

import pytest

from domain.conditions.lexer import ConditionSyntaxError
from domain.conditions.operands import ListLiteral, Literal, Name, as_condition, compared
from domain.conditions.tree import Comparison, Constant, Operator, Subject, Topic, TopicKind

STATE = Subject(Topic(TopicKind.PART, "drive_base"), "state", column=11)


def test_a_name_with_dots_is_compared_on_whichever_side_it_stands() -> None:
    right = compared(Name("active", 1), Operator.EQUAL, STATE, 8)
    left = compared(STATE, Operator.EQUAL, Name("active", 1), 8)

    assert right == left == Comparison(STATE, Operator.EQUAL, ("active",))


def test_of_two_plain_words_the_first_is_the_signal() -> None:
    leaf = compared(Name("strength", 1), Operator.NOT_EQUAL, Name("LOW", 13), 10)

    assert leaf.subject.topic == Topic(TopicKind.SIGNAL, "strength")
    assert (leaf.values, leaf.columns) == (("LOW",), (13,))


def test_a_number_on_the_left_turns_the_operator() -> None:
    leaf = compared(Literal(0.3, 1), Operator.LESS, Name("battery_level", 7), 5)

    assert leaf.text == "battery_level > 0.3"


def test_two_constants_are_no_comparison() -> None:
    with pytest.raises(ConditionSyntaxError, match="one side must be a name") as caught:
        compared(Literal(1, 1), Operator.LESS, Literal(2, 5), 3)

    assert caught.value.column == 3


def test_an_operand_alone_must_be_true_or_what_negates_it_false() -> None:
    assert as_condition(Name("estop", 1), negate=False).text == "estop"
    assert as_condition(Name("estop", 1), negate=True).text == "not estop"
    assert as_condition(Literal(value=True, column=1), negate=True) == Constant(value=False)
    with pytest.raises(ConditionSyntaxError, match="a value alone is no condition"):
        as_condition(ListLiteral((), 1), negate=False)
