"""What facts about a robot can be at all, by its model."""

from collections.abc import Iterator
from dataclasses import replace

from domain.conditions.check import Fault, terms_of
from domain.conditions.tree import Comparison, Operator, Subject, Topic, TopicKind
from domain.conditions.vocabulary import Kind, Vocabulary
from domain.lifecycle import LifecycleState
from domain.parameters import ParameterValue
from domain.parts.lint.satisfiable import equals
from domain.parts.lint.values import Values
from domain.parts.system_model import SmhModel
from domain.state_and_mode import ModeName, PartName, StateAndMode

_ANYTHING = Values()
_TRUTHS = Values.of((True, False))
_WITH_A_MODE = (str(LifecycleState.ACTIVE), str(LifecycleState.ACTIVATING))
_OF_THE_NODE = ("state", "mode", "parameters")
_AT_REST = (str(LifecycleState.INACTIVE), str(LifecycleState.UNCONFIGURED))


class PossibleValues:
    """Values that facts can have, and what follows from one about another of the same part."""

    def __init__(self, model: SmhModel, vocabulary: Vocabulary) -> None:
        self._model = model
        self._vocabulary = vocabulary
        self._known: dict[Subject, Values] = {}

    def of(self, subject: Subject) -> Values:
        """Return all values that a fact can have; anything where it is not known."""
        known = self._known.get(subject)
        if known is None:
            known = self._known[subject] = self._values_of(subject)
        return known

    def _values_of(self, subject: Subject) -> Values:
        terms = terms_of(subject, self._vocabulary)
        if isinstance(terms, Fault):
            return _ANYTHING
        if terms.kind is Kind.BOOLEAN:
            return _TRUTHS
        if terms.words is not None:
            no_mode = (None,) if subject.attribute == "mode" else ()
            return Values.of((*terms.words, *no_mode))
        if terms.kind is Kind.NUMBER:
            low = _ANYTHING.low if terms.minimum is None else terms.minimum
            high = _ANYTHING.high if terms.maximum is None else terms.maximum
            return replace(_ANYTHING, low=low, high=high)
        return _ANYTHING

    def follows(self, leaf: Comparison) -> Iterator[Comparison]:
        """Yield what must be true of the same part, so that a comparison can be true."""
        subject = leaf.subject
        if subject.topic.kind is not TopicKind.PART or subject.attribute not in _OF_THE_NODE:
            return
        if subject.attribute == "mode" and leaf.operator in (Operator.EQUAL, Operator.IN):
            yield equals(replace(subject, attribute="state"), *_WITH_A_MODE)
        if subject.topic.name in self._model.nodes:
            yield equals(replace(subject, attribute="reachable", key=""), True)

    def facts_of(self, part: PartName, pair: StateAndMode) -> Iterator[Comparison]:
        """Yield what is true of a part that is in a state and mode.

        Args:
            part: Any part.
            pair: What it is in; inactive includes unconfigured.
        """
        topic = Topic(TopicKind.PART, part)
        is_inactive = pair.state is LifecycleState.INACTIVE
        yield equals(Subject(topic, "state"), *(_AT_REST if is_inactive else (str(pair.state),)))
        if pair.state is not LifecycleState.ACTIVE or pair.mode is None:
            return
        if pair.mode in self._model.modes_of(part):
            yield equals(Subject(topic, "mode"), str(pair.mode))
            yield from self._facts_of_node(part, topic, pair.mode)

    def _facts_of_node(self, part: PartName, topic: Topic, mode: ModeName) -> Iterator[Comparison]:
        node = self._model.nodes.get(part)
        if node is None:
            return
        for name, value in node.modes[mode].items():
            if isinstance(value, bool | int | float | str) and _is_equal_to_itself(value):
                yield equals(Subject(topic, "parameters", name), value)


def _is_equal_to_itself(value: ParameterValue) -> bool:
    return value == value
