"""Facts for conditions that a test tells; whatever it does not tell was never seen."""

from collections.abc import Mapping

from domain.conditions.facts import Observation
from domain.conditions.tree import Comparison, Subject
from domain.findings import Blocker


class ToldFacts:
    """Observations by the text of their subject, such as `drive_base.state`."""

    def __init__(
        self,
        observed: Mapping[str, Observation | bool | float | str | None],
        reasons: Mapping[str, tuple[Blocker, ...]] | None = None,
    ) -> None:
        """Hold what is told.

        Args:
            observed: A value alone is one that is known.
            reasons: What `why` answers, by the text of the comparison.
        """
        self.observed = dict(observed)
        self._reasons = reasons or {}

    def observe(self, subject: Subject) -> Observation:
        """Return what was told."""
        told = self.observed.get(subject.text, Observation(None, "was never seen"))
        return told if isinstance(told, Observation) else Observation(told)

    def why(self, leaf: Comparison) -> tuple[Blocker, ...]:
        """Return the reasons that were told."""
        return self._reasons.get(leaf.text, ())
