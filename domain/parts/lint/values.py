"""Sets of values that a fact can have after some comparisons."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
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
        operator = leaf.operator
        if operator is Operator.EQUAL or operator is Operator.IN:
            keys = frozenset(map(_key, leaf.values))
            return self._listing(keys if self.listed is None else keys & self.listed)
        if operator is Operator.NOT_EQUAL or operator is Operator.NOT_IN:
            return self.without(leaf.values)
        return self._bounded(operator, leaf.values[0])

    def without(self, values: Iterable[Value]) -> "Values":
        """Return these values but for some."""
        excluded = self.excluded | frozenset(map(_key, values))
        return Values(
            self.listed, excluded, self.low, self.high, self.is_low_open, self.is_high_open
        )

    def _listing(self, listed: frozenset[Key]) -> "Values":
        return Values(
            listed, self.excluded, self.low, self.high, self.is_low_open, self.is_high_open
        )

    def _bounded(self, operator: Operator, value: Value) -> "Values":
        """Return the values on one side of a bound; only numbers have sides."""
        if not isinstance(value, int | float) or isinstance(value, bool):
            return self
        low, high = self.low, self.high
        is_low_open, is_high_open = self.is_low_open, self.is_high_open
        if operator in (Operator.LESS, Operator.LESS_OR_EQUAL):
            is_open = operator is Operator.LESS
            if value < high or (value == high and is_open):
                high, is_high_open = value, is_open
        else:
            is_open = operator is Operator.GREATER
            if value > low or (value == low and is_open):
                low, is_low_open = value, is_open
        return Values(self.listed, self.excluded, low, high, is_low_open, is_high_open)

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
