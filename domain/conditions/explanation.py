"""Explains why a condition is not true, as a tree of blockers down to the leaves that decide it."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TypeAlias, assert_never

from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth, compare, truth_of
from domain.conditions.facts import Facts, Observation
from domain.conditions.tree import (
    AllOf,
    AnyOf,
    Comparison,
    Constant,
    Node,
    Operator,
    Subject,
    TopicKind,
    Value,
    is_number,
    negated,
    value_text,
)
from domain.findings import Blocker
from domain.timebase import Instant

CONDITION = "CONDITION"
UNKNOWN_VALUE = "UNKNOWN_VALUE"


Since: TypeAlias = Callable[[Comparison], Instant | None]
"""Returns since when a comparison is not true; None: that is not recorded."""


def explain(
    condition: Condition, facts: Facts, since: Since = lambda _: None
) -> tuple[Blocker, ...]:
    """Return why a condition is not true; empty: it is.

    One blocker is returned, with the text of the condition as it is written. Below an `and` stand
    the operands that are not true, below an `or` all of them; what is negated is shown turned
    round. A leaf is explained further by the facts.

    Args:
        condition: The condition.
        facts: What is known now.
        since: Tells since when a comparison is not true, where the facts do not.
    """
    blocker = _Explanation(facts, since).of(condition.root, condition.text.strip())
    return () if blocker is None else (blocker,)


def explain_true(
    condition: Condition, facts: Facts, since: Since = lambda _: None
) -> tuple[Blocker, ...]:
    """Return why a condition is true, as why its opposite is not; empty: it is false.

    Each leaf says what would have to be for the condition to end. Arguments are as for `explain`.
    """
    text = condition.text.strip()
    blocker = _Explanation(facts, since).of(negated(condition.root), text)
    if blocker is None:
        return ()
    if not isinstance(condition.root, Comparison):
        blocker = replace(blocker, message=f"true: {text}")
    return (blocker,)


class _Explanation:
    """Each comparison is evaluated once; what is true is never explained."""

    def __init__(self, facts: Facts, since: Since) -> None:
        self._facts = facts
        self._since = since
        self._leaves: dict[str, tuple[Observation, Truth]] = {}

    def of(self, node: Node, text: str) -> Blocker | None:
        """Return why a node is not true; None: it is.

        Args:
            node: The node.
            text: How it is written.
        """
        match node:
            case Comparison():
                return self._of_leaf(node, text)
            case Constant(value):
                return (
                    None if value else Blocker(CONDITION, "it is always false", (), condition=text)
                )
            case AllOf(operands):
                causes = self._of_each(operands)
                if not causes:
                    return None
                return _joined(text, causes, is_false=any(c.code == CONDITION for c in causes))
            case AnyOf(operands):
                if truth_of(node, self._truth) is Truth.TRUE:
                    return None
                causes = self._of_each(operands)
                return _joined(text, causes, is_false=all(c.code == CONDITION for c in causes))
            case _:
                assert_never(node)

    def _of_each(self, operands: tuple[Node, ...]) -> tuple[Blocker, ...]:
        causes = [self.of(operand, operand.text) for operand in operands]
        return tuple([cause for cause in causes if cause is not None])

    def _look(self, leaf: Comparison) -> tuple[Observation, Truth]:
        seen = self._leaves.get(leaf.text)
        if seen is None:
            observed = self._facts.observe(leaf.subject)
            seen = self._leaves[leaf.text] = observed, compare(leaf, observed)
        return seen

    def _truth(self, leaf: Comparison) -> Truth:
        return self._look(leaf)[1]

    def _of_leaf(self, leaf: Comparison, text: str) -> Blocker | None:
        observed, truth = self._look(leaf)
        if truth is Truth.TRUE:
            return None
        causes = self._facts.why(leaf)
        kind, name, part = leaf.subject.topic
        named = part or (name if kind in (TopicKind.PART, TopicKind.SIGNAL) else "")
        return Blocker(
            CONDITION if truth is Truth.FALSE else UNKNOWN_VALUE,
            leaf_words(leaf, observed),
            (named,) if named else (),
            observed.value,
            leaf.threshold,
            self._since(leaf) if observed.since is None else observed.since,
            root_cause=not causes,
            causes=causes,
            condition=text,
        )


def _joined(text: str, causes: tuple[Blocker, ...], *, is_false: bool) -> Blocker:
    code, words = (CONDITION, "not met") if is_false else (UNKNOWN_VALUE, "unknown")
    return Blocker(code, f"{words}: {text}", (), root_cause=False, causes=causes, condition=text)


# --- words ---------------------------------------------------------------------------------------


def leaf_words(leaf: Comparison, observed: Observation) -> str:
    """Return a comparison that is not true in an operator's words.

    Such as `battery_level is 0.21, needs >= 0.3`, or `drive_base is inactive, needs active`.
    """
    subject = leaf.subject
    if observed.doubt:
        return f"{_subject_words(subject)} {observed.doubt}, {_needs(leaf, observed.unit)}"
    flag = _FLAGS.get(subject.attribute or subject.topic.kind)
    if flag is not None and isinstance(observed.value, bool):
        return f"{_subject_words(subject)} {flag[0] if observed.value else flag[1]}"
    value = "none" if observed.value is None else _with_unit(observed.value, observed.unit)
    return f"{_subject_words(subject)} is {value}, {_needs(leaf, observed.unit)}"


_FLAGS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "reachable": ("is reachable", "is unreachable"),
        "converged": ("has converged", "has not converged"),
        TopicKind.ERROR: ("is active", "is not active"),
        TopicKind.HOLD: ("is set", "is not set"),
    }
)
"""What is said of a fact that is true or false, if it is true and if it is not."""


def _needs(leaf: Comparison, unit: str) -> str:
    values = " or ".join(_with_unit(value, unit) for value in leaf.values)
    match leaf.operator:
        case Operator.NOT_EQUAL if isinstance(leaf.threshold, bool):
            return f"needs {value_text(leaf.threshold)}"
        case Operator.EQUAL | Operator.IN:
            return f"needs {values}"
        case Operator.NOT_EQUAL | Operator.NOT_IN:
            return f"needs anything but {values}"
        case _:
            return f"needs {leaf.operator} {values}"


def _with_unit(value: Value, unit: str) -> str:
    if isinstance(value, str):
        return value
    shown = f"{value:.6g}" if isinstance(value, float) else value_text(value)
    return f"{shown} {unit}" if unit and is_number(value) else shown


def _subject_words(subject: Subject) -> str:
    kind, name, part = subject.topic
    if kind is TopicKind.PART:
        if subject.attribute == "parameters":
            return f"{subject.key} of {name}"
        return f"the mode of {name}" if subject.attribute == "mode" else name
    if kind is TopicKind.ERROR:
        return f"{name} of {part}" if part else name
    if kind is TopicKind.SIGNAL:
        return name
    if kind is TopicKind.HOLD:
        return f"hold {name}"
    return _WORDS.get((kind, subject.attribute), f"{kind} {subject.attribute}")


_WORDS = {
    (TopicKind.ROBOT, "state"): "the robot",
    (TopicKind.TASK, "status"): "the task status",
    (TopicKind.TASK, "progress"): "the progress of the task",
    (TopicKind.VEHICLE, "speed_mps"): "the speed of the vehicle",
    (TopicKind.VEHICLE, "x_m"): "x of the vehicle",
    (TopicKind.VEHICLE, "y_m"): "y of the vehicle",
    (TopicKind.VEHICLE, "yaw_rad"): "the yaw of the vehicle",
    (TopicKind.VEHICLE, "steering_angle_rad"): "the steering angle of the vehicle",
}
