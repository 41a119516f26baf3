"""Evaluates conditions with three values (Kleene's logic): true, false and unknown."""

import operator as python
from collections.abc import Callable, Mapping
from enum import IntEnum
from typing import Any, assert_never

from domain.conditions.condition import Condition
from domain.conditions.facts import Facts, Observation
from domain.conditions.tree import (
    ORDERS,
    AllOf,
    AnyOf,
    Comparison,
    Constant,
    Node,
    Operator,
    Value,
)


class Truth(IntEnum):
    """Value of a condition; `and` is the least of its operands, `or` the greatest."""

    FALSE = 0
    UNKNOWN = 1
    TRUE = 2


def evaluate(condition: Condition, facts: Facts) -> Truth:
    """Return whether a condition is true, as far as the facts are known."""
    return truth_of(condition.root, lambda leaf: compare(leaf, facts.observe(leaf.subject)))


def truth_of(node: Node, truth_of_leaf: Callable[[Comparison], Truth]) -> Truth:
    """Return the value of a condition or of a part of one.

    Args:
        node: The condition.
        truth_of_leaf: Returns the value of a comparison.
    """
    match node:
        case Comparison():
            return truth_of_leaf(node)
        case AllOf(operands):
            least = Truth.TRUE
            for operand in operands:
                least = min(least, truth_of(operand, truth_of_leaf))
                if least is Truth.FALSE:
                    break
            return least
        case AnyOf(operands):
            greatest = Truth.FALSE
            for operand in operands:
                greatest = max(greatest, truth_of(operand, truth_of_leaf))
                if greatest is Truth.TRUE:
                    break
            return greatest
        case Constant(value):
            return _TRUTHS[value]
        case _:
            assert_never(node)


def compare(leaf: Comparison, observed: Observation) -> Truth:
    """Return the value of a comparison.

    Unknown: the value is in doubt or not a number (NaN), or it cannot be compared with the
    constant, such as a word with a number. No value, such as no mode, equals nothing.
    """
    value, operator = observed.value, leaf.operator
    if observed.doubt:
        return Truth.UNKNOWN
    if value is None:
        return _OF_NOTHING.get(operator, Truth.UNKNOWN)
    if operator is Operator.IN or operator is Operator.NOT_IN:
        return _among(value, leaf)
    constant = leaf.values[0]
    if not _same_kind(value, constant) or (operator in ORDERS and type(value) in _UNORDERED):
        return Truth.UNKNOWN
    return Truth.TRUE if _COMPARE[operator](value, constant) else Truth.FALSE


def _among(value: Value, leaf: Comparison) -> Truth:
    comparable = [one for one in leaf.values if _same_kind(value, one)]
    if leaf.values and not comparable:
        return Truth.UNKNOWN
    return _TRUTHS[(value in comparable) is (leaf.operator is Operator.IN)]


def _same_kind(value: Value, other: Value) -> bool:
    """Tell whether two values can be compared; NaN cannot be compared with anything."""
    one, another = type(value), type(other)
    if one is float and value != value:
        return False
    return one is another or (one in _NUMBERS and another in _NUMBERS)


_NUMBERS = (float, int)
_UNORDERED = (str, bool)
_TRUTHS = (Truth.FALSE, Truth.TRUE)
_OF_NOTHING: Mapping[Operator, Truth] = {
    Operator.EQUAL: Truth.FALSE,
    Operator.IN: Truth.FALSE,
    Operator.NOT_EQUAL: Truth.TRUE,
    Operator.NOT_IN: Truth.TRUE,
}
_COMPARE: Mapping[Operator, Callable[[Any, Any], bool]] = {
    Operator.EQUAL: python.eq,
    Operator.NOT_EQUAL: python.ne,
    Operator.LESS: python.lt,
    Operator.LESS_OR_EQUAL: python.le,
    Operator.GREATER: python.gt,
    Operator.GREATER_OR_EQUAL: python.ge,
}
