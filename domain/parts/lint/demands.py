"""What a mode of a system demands of a part somewhere below it."""

from domain.lifecycle import LifecycleState
from domain.parts.lint.warning import meaning
from domain.parts.system_model import SmhModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

MAX_STEPS = 500_000
"""Systems looked at for one model; beyond, demands are taken as unknown."""

_Pairs = frozenset[StateAndMode]
_NONE: _Pairs = frozenset()
_AT_REST = (LifecycleState.INACTIVE, LifecycleState.UNCONFIGURED)


class Demands:
    """Demands of the modes of one model; each is worked out once, when it is asked for."""

    def __init__(self, model: SmhModel) -> None:
        self._model = model
        self._known: dict[tuple[PartName, StateAndMode, PartName], _Pairs] = {}
        self._steps = 0

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
        if part not in above or self._steps > MAX_STEPS:
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
        self._steps += 1 + len(wanted)
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
