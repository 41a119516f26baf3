"""The parsed form of a condition: comparisons, joined by `and` and `or`.

There is no `not`: the parser turns round what it negates (De Morgan's laws hold for three values,
too). So every leaf says what it needs, and an explanation can show it as it is.
"""

import keyword
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType
from typing import NamedTuple, TypeAlias

Value: TypeAlias = bool | int | float | str
"""A constant of a condition; a word, such as a mode, is a string."""

RESERVED_WORDS = frozenset(
    {
        "error", "robot", "task", "vehicle", "hold", "part", "signal",
        "and", "or", "not", "in", "true", "false",
    }
)  # fmt: skip
"""Words that win over parts and signals of the same name; those are named by `part('task')`."""


class TopicKind(StrEnum):
    """Kinds of what a condition can name."""

    SIGNAL = "signal"
    PART = "part"
    ERROR = "error"
    ROBOT = "robot"
    TASK = "task"
    VEHICLE = "vehicle"
    HOLD = "hold"

    # That of Enum is written in Python, and tables are keyed by kinds.
    __hash__ = str.__hash__


class Topic(NamedTuple):
    """What changes as one: a signal, a part, an error, a hold, the robot, its task or vehicle."""

    kind: TopicKind
    name: str = ""
    """Of the signal, part, error or hold; empty for the others."""
    part: str = ""
    """Whose error it is; empty: it is the robot's, or no error."""


ATTRIBUTES: Mapping[TopicKind, tuple[str, ...]] = MappingProxyType(
    {
        TopicKind.PART: ("state", "mode", "reachable", "converged", "parameters", "errors"),
        TopicKind.ROBOT: ("state",),
        TopicKind.TASK: ("status", "progress"),
        TopicKind.VEHICLE: ("speed_mps", "x_m", "y_m", "yaw_rad", "steering_angle_rad"),
    }
)
"""What follows the dot, by kind; the others have none."""


@dataclass(frozen=True, slots=True)
class Subject:
    """What a comparison looks at, such as `drive_base.state`."""

    topic: Topic
    attribute: str = ""
    """One of `ATTRIBUTES`; empty for a signal, an error and a hold."""
    key: str = ""
    """Name of the parameter; empty for other attributes."""
    column: int = field(default=1, compare=False)
    """Where it begins in the text, from 1, in characters."""

    @property
    def text(self) -> str:
        """Return it as it is written in a condition."""
        kind, name, part = self.topic
        if kind is TopicKind.SIGNAL:
            return _named("signal", name)
        if kind is TopicKind.HOLD:
            return f"hold.{name}" if _is_plain(name) else f"hold({_quoted(name)})"
        if kind is TopicKind.ERROR:
            return f"{_named('part', part)}.errors.{name}" if part else f"error.{name}"
        head = _named("part", name) if kind is TopicKind.PART else str(kind)
        return ".".join(filter(None, (head, self.attribute, self.key)))


class Operator(StrEnum):
    """How a value is compared."""

    EQUAL = "=="
    NOT_EQUAL = "!="
    LESS = "<"
    LESS_OR_EQUAL = "<="
    GREATER = ">"
    GREATER_OR_EQUAL = ">="
    IN = "in"
    NOT_IN = "not in"

    # That of Enum is written in Python, and tables are keyed by operators.
    __hash__ = str.__hash__

    @property
    def opposite(self) -> "Operator":
        """Return the operator that is true where this one is false."""
        return _OPPOSITES[self]


