"""Which parts have converged, kept up to date part by part.

A part has converged when it and all its parts are where their targets say. D4.8 calls a system
`inactive` while its nodes are unconfigured; where they were asked to be inactive, it has not
converged.
"""

from bisect import bisect_left
from collections.abc import Collection, Iterable, Mapping, Set
from heapq import heapify, heappop, heappush
from itertools import chain

from domain.errors import shortened
from domain.events.event import because
from domain.lifecycle import LifecycleState
from domain.parts.system_model import SmhModel, SystemModel
from domain.snapshot import Actual
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

MAX_REASON = 200
"""Characters of a reason; a model may have names of any length."""


def is_there(actual: StateAndMode | Actual, target: StateAndMode) -> bool:
    """Tell whether a part is in its target state and mode; a target without a mode allows any."""
    if actual.state is not target.state:
        return False
    if target.state is not LifecycleState.ACTIVE or target.mode is None:
        return True
    return actual.mode == target.mode


def bottom_up(model: SmhModel) -> list[PartName]:
    """Return the systems of a model, each after all systems below it."""
    return sorted(model.systems, key=lambda name: (-len(model.ancestors[name]), name))


class _Laggards:
    """The parts of one system that have not converged, in the order of the file."""

    def __init__(self, system: SystemModel) -> None:
        self._names = system.named_parts
        self._number = {name: number for number, name in enumerate(self._names)}
        self._numbers: list[int] = []
        every = frozenset(self._names)
        default = system.modes.get(DEFAULT_MODE, {}).keys()
        named = {mode: default | wanted.keys() for mode, wanted in system.modes.items()}
        self._of_mode: dict[ModeName, frozenset[PartName]] = {
            mode: frozenset(parts) for mode, parts in named.items() if parts != every
        }
        """Parts of the modes that leave some of the named parts out."""

    def note(self, part: PartName, *, lags: bool) -> None:
        """Record whether a part lags; without effect if that is recorded already."""
        numbers, number = self._numbers, self._number[part]
        if not numbers or numbers[-1] < number:
            # Nodes are asked in the order of the file.
            if lags:
                numbers.append(number)
            return
        place = bisect_left(numbers, number)
        if lags and numbers[place] != number:
            numbers.insert(place, number)
        elif not lags and numbers[place] == number:
            del numbers[place]

    def last(self, target: StateAndMode | None) -> PartName | None:
        """Return the last laggard of the parts that a system with this target has."""
        if not self._numbers:
            return None
        mode = target.mode if target is not None else None
        parts = self._of_mode.get(mode or DEFAULT_MODE)
        if parts is None:
            return self._names[self._numbers[-1]]
        lagging = (self._names[number] for number in reversed(self._numbers))
        return next((part for part in lagging if part in parts), None)


