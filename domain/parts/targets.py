"""Targets of parts: requested and in force."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from domain.findings import Blocker
from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from domain.snapshot import Because, EffectiveTarget
from domain.state_and_mode import ModeName, PartName, StateAndMode

_RANK = {because: rank for rank, because in enumerate(Because)}
"""Who prevails over whom; among equals, who came later."""

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
    rule: str | None
    """Name of the rule that set it; None: no rule did."""
    cause: int
    """Id of the event that recorded it."""
    blockers: tuple[Blocker, ...] = ()
    """Why it is in force, and why it stays so."""
    shown: _Shown = field(default_factory=dict)
    """One object for all parts with the same target."""

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
    """

    def __init__(self, inference: ModeInference) -> None:
        self._inference = inference
        self._asked: dict[PartName, StateAndMode | None] = {}
        self._displacements: list[Displacement] = []
        """Whoever prevails comes last."""
        self._shared: _Shown = {}
        """One object for all parts with the same requested target."""

    def ask(self, wanted: Mapping[PartName, StateAndMode | None]) -> set[PartName]:
        """Set requested targets, in force at once; return the parts about which that changed more.

        Args:
            wanted: Of the requested part and of those below it; None: the part has none any more.
        """
        self._asked.update(wanted)
        if not self._displacements:
            return self._inference.set_targets(wanted)
        freed: set[PartName] = set()
        for displaced in list(self._displacements):
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
        self._displacements.sort(key=lambda one: _RANK[one.because])
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

    def beyond(self, because: Because) -> set[PartName]:
        """Return the parts whose targets in force nothing of this kind can replace."""
        stronger = [d for d in self._displacements if _RANK[d.because] > _RANK[because]]
        return {part for displaced in stronger for part in displaced.targets}

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

    def asked_of(self, parts: Iterable[PartName]) -> dict[PartName, StateAndMode | None]:
        """Return the requested target of each of several parts."""
        asked = self._asked
        return {part: asked.get(part) for part in parts}

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
            if part in displaced.targets:
                return displaced
        return None

    def _without(self, left_out: Displacement, part: PartName) -> StateAndMode | None:
        for displaced in reversed(self._displacements):
            if displaced is not left_out and part in displaced.targets:
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
            displaced.rule,
            displaced.cause,
            displaced.blockers,
        )
    return shown