_O = Operator
_PAIRS = (
    (_O.EQUAL, _O.NOT_EQUAL),
    (_O.LESS, _O.GREATER_OR_EQUAL),
    (_O.GREATER, _O.LESS_OR_EQUAL),
    (_O.IN, _O.NOT_IN),
)
_OPPOSITES = {a: b for pair in _PAIRS for a, b in (pair, pair[::-1])}
ORDERS = frozenset({_O.LESS, _O.LESS_OR_EQUAL, _O.GREATER, _O.GREATER_OR_EQUAL})
"""Operators that compare by size, which only numbers have."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """A leaf: one fact compared with constants.

    A fact that stands alone, such as `drive_base.reachable`, is compared with true.
    """

    subject: Subject
    operator: Operator
    values: tuple[Value, ...]
    """One, or the list after `in`."""
    columns: tuple[int, ...] = field(default=(), compare=False)
    """Where each value begins; where there are none, that of the operator."""
    stands_alone: bool = field(default=False, compare=False)
    """It is written without an operator, so it must be true or false."""
    text: str = field(init=False, compare=False, default="")
    """The comparison as it can be written in a condition."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "text", _comparison_text(self))

    @property
    def threshold(self) -> Value:
        """Return what the fact is compared with, as a plain value; `!= true` is `false`."""
        if self.operator in (Operator.IN, Operator.NOT_IN):
            return f"[{', '.join(value_text(value) for value in self.values)}]"
        value = self.values[0]
        if isinstance(value, bool) and self.operator is Operator.NOT_EQUAL:
            return not value
        return value


@dataclass(frozen=True, slots=True)
class Constant:
    """A leaf that is always true or always false."""

    value: bool

    @property
    def text(self) -> str:
        """Return `true` or `false`."""
        return "true" if self.value else "false"


@dataclass(frozen=True, slots=True)
class AllOf:
    """Operands joined by `and`; at least two."""

    operands: "tuple[Node, ...]"

    @property
    def text(self) -> str:
        """Return it as it can be written in a condition."""
        return " and ".join(_grouped(o) if isinstance(o, AnyOf) else o.text for o in self.operands)


@dataclass(frozen=True, slots=True)
class AnyOf:
    """Operands joined by `or`; at least two."""

    operands: "tuple[Node, ...]"

    @property
    def text(self) -> str:
        """Return it as it can be written in a condition."""
        return " or ".join(operand.text for operand in self.operands)


Leaf: TypeAlias = Comparison | Constant
Node: TypeAlias = AllOf | AnyOf | Leaf


def leaves(node: Node) -> Iterator[Leaf]:
    """Yield the leaves from left to right."""
    if isinstance(node, AllOf | AnyOf):
        for operand in node.operands:
            yield from leaves(operand)
    else:
        yield node


def comparisons(node: Node) -> Iterator[Comparison]:
    """Yield the leaves that compare something, from left to right."""
    return (leaf for leaf in leaves(node) if isinstance(leaf, Comparison))


def negated(node: Node) -> Node:
    """Return the condition that is true where this one is false."""
    match node:
        case AllOf(operands):
            return AnyOf(tuple(map(negated, operands)))
        case AnyOf(operands):
            return AllOf(tuple(map(negated, operands)))
        case Constant(value):
            return Constant(not value)
        case Comparison():
            return Comparison(node.subject, node.operator.opposite, node.values, node.columns)


def is_number(value: object) -> bool:
    """Tell whether a value is a number; true and false are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def value_text(value: Value) -> str:
    """Return a constant as it is written in a condition."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value if _is_plain(value) and value not in RESERVED_WORDS else _quoted(value)
    return repr(value)


def is_keyword(word: str) -> bool:
    """Tell whether a word belongs to Python, so that it needs quotes."""
    return keyword.iskeyword(word)


_PLAIN = re.compile(r"[^\W\d]\w*")


def _is_plain(name: str) -> bool:
    return _PLAIN.fullmatch(name) is not None and not is_keyword(name)


def _quoted(name: str) -> str:
    quote = '"' if "'" in name else "'"
    return f"{quote}{name}{quote}"


def _named(call: str, name: str) -> str:
    if _is_plain(name) and name not in RESERVED_WORDS:
        return name
    return f"{call}({_quoted(name)})"


def _grouped(node: Node) -> str:
    return f"({node.text})"


def _comparison_text(leaf: Comparison) -> str:
    subject, operator = leaf.subject.text, leaf.operator
    if operator in (Operator.IN, Operator.NOT_IN):
        return f"{subject} {operator} {leaf.threshold}"
    if leaf.stands_alone:
        return subject if operator is Operator.EQUAL else f"not {subject}"
    return f"{subject} {operator} {value_text(leaf.values[0])}"