class Convergence:
    """Of each part that has not converged, the part that is the cause.

    The parts of a system are those of `__DEFAULT__`, and those of its target mode. The cause is the
    deepest part that is not where its own target says, in the last branch that has one: nodes start
    in the order of the file, so that the cause stays the same while a large robot changes.
    """

    def __init__(
        self,
        model: SmhModel,
        parents: Mapping[PartName, tuple[PartName, ...]],
        targets: Mapping[PartName, StateAndMode],
        actuals: Mapping[PartName, Actual],
        plain: Set[PartName],
    ) -> None:
        """Begin with all parts converged.

        Args:
            model: The model.
            parents: The systems that name each part.
            targets: Targets in force; followed, never changed.
            actuals: Actual states and modes; followed, never changed.
            plain: Nodes without a lifecycle; followed, never changed.
        """
        self._targets = targets
        self._actuals = actuals
        self._plain = plain
        self._parents = parents
        self._bottom_up = bottom_up(model)
        self._rank = {name: rank for rank, name in enumerate(self._bottom_up)}
        self._laggards = {name: _Laggards(system) for name, system in model.systems.items()}
        self._causes: dict[PartName, PartName] = {}

    def converged(self, part: PartName) -> bool:
        """Tell whether a part and all its parts are where their targets say."""
        return part not in self._causes

    def cause(self, part: PartName) -> PartName | None:
        """Return the part because of which a part has not converged; None: it has."""
        return self._causes.get(part)

    def reason(self, part: PartName) -> str | None:
        """Return which part is not where its target says; None: the part has converged."""
        cause = self._causes.get(part)
        if cause is None:
            return None
        actual, target = self._actuals[cause], self._targets[cause]
        words = f"{cause} is {actual.state_and_mode.label}, target {target.label}"
        is_why = actual.state in (LifecycleState.UNKNOWN, target.state)
        return shortened(because(words, actual.reason if is_why else None), MAX_REASON)

    def renew(self, parts: Collection[PartName]) -> set[PartName]:
        """Judge parts whose target or actual changed, and bottom-up the systems above them.

        Returns:
            Parts of which `converged` or `reason` changed.
        """
        # In bulk where it can be: there may be ten thousand.
        moved, parents = set(parts), self._parents
        waiting = moved & self._rank.keys()
        renewed = self._renew_nodes([part for part in parts if part not in waiting])
        if len(waiting) < len(self._rank):
            above = [parents[node] for node in renewed if node in parents]
            waiting.update(chain.from_iterable(above))
        order = [self._rank[name] for name in waiting]
        heapify(order)
        while order:
            name = self._bottom_up[heappop(order)]
            if not self._renew(name, self._cause(name), moved):
                continue
            renewed.add(name)
            for parent in self._parents.get(name, ()):
                if parent not in waiting:
                    waiting.add(parent)
                    heappush(order, self._rank[parent])
        return renewed

    def _renew_nodes(self, nodes: Iterable[PartName]) -> set[PartName]:
        """Judge nodes that moved; return those of which what is told may have changed.

        As `_renew` with `_is_behind`, with less work: the cause of a node is the node itself, and a
        request may move ten thousand of them.
        """
        causes, laggards, parents = self._causes, self._laggards, self._parents
        targets, actuals, active = self._targets, self._actuals, LifecycleState.ACTIVE
        renewed: set[PartName] = set()
        for node in nodes:
            target, lags = targets.get(node), False
            if target is not None:
                actual, goal = actuals[node], target.state
                if actual.state is not goal:
                    lags = actual.state is not active or node not in self._plain
                elif goal is active:
                    lags = target.mode is not None and actual.mode != target.mode
            if lags:
                renewed.add(node)
            if lags is (node in causes):
                continue
            renewed.add(node)
            if lags:
                causes[node] = node
            else:
                del causes[node]
            for parent in parents.get(node, ()):
                laggards[parent].note(node, lags=lags)
        return renewed

    def _renew(self, part: PartName, cause: PartName | None, moved: set[PartName]) -> bool:
        """Take over the cause of a part; return whether that or what is told of it changed."""
        was = self._causes.get(part)
        if cause is was:
            return cause is not None and cause in moved
        if cause is None:
            del self._causes[part]
        else:
            self._causes[part] = cause
        if cause is None or was is None:
            for parent in self._parents.get(part, ()):
                self._laggards[parent].note(part, lags=cause is not None)
        return True

    def _cause(self, system: PartName) -> PartName | None:
        last = self._laggards[system].last(self._targets.get(system))
        if last is not None:
            return self._causes[last]
        return system if self._is_behind(system) else None

    def _is_behind(self, part: PartName) -> bool:
        """Tell whether a part is not where its own target says.

        A known plain node is always active; a target in which it is not is a transition of its
        system, which asks nothing of it.
        """
        target = self._targets.get(part)
        if target is None:
            return False
        actual = self._actuals[part]
        if actual.state is target.state:
            return not is_there(actual, target)
        return not (part in self._plain and actual.state is LifecycleState.ACTIVE)
