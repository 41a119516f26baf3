"""The operands of comparisons, and how they become leaves of a condition."""

from dataclasses import dataclass
from typing import TypeAlias

from domain.conditions.lexer import ConditionSyntaxError
from domain.conditions.tree import (
    AllOf,
    AnyOf,
    Comparison,
    Constant,
    Node,
    Operator,
    Subject,
    Topic,
    TopicKind,
    Value,
)


@dataclass(frozen=True, slots=True)
class Literal:
    """A number, a quoted text, true or false."""

    value: Value
    column: int


@dataclass(frozen=True, slots=True)
class ListLiteral:
    """A list in brackets."""

    values: tuple[Literal, ...]
    column: int


@dataclass(frozen=True, slots=True)
class Name:
    """A plain word: a signal, or a word to compare with."""

    text: str
    column: int


Operand: TypeAlias = Subject | Name | Literal | ListLiteral
Term: TypeAlias = Node | Operand


_FLIPPED = {
    Operator.LESS: Operator.GREATER,
    Operator.LESS_OR_EQUAL: Operator.GREATER_OR_EQUAL,
    Operator.GREATER: Operator.LESS,
    Operator.GREATER_OR_EQUAL: Operator.LESS_OR_EQUAL,
}


def joined(operands: list[Node], how: type[AllOf] | type[AnyOf]) -> Node:
    """Join operands; those that are joined in the same way become one level."""
    flat: list[Node] = []
    for operand in operands:
        flat.extend(operand.operands if isinstance(operand, how) else (operand,))
    return how(tuple(flat))


def as_condition(term: Term, *, negate: bool) -> Node:
    """Return a term that stands where a condition is needed; an operand is compared with true."""
    match term:
        case Name() | Subject():
            operator = Operator.NOT_EQUAL if negate else Operator.EQUAL
            subject = _subject(term)
            return Comparison(subject, operator, (True,), (term.column,), stands_alone=True)
        case Literal(bool(value), _):
            return Constant(value is not negate)
        case Literal() | ListLiteral():
            raise ConditionSyntaxError("a value alone is no condition", term.column)
        case _:
            return term


def turned_round(leaf: Comparison) -> Comparison:
    """Return the comparison that is true where this one is false."""
    return Comparison(leaf.subject, leaf.operator.opposite, leaf.values, leaf.columns)


def compared(left: Operand, operator: Operator, right: Operand, column: int) -> Comparison:
    """Return the comparison of two operands; the name may stand on either side.

    Args:
        left: What stands before the operator.
        operator: Any.
        right: What stands after it.
        column: Of the operator.
    """
    if operator in (Operator.IN, Operator.NOT_IN):
        return _listed(left, operator, right)
    if _rank(right) < _rank(left):
        left, right, operator = right, left, _FLIPPED.get(operator, operator)
    if isinstance(right, ListLiteral):
        raise ConditionSyntaxError(f"a list follows in, not {operator}", right.column)
    if not isinstance(left, Subject | Name):
        raise ConditionSyntaxError("two values are compared: one side must be a name", column)
    if isinstance(right, Subject):
        raise not_a_value(right)
    value = right.text if isinstance(right, Name) else right.value
    return Comparison(_subject(left), operator, (value,), (right.column,))


def _rank(operand: Operand) -> int:
    """Return how surely an operand is what is compared, and not what it is compared with."""
    return (Subject, Name, Literal, ListLiteral).index(type(operand))


def _listed(left: Operand, operator: Operator, right: Operand) -> Comparison:
    if not isinstance(right, ListLiteral):
        message = f"write a list after {operator}, as in [SLOW, FAST]"
        raise ConditionSyntaxError(message, right.column)
    if not isinstance(left, Subject | Name):
        raise ConditionSyntaxError("a name is missing before the list", left.column)
    columns = tuple(item.column for item in right.values) or (right.column,)
    values = tuple(item.value for item in right.values)
    return Comparison(_subject(left), operator, values, columns)


def _subject(operand: Subject | Name) -> Subject:
    """Return what is compared; a plain word is a signal."""
    if isinstance(operand, Subject):
        return operand
    return Subject(Topic(TopicKind.SIGNAL, operand.text), column=operand.column)


def not_a_value(subject: Subject) -> ConditionSyntaxError:
    """Return the error of a fact that stands where a value is needed."""
    message = f"{subject.text} is a fact; compare with a number or a word"
    return ConditionSyntaxError(message, subject.column)
