"""Targets of parts: requested and in force."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from domain.findings import Blocker
from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from domain.snapshot import Because, EffectiveTarget
from domain.state_and_mode import ModeName, PartName, StateAndMode

_REST = (
    LifecycleState.ACTIVE,
    LifecycleState.INACTIVE,
    LifecycleState.UNCONFIGURED,
    LifecycleState.FINALIZED,
)
"""Primary states, each more at rest than those before it."""

_RANK = {because: rank for rank, because in enumerate(Because)}
"""Who prevails over whom; among equals, who came later."""

OF_REACTIONS = frozenset({Because.REACTION, Because.LOCAL})
"""What reactions set, wherever they act."""

_Shown = dict[tuple[LifecycleState, ModeName | None], EffectiveTarget]


@dataclass(slots=True, eq=False)
class Displacement:
    """A target that is in force for a system instead of the requested one.

    The parts below inherit what it means for them, except those of which something was requested
    later.
    """

    system: PartName
    targets: dict[PartName, StateAndMode]
    """Of the system and of all parts that inherit."""
    because: Because
    name: str | None
    """Name of the rule or reaction that set it; None: it has none."""
    cause: int
    """Id of the event that recorded it."""
    blockers: tuple[Blocker, ...] = ()
    """Why it is in force, and why it stays so."""
    strength: int = 0
    """Among displacements of one kind, the stronger prevails."""
    is_over: bool = False
    """Nothing calls for it any more, and it stays until its parts may return."""
    shown: _Shown = field(default_factory=dict)
    """One object for all parts with the same target."""

    @property
    def is_firm(self) -> bool:
        """Tell whether no request ends it: a reaction that acts."""
        return self.because in OF_REACTIONS and not self.is_over

    @property
    def rank(self) -> tuple[int, int]:
        """Return who prevails over whom; among equals, who came later."""
        return _RANK[self.because], self.strength

    @property
    def target(self) -> StateAndMode:
        """Return the target of the system."""
        return self.targets[self.system]


class Targets:
    """The only place that sets targets.

    The target of a part is the requested one. The effective target is the one in force, with a
    reason; inference and `converged` use it. Both are the same unless a system is displaced. Who
    prevails is the order of `Because`. A request for a displaced system, or for one that contains
    it, ends the displacement; one for a part below it takes that part, and those below, out of it.

    No request ends what a reaction that acts has set. But a part that was deactivated, cleaned up
    or shut down on request stays at rest, whichever came first: reactions make a robot safer.
    """

    def __init__(self, inference: ModeInference) -> None:
        self._inference = inference
        self._asked: dict[PartName, StateAndMode | None] = {}
        self._displacements: list[Displacement] = []
        """Whoever prevails comes last."""
        self._resting: set[PartName] = set()
        """Parts that a request brought to rest."""
        self._shared: _Shown = {}
        """One object for all parts with the same requested target."""

    def ask(self, wanted: Mapping[PartName, StateAndMode | None]) -> set[PartName]:
        """Set requested targets, in force at once; return the parts about which that changed more.

        Args:
            wanted: Of the requested part and of those below it; None: the part has none any more.
        """
        self._asked.update(wanted)
        self._note_rest(wanted)
        if not self._displacements:
            return self._inference.set_targets(wanted)
        freed: set[PartName] = set()
        for displaced in list(self._displacements):
            if displaced.is_firm:
                continue
            if displaced.system in wanted:
                self._displacements.remove(displaced)
                freed |= displaced.targets.keys()
            else:
                for part in displaced.targets.keys() & wanted.keys():
                    del displaced.targets[part]
        return self._set((*wanted, *(freed - wanted.keys()))) | freed

    def displace(self, displaced: Displacement) -> set[PartName]:
        """Put a displacement in force; return the parts about which that changed something."""
        self._displacements.append(displaced)
        self._displacements.sort(key=lambda one: one.rank)
        return self._set(tuple(displaced.targets)) | displaced.targets.keys()

    def end(self, displaced: Displacement) -> set[PartName]:
        """End a displacement; return the parts about which that changed something."""
        self._displacements.remove(displaced)
        return self._set(tuple(displaced.targets)) | displaced.targets.keys()

    def let_stay(self, part: PartName, target: StateAndMode) -> tuple[set[PartName], bool]:
        """Replace the target in force of a part where it was set.

        Returns:
            The parts about which that changed something; whether it was the requested target.
        """
        displaced = self._prevailing(part)
        if displaced is None:
            self._asked[part] = target
        else:
            displaced.targets[part] = target
        return self._inference.set_targets({part: target}) | {part}, displaced is None

    @property
    def displacements(self) -> Sequence[Displacement]:
        """Return all displacements, those that prevail last; read only."""
        return self._displacements

    def prevails(self, displaced: Displacement) -> bool:
        """Tell whether a displacement decides the target in force of its own part."""
        return self._prevailing(displaced.system) is displaced

    def beyond(
        self, because: Because, strength: int = 0, besides: PartName | None = None
    ) -> set[PartName]:
        """Return the parts whose targets in force nothing of this kind and strength can replace.

        Args:
            because: The kind.
            strength: Among those of this kind.
            besides: A part whose own displacements of this kind do not count: they are replaced.
        """
        rank = (_RANK[because], strength)
        stronger = [
            d
            for d in self._displacements
            if d.rank > rank and not (d.because is because and d.system == besides)
        ]
        return {p for d in stronger for p in d.targets if self._covers(d, p)}

    def stays_at_rest(self, part: PartName, target: StateAndMode) -> bool:
        """Tell whether a request brought a part to rest, deeper than a target would."""
        asked = self._asked.get(part) if part in self._resting else None
        return asked is not None and _depth(asked) > _depth(target)

    def without(self, displaced: Displacement) -> dict[PartName, StateAndMode]:
        """Return the targets that the end of a displacement would put in force, by part."""
        then = {
            part: self._without(displaced, part)
            for part in displaced.targets
            if self._prevailing(part) is displaced
        }
        return {part: target for part, target in then.items() if target is not None}

    def asked(self, part: PartName) -> StateAndMode | None:
        """Return the requested target of a part; None: there is none."""
        return self._asked.get(part)

    def asked_of(self, parts: Collection[PartName]) -> dict[PartName, StateAndMode | None]:
        """Return the requested target of each of several parts."""
        # In bulk: there may be ten thousand.
        return dict(zip(parts, map(self._asked.get, parts), strict=True))

    def effective(self, part: PartName) -> EffectiveTarget | None:
        """Return the target in force of a part, with its reason; None: there is none."""
        displaced = self._prevailing(part)
        if displaced is not None:
            return _shown(displaced, displaced.targets[part])
        target = self._asked.get(part)
        if target is None:
            return None
        key = (target.state, target.mode)
        shared = self._shared.get(key)
        if shared is None:
            effective = EffectiveTarget(target.state, target.mode, Because.REQUESTED)
            shared = self._shared[key] = effective
        return shared

    def _set(self, parts: Sequence[PartName]) -> set[PartName]:
        return self._inference.set_targets({part: self._in_force(part) for part in parts})

    def _in_force(self, part: PartName) -> StateAndMode | None:
        displaced = self._prevailing(part)
        return self._asked.get(part) if displaced is None else displaced.targets[part]

    def _prevailing(self, part: PartName) -> Displacement | None:
        for displaced in reversed(self._displacements):
            if self._covers(displaced, part):
                return displaced
        return None

    def _covers(self, displaced: Displacement, part: PartName) -> bool:
        """Tell whether a displacement sets the target of a part, unless a stronger one does."""
        target = displaced.targets.get(part)
        if target is None:
            return False
        is_of_reaction = displaced.because in OF_REACTIONS
        return not (is_of_reaction and self._resting and self.stays_at_rest(part, target))

    def _note_rest(self, wanted: Mapping[PartName, StateAndMode | None]) -> None:
        """Note which parts a request brings to rest: all that it names, or none."""
        active = LifecycleState.ACTIVE
        if all(target is not None and target.state is not active for target in wanted.values()):
            self._resting.update(wanted)
        elif self._resting:
            self._resting.difference_update(wanted)

    def _without(self, left_out: Displacement, part: PartName) -> StateAndMode | None:
        for displaced in reversed(self._displacements):
            if displaced is not left_out and self._covers(displaced, part):
                return displaced.targets[part]
        return self._asked.get(part)


def _shown(displaced: Displacement, target: StateAndMode) -> EffectiveTarget:
    key = (target.state, target.mode)
    shown = displaced.shown.get(key)
    if shown is None or shown.blockers is not displaced.blockers:
        shown = displaced.shown[key] = EffectiveTarget(
            target.state,
            target.mode,
            displaced.because,
            displaced.name if displaced.because is Because.RULE else None,
            displaced.cause,
            displaced.blockers,
            displaced.name if displaced.because in OF_REACTIONS else None,
        )
    return shown


def _depth(target: StateAndMode) -> int:
    """Return how much at rest a target is, from 0; a transitional state counts as active."""
    return _REST.index(target.state) if target.state in _REST else 0
