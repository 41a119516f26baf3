"""Guards over facts that a test sets."""

from collections.abc import Mapping

from domain.changes.guards import Guards
from domain.conditions.facts import Observation
from domain.conditions.tree import Comparison, Subject, Value
from domain.conditions.watched import WatchedConditions
from domain.findings import Blocker
from domain.parts.system_model import SmhModel


class SetFacts:
    """Signals with the values that a test gives them; all others were never seen."""

    def __init__(self, values: Mapping[str, Value] | None = None) -> None:
        self.values = dict(values or {})

    def observe(self, subject: Subject) -> Observation:
        """Return the value of a signal."""
        value = self.values.get(subject.topic.name)
        return Observation(value, "" if value is not None else "was never seen")

    def why(self, leaf: Comparison) -> tuple[Blocker, ...]:
        """Explain nothing."""
        return ()


def unguarded(model: SmhModel) -> Guards:
    """Return the guards of a model that has none."""
    return Guards(model, WatchedConditions(SetFacts()), 0)
