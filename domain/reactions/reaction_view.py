"""One reaction as a view: a plain, frozen value."""

from dataclasses import dataclass

from domain.findings import Blocker
from domain.reaction_terms import Action, Arm, ReactionState, Until
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Duration, Instant


@dataclass(frozen=True, slots=True)
class ReactionView:
    """One reaction of a part."""

    reaction: str
    part: PartName
    arm: Arm
    state: ReactionState
    action: Action
    target: StateAndMode | None
    since: Instant | None
    """Since when it stands so; None: since the start."""
    blockers: tuple[Blocker, ...]
    """What calls for it, or what keeps it from acting."""
    left: int | None
    """How often it may act before its budget is used up; None: at any time."""
    when: str
    """Its condition."""
    lasts: Duration
    """How long its condition has to be true."""
    until: Until
    waits_for: str
    """What has to happen next, in words."""

    @property
    def name(self) -> str:
        """Return its name among those of all parts, such as `vehicle.LIMP`."""
        return f"{self.part}.{self.reaction}"
