"""Whether conditions can be true at the same time, as far as their comparisons tell.

The search tries the operands of each `or`. Its effort is bounded: where it gives up, the
conditions count as possible, so that a warning is never wrong.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import TypeAlias

from domain.conditions.tree import (
    AllOf,
    AnyOf,
    Comparison,
    Constant,
    Node,
    Operator,
    Subject,
)
from domain.parts.lint.budget import Budget
from domain.parts.lint.values import Values

MAX_STEPS = 5_000
"""Comparisons of one search."""

MAX_CHOICES = 200
"""Operands of `or` that are chosen at the same time."""

Domain: TypeAlias = Callable[[Subject], Values]
"""Returns all values that a fact can have."""

Consequences: TypeAlias = Callable[[Comparison], Iterable[Comparison]]
"""Returns what else is true if a comparison is."""

_Known: TypeAlias = Mapping[Subject, Values]


def nothing_follows(_leaf: Comparison) -> Iterable[Comparison]:
    """Return no consequences."""
    return ()


def equals(subject: Subject, *values: str | bool | float) -> Comparison:
    """Return the comparison that a fact is one of some values."""
    return Comparison(subject, Operator.IN, values, (1,) * len(values))


class Satisfiability:
    """Searches for values that make conditions true, within a budget for all searches."""

    def __init__(self, budget: Budget) -> None:
        self._budget = budget

    def can_be_true(
        self, conditions: Iterable[Node], domain: Domain, follows: Consequences = nothing_follows
    ) -> bool:
        """Tell whether all conditions can be true at the same time.

        Args:
            conditions: Roots of conditions.
            domain: Returns the values that a fact can have.
            follows: Returns what else is true if a comparison is.
        """
        search = _Search(domain, follows)
        can_hold = self._budget.is_spent or search.can_hold(list(conditions), {}, 0)
        self._budget.spend(search.steps)
        return can_hold


class _Search:
    def __init__(self, domain: Domain, follows: Consequences) -> None:
        self._domain = domain
        self._follows = follows
        self.steps = 0

    def can_hold(self, nodes: list[Node], known: _Known, choices: int) -> bool:
        """Tell whether the nodes can be true together with what is known."""
        facts = dict(known)
        self.steps += len(facts)
        waiting, undecided = list(nodes), []
        while waiting:
            self.steps += 1
            node = waiting.pop()
            match node:
                case AllOf(operands):
                    waiting.extend(operands)
                case AnyOf():
                    undecided.append(node)
                case Constant(value):
                    if not value:
                        return False
                case Comparison():
                    if not self._assume(node, facts):
                        return False
        if not undecided or self.steps > MAX_STEPS or choices == MAX_CHOICES:
            return True
        first, *others = undecided
        return any(
            self.can_hold([operand, *others], facts, choices + 1) for operand in first.operands
        )

    def _assume(self, leaf: Comparison, facts: dict[Subject, Values]) -> bool:
        """Add a comparison with all that follows from it; False: it contradicts what is known."""
        for own in (leaf, *self._follows(leaf)):
            subject = own.subject
            before = facts.get(subject)
            values = (self._domain(subject) if before is None else before).after(own)
            if values.is_empty:
                return False
            facts[subject] = values
        return True
