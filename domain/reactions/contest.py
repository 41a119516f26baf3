"""Which of the reactions that something calls for act; everything is decided anew each time."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace

from domain.findings import Blocker
from domain.parts.claims import Claim
from domain.reaction_terms import Action, Arm, ReactionState
from domain.reactions.budgets import Budgets
from domain.reactions.obstacles import OF_ACTIVATION, Obstacles
from domain.reactions.reaction import REACTION, Reaction
from domain.state_and_mode import PartName
from domain.timebase import Instant


@dataclass(frozen=True, slots=True)
class Standing:
    """How a reaction is to stand."""

    state: ReactionState
    kept_from: tuple[Blocker, ...] = ()
    """What keeps it from acting; empty: nothing does."""


@dataclass(slots=True)
class Outcome:
    """What was decided."""

    standings: dict[Reaction, Standing] = field(default_factory=dict)
    """Of all reactions that something calls for, and that are not disarmed."""
    moving: dict[PartName, Reaction] = field(default_factory=dict)
    """By part, the reaction that moves it."""
    claiming: list[Reaction] = field(default_factory=list)
    """Those that keep requests from leading elsewhere, the strongest of each part."""


class Contest:
    """Decides; the stronger action prevails, then who comes first in the file."""

    def __init__(self, obstacles: Obstacles, budgets: Budgets) -> None:
        self._obstacles = obstacles
        self._budgets = budgets

    def decide(
        self, called: Iterable[Reaction], is_exhausted: Callable[[Reaction], bool], now: Instant
    ) -> Outcome:
        """Decide how reactions stand.

        Args:
            called: Those that something calls for.
            is_exhausted: Tells which ones have acted too often, and wait for an acknowledgement.
            now: The current time.
        """
        outcome = Outcome()
        claimed: set[PartName] = set()
        # What acts on a device already comes first.
        for reaction in sorted(called, key=lambda each: (each.elsewhere is None, -each.strength)):
            if reaction.elsewhere is not None:
                self._follow(reaction, outcome)
                claimed.update(own.part for own in outcome.claiming)
                continue
            if reaction.arm is Arm.DISARMED:
                continue
            standing = self._standing(reaction, outcome, is_exhausted, now)
            outcome.standings[reaction] = standing
            if not reaction.may_act or not reaction.declared.action.has_budget:
                continue
            if standing.state is ReactionState.ACTING:
                outcome.moving[reaction.part] = reaction
            if reaction.targets and self._claims(standing) and reaction.part not in claimed:
                claimed.add(reaction.part)
                outcome.claiming.append(reaction)
        return outcome

    @staticmethod
    def _follow(reaction: Reaction, outcome: Outcome) -> None:
        """Let a reaction stand as it does on the device that decides about it."""
        outcome.standings[reaction] = Standing(reaction.reported)
        if reaction.reported is ReactionState.ACTING and reaction.targets:
            outcome.moving[reaction.part] = reaction
            outcome.claiming.append(reaction)

    def _standing(
        self,
        reaction: Reaction,
        outcome: Outcome,
        is_exhausted: Callable[[Reaction], bool],
        now: Instant,
    ) -> Standing:
        if is_exhausted(reaction):
            return Standing(ReactionState.EXHAUSTED)
        is_active = reaction.may_act
        acting = Standing(ReactionState.ACTING if is_active else ReactionState.PASSIVE)
        if not reaction.declared.action.has_budget:
            return acting
        stronger = _stronger(reaction, outcome)
        if stronger is not None:
            why = f"reaction {stronger.name} of {stronger.part} is stronger"
            blocker = Blocker(REACTION, why, (reaction.part, stronger.part), refuses=False)
            return Standing(ReactionState.OVERRULED, (blocker,))
        obstacle = self._obstacles.of(reaction, now)
        if obstacle is not None:
            return Standing(ReactionState.OVERRULED, (obstacle,))
        if not reaction.is_in_effect and self._budgets.is_spent(reaction, now):
            return Standing(ReactionState.EXHAUSTED)
        return acting

    @staticmethod
    def _claims(standing: Standing) -> bool:
        """Tell whether requests may not lead elsewhere: it acts, or only may not activate."""
        if standing.state is ReactionState.ACTING:
            return True
        return any(blocker.code in OF_ACTIVATION for blocker in standing.kept_from)


def _stronger(reaction: Reaction, outcome: Outcome) -> Reaction | None:
    """Return a reaction that moves the part already, by itself or from above; None: none does."""
    part, moving = reaction.part, outcome.moving
    if part in moving:
        return moving[part]
    if reaction.declared.action is Action.RESTART:
        return None  # It leads to whatever target is in force.
    for system in reaction.model.ancestors[part]:
        above = moving.get(system)
        if above is not None and part in above.targets:
            return above
    return None


def claim_of(reaction: Reaction) -> Claim:
    """Return what a reaction wants, with what calls for it now."""
    blocker = replace(reaction.cause(reaction.since), refuses=True)
    return Claim(reaction.part, reaction.targets, blocker)
