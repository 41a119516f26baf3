"""What reactions claim: targets that no request may replace while something calls for them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from domain.findings import Blocker
from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from domain.state_and_mode import PartName, StateAndMode


@dataclass(frozen=True, slots=True)
class Claim:
    """What one reaction wants of its part and of those below."""

    part: PartName
    targets: Mapping[PartName, StateAndMode]
    blocker: Blocker
    """Which reaction, and what calls for it."""


class Claims:
    """The claims of the reactions that something calls for, the strongest of each part."""

    def __init__(self, inference: ModeInference) -> None:
        self._inference = inference
        self._claims: Sequence[Claim] = ()

    def set(self, claims: Sequence[Claim]) -> None:
        """Replace all claims."""
        self._claims = claims

    def against(
        self, part: PartName, targets: Mapping[PartName, StateAndMode]
    ) -> Iterator[Blocker]:
        """Yield why a request may not set some targets, one blocker for each claim.

        Args:
            part: The requested part, with which the paths begin.
            targets: What the request would set.
        """
        for claim in self._claims:
            if any(self._is_against(claim, each, want) for each, want in targets.items()):
                yield replace(claim.blocker, path=self._path(part, claim.part))

    def _is_against(self, claim: Claim, part: PartName, want: StateAndMode) -> bool:
        claimed = claim.targets.get(part)
        if claimed is None or claimed.agrees_with(want):
            return False
        # A node that rests on purpose returns to rest when it reappears.
        in_force = self._inference.target(part)
        is_at_rest = want.state is not LifecycleState.ACTIVE
        return not (is_at_rest and in_force is not None and in_force.agrees_with(want))

    def _path(self, part: PartName, claimed: PartName) -> tuple[PartName, ...]:
        model = self._inference.model
        if part == claimed or part in model.ancestors[claimed]:
            return model.path_down(part, claimed)
        return (part, claimed)
