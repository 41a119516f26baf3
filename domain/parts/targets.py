"""What is wanted of parts: what was asked of each, what is pursued instead, and why."""

from collections.abc import Mapping

from domain.parts.mode_inference import ModeInference
from domain.snapshot import EffectiveTarget
from domain.state_and_mode import PartName, StateAndMode

REQUESTED = "requested"
"""Why a target is pursued: somebody asked for it."""


class Targets:
    """The only place that sets a target.

    The target of a part is what somebody asked of it. The effective one is pursued, and says why;
    inference and `converged` go by it.
    """

    def __init__(self, inference: ModeInference) -> None:
        self._inference = inference
        self._asked: dict[PartName, StateAndMode] = {}
        self._effective: dict[PartName, EffectiveTarget] = {}

    def ask(self, wanted: Mapping[PartName, StateAndMode]) -> set[PartName]:
        """Record what somebody asks of parts, and pursue it; return whose actual differs now."""
        for part, target in wanted.items():
            self._asked[part] = target
            self._effective[part] = EffectiveTarget(target.state, target.mode, REQUESTED)
        return self._inference.set_targets(wanted)

    def asked(self, part: PartName) -> StateAndMode | None:
        """Return what was asked of a part; None: nothing."""
        return self._asked.get(part)

    def effective(self, part: PartName) -> EffectiveTarget | None:
        """Return what is pursued for a part, and why; None: nothing."""
        return self._effective.get(part)
