"""When each part of a change begins and ends, if every node takes its time."""

from collections.abc import Iterator, Mapping
from typing import TypeAlias

from domain.plans.scope import Scope
from domain.state_and_mode import PartName
from domain.timebase import Duration

_Moment: TypeAlias = tuple[PartName, bool]
"""A part, and whether it is its end; there are twenty thousand of a large robot."""


class Timing:
    """Foresees the moments that are asked for, and only those that they depend on."""

    def __init__(self, scope: Scope, times: Mapping[PartName, Duration] | None = None) -> None:
        """Foresee nothing yet.

        Args:
            scope: What is ordered; every node in it begins some time.
            times: How long each node takes; None: one stage each.
        """
        self._scope = scope
        self._times = times
        self._known: dict[_Moment, int] = {}

    def begin(self, part: PartName) -> int:
        """Return when a part begins, at the earliest."""
        return self._at((part, False))

    def end(self, part: PartName) -> int:
        """Return when a part is done, at the earliest."""
        return self._at((part, True))

    def _at(self, moment: _Moment) -> int:
        """Return when a moment is; without recursion, since a row may have ten thousand parts."""
        known, left = self._known, [moment]
        while left:
            last = left[-1]
            earlier = list(self._before(last))
            unknown = [each for each in earlier if each not in known]
            if unknown:
                left += unknown
                continue
            known[last] = max(map(known.__getitem__, earlier), default=0) + self._lasts(last)
            left.pop()
        return known[moment]

    def _before(self, moment: _Moment) -> Iterator[_Moment]:
        """Yield the moments that decide when another one is."""
        scope, (part, is_end) = self._scope, moment
        if is_end:
            yield (part, False)
            yield from ((inner, True) for inner in scope.inside(part))
            return
        for system in scope.systems_of(part):
            yield (system, False)
            if (links := scope.links.get(system)) is not None:
                yield from ((name, True) for name in links.before.get(part, ()))

    def _lasts(self, moment: _Moment) -> int:
        part, is_end = moment
        if not is_end or part not in self._scope.nodes:
            return 0
        return 1 if self._times is None else self._times[part]
