"""Which parts have converged, kept up to date part by part.

A part has converged when it and all its parts are where their targets say. D4.8 calls a system
`inactive` while its nodes are unconfigured; where they were asked to be inactive, it has not
converged.
"""

from bisect import bisect_left, insort
from collections.abc import Iterable, Mapping, Set
from heapq import heapify, heappop, heappush

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
        number = self._number[part]
        place = bisect_left(self._numbers, number)
        is_known = place < len(self._numbers) and self._numbers[place] == number
        if lags and not is_known:
            insort(self._numbers, number)
        elif is_known and not lags:
            del self._numbers[place]

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
        self._depth = {name: len(model.ancestors[name]) for name in model.systems}
        self._laggards = {name: _Laggards(system) for name, system in model.systems.items()}
        self._causes: dict[PartName, PartName] = {}

    def converged(self, part: PartName) -> bool:
        """Tell whether a part and all its parts are where their targets say."""
        return part not in self._causes

    def reason(self, part: PartName) -> str | None:
        """Return which part is not where its target says; None: the part has converged."""
        cause = self._causes.get(part)
        if cause is None:
            return None
        actual, target = self._actuals[cause], self._targets[cause]
        words = f"{cause} is {actual.state_and_mode.label}, target {target.label}"
        is_why = actual.state in (LifecycleState.UNKNOWN, target.state)
        return shortened(because(words, actual.reason if is_why else None), MAX_REASON)

    def renew(self, parts: Iterable[PartName]) -> set[PartName]:
        """Judge parts whose target or actual changed, and bottom-up the systems above them.

        Returns:
            Parts of which `converged` or `reason` changed.
        """
        moved = set(parts)
        renewed: set[PartName] = set()
        waiting: set[PartName] = set()
        for part in moved:
            if part in self._depth:
                waiting.add(part)
            elif self._renew_node(part):
                renewed.add(part)
                waiting.update(self._parents.get(part, ()))
        order = [(-self._depth[name], name) for name in waiting]
        heapify(order)
        while order:
            _, name = heappop(order)
            if not self._renew(name, self._cause(name), moved):
                continue
            renewed.add(name)
            for parent in self._parents.get(name, ()):
                if parent not in waiting:
                    waiting.add(parent)
                    heappush(order, (-self._depth[parent], parent))
        return renewed

    def _renew_node(self, node: PartName) -> bool:
        """Judge a node that moved; return whether what is told of it may have changed.

        As `_renew`, with less work: the cause of a node is the node itself, and a request may move
        ten thousand of them.
        """
        lags = self._own_cause(node) is not None
        if lags is (node in self._causes):
            return lags
        if lags:
            self._causes[node] = node
        else:
            del self._causes[node]
        for parent in self._parents.get(node, ()):
            self._laggards[parent].note(node, lags=lags)
        return True

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
        return self._own_cause(system) if last is None else self._causes[last]

    def _own_cause(self, part: PartName) -> PartName | None:
        """Return a part itself, if it is not where its own target says."""
        target, actual = self._targets.get(part), self._actuals[part]
        if target is None:
            return None
        if actual.state is target.state and is_there(actual, target):
            return None
        return None if part in self._plain and self._is_asked_nothing(part, target) else part

    def _is_asked_nothing(self, plain: PartName, target: StateAndMode) -> bool:
        """Tell whether a target of a known plain node is only a transition of its system."""
        is_active = self._actuals[plain].state is LifecycleState.ACTIVE
        return is_active and target.state is not LifecycleState.ACTIVE
