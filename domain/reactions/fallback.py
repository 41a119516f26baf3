"""One mode that replaces others of its part while their invariants are broken."""

from dataclasses import dataclass

from domain.actor import Actor
from domain.changes.guards import INVARIANT
from domain.findings import Blocker
from domain.lifecycle import LifecycleState
from domain.snapshot import Because
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.timebase import Instant


@dataclass(frozen=True)
class Fallback:
    """A fallback of a part; a displacer like a rule of a system."""

    system: PartName
    """The part."""
    mode: ModeName

    @property
    def because(self) -> Because:
        """Return what kind it is."""
        return Because.INVARIANT

    @property
    def name(self) -> None:
        """Return no name: its part and its mode identify it."""
        return None

    @property
    def new_target(self) -> StateAndMode:
        """Return the target that it puts in force."""
        return StateAndMode(LifecycleState.ACTIVE, self.mode)

    @property
    def strength(self) -> int:
        """Return that none is stronger than others: who came later prevails."""
        return 0

    @property
    def actor(self) -> Actor:
        """Return in whose name changes begin that lead there and back."""
        return Actor(f"invariant:{self.system}")

    @property
    def relief(self) -> str:
        """Return in words why what it replaced may be in force again."""
        return "its guards hold again"

    def cause(self, since: Instant) -> Blocker:
        """Return why its target is in force, as far as that is known without asking anything."""
        why = f"{self.system} could not stay in its mode: an invariant was broken"
        return Blocker(INVARIANT, why, (self.system,), since=since, refuses=False)
