"""Between which numbers no value is bad, so that most values are judged at a glance."""

import math
from collections.abc import Iterable
from typing import NamedTuple

from domain.health.signals import Bound, Comparison


class GoodRange(NamedTuple):
    """The numbers from one to another, both included; all of them unless it says otherwise."""

    lowest: float = -math.inf
    highest: float = math.inf


def good_range(bounds: Iterable[Bound]) -> GoodRange:
    """Return the numbers that meet none of the bounds while no error is on.

    Bounds of what is no number have no such range: it is empty.
    """
    lowest, highest = GoodRange()
    for bound in bounds:
        if bound.comparison is Comparison.EQUAL:
            return GoodRange(math.inf, -math.inf)
        if bound.comparison is Comparison.ABOVE:
            highest = min(highest, float(bound.threshold))
        else:
            lowest = max(lowest, float(bound.threshold))
    return GoodRange(lowest, highest)


def good_in_all(ranges: Iterable[GoodRange]) -> GoodRange:
    """Return the numbers that are in all ranges."""
    lowest, highest = GoodRange()
    for each in ranges:
        lowest, highest = max(lowest, each.lowest), min(highest, each.highest)
    return GoodRange(lowest, highest)
