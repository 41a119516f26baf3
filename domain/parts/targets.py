"""Targets of parts: requested and in force."""

from collections.abc import Mapping

from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from domain.snapshot import EffectiveTarget
from domain.state_and_mode import ModeName, PartName, StateAndMode

REQUESTED = "requested"
"""Reason of a target in force that was requested."""


class Targets:
    """The only place that sets targets.

    The target of a part is the requested one. The effective target is the one in force, with a
    reason; inference and `converged` use it.
    """

    def __init__(self, inference: ModeInference) -> None:
        self._inference = inference
        self._asked: dict[PartName, StateAndMode | None] = {}
        self._shared: dict[tuple[LifecycleState, ModeName | None], EffectiveTarget] = {}
        """One object for all parts with the same target."""

    def ask(self, wanted: Mapping[PartName, StateAndMode | None]) -> set[PartName]:
        """Set requested targets, in force at once; return the parts whose actual changed.

        Args:
            wanted: By part; None: the part has no target any more.
        """
        self._asked.update(wanted)
        return self._inference.set_targets(wanted)

    def asked(self, part: PartName) -> StateAndMode | None:
        """Return the requested target of a part; None: there is none."""
        return self._asked.get(part)

    def effective(self, part: PartName) -> EffectiveTarget | None:
        """Return the target in force of a part, with its reason; None: there is none."""
        target = self._asked.get(part)
        if target is None:
            return None
        key = (target.state, target.mode)
        shared = self._shared.get(key)
        if shared is None:
            shared = self._shared[key] = EffectiveTarget(target.state, target.mode, REQUESTED)
        return shared
