"""What a mode of a system demands of a part somewhere below it."""

from collections import Counter

from domain.lifecycle import LifecycleState
from domain.parts.lint.budget import Budget
from domain.parts.lint.warning import meaning
from domain.parts.system_model import SmhModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

_Pairs = frozenset[StateAndMode]
_NONE: _Pairs = frozenset()
_AT_REST = (LifecycleState.INACTIVE, LifecycleState.UNCONFIGURED)


class Demands:
    """Demands of the modes of one model; each is worked out once, when it is asked for."""

    def __init__(self, model: SmhModel, budget: Budget) -> None:
        self._model = model
        self._budget = budget
        self._known: dict[tuple[PartName, StateAndMode, PartName], _Pairs] = {}

    def of_mode(self, part: PartName, mode: ModeName, below: PartName) -> _Pairs:
        """Return what a mode demands of a part below it; several: it reaches it on several ways.

        Args:
            part: Any part; a node demands nothing of others.
            mode: Its mode.
            below: The part that is demanded.
        """
        return self.of_pair(part, StateAndMode(LifecycleState.ACTIVE, mode), below)

    def of_pair(self, part: PartName, pair: StateAndMode, below: PartName) -> _Pairs:
        """Return what a part in a state and mode demands of a part below it, or of itself."""
        if part == below:
            return frozenset((meaning(pair),))
        above = self._model.ancestors[below]
        if part not in above or self._budget.is_spent:
            return _NONE
        key = (part, meaning(pair), below)
        if key not in self._known:
            self._known[key] = self._below(part, key[1], below)
        return self._known[key]

    def _below(self, part: PartName, pair: StateAndMode, below: PartName) -> _Pairs:
        system = self._model.systems[part]
        if pair.state is LifecycleState.ACTIVE:
            wanted = system.modes.get(pair.mode or DEFAULT_MODE, {})
        else:
            wanted = dict.fromkeys(system.parts, pair)
        self._budget.spend(1 + len(wanted))
        found: set[StateAndMode] = set()
        for child, want in wanted.items():
            found |= self.of_pair(child, want, below)
        return frozenset(found)


def contradict(pairs: _Pairs) -> bool:
    """Tell whether no part can meet all demands; unconfigured passes for inactive."""
    if len(pairs) < 2:
        return False
    states = {pair.state for pair in pairs}
    return not states <= set(_AT_REST)


def conflicting_demands(
    model: SmhModel, demands: Demands, budget: Budget
) -> dict[tuple[PartName, ModeName], str]:
    """Return the modes that demand of one part what it cannot be at once, and why.

    Only the lowest systems: a mode that demands such a mode of a part is not told again.
    """
    parents = Counter(part for system in model.systems.values() for part in system.named_parts)
    found: dict[tuple[PartName, ModeName], str] = {}
    for part in (part for part, number in parents.items() if number > 1):
        for name in model.ancestors[part]:
            for mode, wanted in model.systems[name].modes.items():
                budget.spend()
                if budget.is_spent:
                    return found
                pairs = demands.of_mode(name, mode, part)
                below = ((child, meaning(want).mode) for child, want in wanted.items())
                if contradict(pairs) and not any(place in found for place in below):
                    labels = " and ".join(sorted(pair.label for pair in pairs))
                    found.setdefault((name, mode), f"its parts require {part} to be {labels}")
    return found
