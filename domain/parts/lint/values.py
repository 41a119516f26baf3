"""Sets of values that a fact can have after some comparisons."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TypeAlias

from domain.conditions.tree import Comparison, Operator, Value, is_number

Key: TypeAlias = tuple[str, object]
"""A value with its kind, since `true` equals 1 in Python, but not on a robot."""


@dataclass(frozen=True, slots=True)
class Values:
    """Values that a fact can have: listed ones, or numbers between bounds, but for some."""

    listed: frozenset[Key] | None = None
    """None: any within the bounds."""
    excluded: frozenset[Key] = frozenset()
    low: float = -math.inf
    high: float = math.inf
    is_low_open: bool = False
    """The lower bound itself is none of the values."""
    is_high_open: bool = False

    @classmethod
    def of(cls, values: Iterable[Value | None]) -> "Values":
        """Return a list of values; None stands for no value, such as no mode."""
        return cls(frozenset(map(_key, values)))

    def after(self, leaf: Comparison) -> "Values":
        """Return the values for which a comparison is true."""
        operator, keys = leaf.operator, frozenset(map(_key, leaf.values))
        if operator in (Operator.EQUAL, Operator.IN):
            listed = keys if self.listed is None else keys & self.listed
            return replace(self, listed=listed)
        if operator in (Operator.NOT_EQUAL, Operator.NOT_IN):
            return replace(self, excluded=self.excluded | keys)
        return self._bounded(operator, leaf.values[0])

    def without(self, values: Iterable[Value]) -> "Values":
        """Return these values but for some."""
        return replace(self, excluded=self.excluded | frozenset(map(_key, values)))

    def _bounded(self, operator: Operator, value: Value) -> "Values":
        if not isinstance(value, int | float) or isinstance(value, bool):
            return self
        if operator is Operator.LESS and value <= self.high:
            return replace(self, high=value, is_high_open=True)
        if operator is Operator.LESS_OR_EQUAL and value < self.high:
            return replace(self, high=value, is_high_open=False)
        if operator is Operator.GREATER and value >= self.low:
            return replace(self, low=value, is_low_open=True)
        if operator is Operator.GREATER_OR_EQUAL and value > self.low:
            return replace(self, low=value, is_low_open=False)
        return self

    @property
    def is_empty(self) -> bool:
        """Tell whether no value is left."""
        if self.listed is not None:
            return not any(self._allows(key) for key in self.listed)
        if self.low < self.high:
            return False
        is_open = self.is_low_open or self.is_high_open
        return self.low > self.high or is_open or _key(self.low) in self.excluded

    def _allows(self, key: Key) -> bool:
        if key in self.excluded:
            return False
        value = key[1]
        if not isinstance(value, float):
            return True
        above = value > self.low or (value == self.low and not self.is_low_open)
        below = value < self.high or (value == self.high and not self.is_high_open)
        return above and below


def _key(value: Value | None) -> Key:
    """Return a value with its kind; numbers are compared as doubles."""
    if is_number(value):
        return "number", float(value)  # type: ignore[arg-type]  # it is a number
    return type(value).__name__, value
