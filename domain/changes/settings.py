"""Settings of changes."""

from dataclasses import dataclass

from domain.state_and_mode import PartName
from domain.timebase import Duration, seconds


@dataclass(frozen=True, slots=True)
class ChangeSettings:
    """Deadlines of the steps of changes, and the nodes that are restored when they reappear."""

    transition_deadline: Duration = seconds(10)
    parameters_deadline: Duration = seconds(2)
    facts_deadline: Duration = seconds(1)
    """For the query of the node's state before a step is declared timed out."""
    restored_nodes: frozenset[PartName] = frozenset()
    """Nodes that are restored to their target when they reappear."""
