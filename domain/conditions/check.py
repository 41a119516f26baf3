"""Checks what a condition names, and compares with what, before it is evaluated."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from domain.conditions.condition import Condition
from domain.conditions.tree import (
    ORDERS,
    Comparison,
    Operator,
    Subject,
    TopicKind,
    Value,
    comparisons,
    is_number,
    value_text,
)
from domain.conditions.vocabulary import Kind, PartTerms, Terms, Vocabulary
from domain.errors import near_match
from domain.lifecycle import LifecycleState

_BOOLEAN = Terms(Kind.BOOLEAN)
_STATE = Terms(Kind.WORD, words=tuple(map(str, LifecycleState)), code="UNKNOWN_STATE")
_FIXED: Mapping[tuple[TopicKind, str], Terms] = MappingProxyType(
    {
        (TopicKind.ROBOT, "state"): Terms(Kind.WORD, words=("IDLE", "RUNNING", "ERROR")),
        (TopicKind.TASK, "status"): Terms(
            Kind.WORD, words=("NO_TASK", "PAUSED_TASK", "RUNNING_TASK")
        ),
        (TopicKind.TASK, "progress"): Terms(Kind.NUMBER, 0.0, 1.0),
        (TopicKind.HOLD, ""): _BOOLEAN,
        (TopicKind.PART, "state"): _STATE,
        (TopicKind.PART, "reachable"): _BOOLEAN,
        (TopicKind.PART, "converged"): _BOOLEAN,
    }
)
_NUMBER = Terms(Kind.NUMBER)
_WORDS = {Kind.NUMBER: "a number", Kind.BOOLEAN: "true or false", Kind.WORD: "a word"}


@dataclass(frozen=True, slots=True)
class Fault:
    """What is wrong in a condition."""

    severity: Literal["error", "warning"]
    code: str
    """Stable, UPPER_SNAKE."""
    message: str
    column: int
    """Where in the text, from 1, in characters."""


def check(condition: Condition, vocabulary: Vocabulary) -> list[Fault]:
    """Return what is wrong in a condition, from left to right; empty: nothing is.

    Errors: unknown names, comparisons of different types, words that the fact can never be. A
    warning: an unknown signal where not all are known, a parameter that no mode sets, and a
    comparison that is always or never true.
    """
    faults = [fault for leaf in comparisons(condition.root) for fault in _check(leaf, vocabulary)]
    return sorted(faults, key=lambda fault: fault.column)


def _check(leaf: Comparison, vocabulary: Vocabulary) -> Iterator[Fault]:
    terms = terms_of(leaf.subject, vocabulary)
    if isinstance(terms, Fault):
        yield terms
    elif leaf.stands_alone and terms.kind is not Kind.BOOLEAN:
        subject = leaf.subject
        message = f"{subject.text} is {_WORDS[terms.kind]}: compare it with one"
        yield Fault("error", "WRONG_TYPE", message, subject.column)
    elif not leaf.values:
        yield Fault("error", "EMPTY_LIST", "the list is empty", leaf.columns[0])
    elif leaf.operator in ORDERS and terms.kind is not Kind.NUMBER:
        message = f"{leaf.subject.text} is {_WORDS[terms.kind]}, which has no order"
        yield Fault("error", "WRONG_TYPE", message, leaf.columns[0])
    else:
        yield from _check_values(leaf, terms)


# --- names ---------------------------------------------------------------------------------------


def terms_of(subject: Subject, vocabulary: Vocabulary) -> Terms | Fault:
    """Return the values that a fact can have, or why there is no such fact."""
    kind, name, part = subject.topic
    if kind is TopicKind.SIGNAL:
        return vocabulary.signals.get(name) or _unknown_signal(subject, vocabulary)
    if kind is TopicKind.ERROR and not part:
        if name in vocabulary.errors:
            return _BOOLEAN
        return _unknown(subject, "error", name, vocabulary.errors, vocabulary.is_complete)
    if kind is TopicKind.PART or part:
        terms = vocabulary.parts.get(part or name)
        if terms is None:
            return _unknown(subject, "part", part or name, tuple(vocabulary.parts))
        return _terms_of_part(subject, terms, vocabulary.is_complete)
    if kind is TopicKind.VEHICLE:
        return _NUMBER
    return _FIXED[kind, subject.attribute]


def _terms_of_part(subject: Subject, part: PartTerms, is_complete: bool) -> Terms | Fault:
    kind, name, owner = subject.topic
    if kind is TopicKind.ERROR:
        if name in part.errors:
            return _BOOLEAN
        # That of a signal of the robot file may be an error of a part.
        return _unknown(subject, f"error of {owner}", name, part.errors, is_complete)
    if subject.attribute == "mode":
        if part.modes:
            return Terms(Kind.WORD, words=part.modes, code="UNKNOWN_MODE")
        return Fault("error", "UNKNOWN_MODE", f"{name} has no modes", subject.column)
    if subject.attribute == "parameters":
        return _terms_of_parameter(subject, part)
    return _FIXED[kind, subject.attribute]


def _terms_of_parameter(subject: Subject, part: PartTerms) -> Terms | Fault:
    name, key = subject.topic.name, subject.key
    if not part.is_node:
        message = f"{name} is a system: only nodes have parameters"
        return Fault("error", "UNKNOWN_PARAMETER", message, subject.column)
    if key not in part.parameters:
        near = near_match(key, tuple(part.parameters))
        hint = f"; did you mean {near}?" if near else ""
        message = f"no mode of {name} sets {key}: unknown until {name} reports it{hint}"
        return Fault("warning", "UNKNOWN_PARAMETER", message, subject.column)
    terms = part.parameters[key]
    if terms is None:
        message = f"{key} of {name} is an array, which cannot be compared"
        return Fault("error", "WRONG_TYPE", message, subject.column)
    return terms


def _unknown_signal(subject: Subject, vocabulary: Vocabulary) -> Fault:
    name = subject.topic.name
    if name in vocabulary.parts:
        message = f"{name} is a part: name one of its facts, such as {name}.state"
        return Fault("error", "WRONG_TYPE", message, subject.column)
    return _unknown(subject, "signal", name, tuple(vocabulary.signals), vocabulary.is_complete)


def _unknown(
    subject: Subject, what: str, name: str, known: Sequence[str], is_complete: bool = True
) -> Fault:
    near = near_match(name, known)
    hint = f"; did you mean {near}?" if near else ""
    code = f"UNKNOWN_{what.split()[0].upper()}"
    message = f"unknown {what} {name!r}{hint}"
    return Fault("error" if is_complete else "warning", code, message, subject.column)


# --- values --------------------------------------------------------------------------------------


def _check_values(leaf: Comparison, terms: Terms) -> Iterator[Fault]:
    for value, column in zip(leaf.values, leaf.columns, strict=True):
        if _kind_of(value) is not terms.kind:
            yield _wrong_type(leaf, terms, value, column)
        elif isinstance(value, str) and terms.words is not None and value not in terms.words:
            yield _unknown_word(leaf, terms, value, column)
        elif value == LifecycleState.UNKNOWN and terms is _STATE:
            message = "never true or false: while the state is unknown, so is the comparison"
            yield Fault("warning", "NEVER_KNOWN", message, column)
        elif not isinstance(value, bool | str):
            yield from _check_range(leaf, terms, value, column)


def _kind_of(value: Value) -> Kind:
    if is_number(value):
        return Kind.NUMBER
    return Kind.BOOLEAN if isinstance(value, bool) else Kind.WORD


def _wrong_type(leaf: Comparison, terms: Terms, value: Value, column: int) -> Fault:
    text = value_text(value)
    message = f"{leaf.subject.text} is {_WORDS[terms.kind]}, and {text} is not"
    if terms.words is not None and text in terms.words:
        message += f"; write '{text}' in quotes"
    return Fault("error", "WRONG_TYPE", message, column)


def _unknown_word(leaf: Comparison, terms: Terms, value: str, column: int) -> Fault:
    words = terms.words or ()
    near = near_match(value, words)
    hint = f"did you mean {near}?" if near else f"it is one of {', '.join(words[:20])}"
    return Fault("error", terms.code, f"{leaf.subject.text} is never {value!r}; {hint}", column)


def _check_range(leaf: Comparison, terms: Terms, value: float, column: int) -> Iterator[Fault]:
    """Warn of a comparison that the range of a number decides."""
    low = float("-inf") if terms.minimum is None else terms.minimum
    high = float("inf") if terms.maximum is None else terms.maximum
    match leaf.operator:
        case Operator.LESS:
            always, never = high < value, low >= value
        case Operator.LESS_OR_EQUAL:
            always, never = high <= value, low > value
        case Operator.GREATER:
            always, never = low > value, high <= value
        case Operator.GREATER_OR_EQUAL:
            always, never = low >= value, high < value
        case Operator.EQUAL | Operator.IN:
            always, never = False, not low <= value <= high
        case _:
            always, never = not low <= value <= high, False
    if always or never:
        word = "always" if always else "never"
        limits = f"{leaf.subject.text} is {_limits(terms)}"
        code = "ALWAYS_TRUE" if always else "NEVER_TRUE"
        yield Fault("warning", code, f"{word} true: {limits}", column)


def _limits(terms: Terms) -> str:
    if terms.minimum is None:
        return f"at most {terms.maximum:g}"
    if terms.maximum is None:
        return f"at least {terms.minimum:g}"
    return f"from {terms.minimum:g} to {terms.maximum:g}"
