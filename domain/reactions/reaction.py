"""One reaction of a part, and how it stands."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from domain.actor import Actor
from domain.changes.plan import targets_of
from domain.computers import ComputerName
from domain.conditions.evaluation import Truth
from domain.conditions.watched import WatchedConditions
from domain.findings import Blocker
from domain.parts.declared_reactions import DeclaredReaction
from domain.parts.system_model import SmhModel
from domain.reaction_terms import HOLD_PREFIX, Arm, ReactionState
from domain.snapshot import Because
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant, to_seconds

REACTION = "REACTION"
"""Code of the blocker that names a reaction, and what calls for it."""
ACKNOWLEDGE = "ACKNOWLEDGE"
"""Code of the blocker that says that only an acknowledgement is missing."""

_MOST = 1_000_000
"""More than a model has reactions."""


@dataclass(eq=False)
class Reaction:
    """A reaction of the model; a displacer like a rule, if its action has a target."""

    declared: DeclaredReaction
    number: int
    """In the order of the file."""
    model: SmhModel
    conditions: WatchedConditions
    """Read only."""
    arm: Arm
    """Whether it may act, as an operator or the model says."""
    is_left: bool = False
    """Acting is left to another computer, so that it only tells when it would act."""
    elsewhere: ComputerName | None = None
    """The device that decides about it, and acts; None: this computer does."""
    reported: ReactionState = ReactionState.IDLE
    """How it stands on that device: idle, acting or exhausted."""
    state: ReactionState = ReactionState.IDLE
    since: Instant | None = None
    """Since when it stands so; None: since the start."""
    kept_from: tuple[Blocker, ...] = ()
    """What keeps it from acting; empty: nothing does."""
    escalated_by: "Reaction | None" = None
    """The reaction that had no effect in time, so that this one is called for."""
    is_exhausted: bool = False
    """It acted too often, and waits for an acknowledgement."""
    event: int = 0
    """Id of the event with which it came to stand so."""

    @property
    def name(self) -> str:
        """Return its name, which is unique in the model."""
        return self.declared.name

    @property
    def key(self) -> str:
        """Return its name among those of all parts, such as `vehicle.LIMP`."""
        return f"{self.part}.{self.name}"

    @property
    def part(self) -> PartName:
        """Return the part that it is declared for."""
        return self.declared.part

    @property
    def may_act(self) -> bool:
        """Tell whether it acts once something calls for it."""
        return self.arm is Arm.ACTIVE and not self.is_left

    @property
    def is_in_effect(self) -> bool:
        """Tell whether it acts, or would if it were active."""
        return self.state in (ReactionState.ACTING, ReactionState.PASSIVE)

    @property
    def called_by(self) -> "Reaction | None":
        """Return the reaction in whose place it is called for; None: its own condition does."""
        is_own = self.conditions.truth(self.declared.when) is not Truth.FALSE
        return None if is_own else self.escalated_by

    @property
    def words(self) -> str:
        """Return what calls for it, in the words of the model file."""
        by = self.called_by
        if by is None:
            return f"{self.part}: {self.declared.when.text}"
        return f"{self.part}: reaction {by.name} had no effect ({by.words})"

    @property
    def hold(self) -> str:
        """Return the name of its hold."""
        return f"{HOLD_PREFIX}{self.name}"

    # --- as a displacer --------------------------------------------------------------------------

    @property
    def because(self) -> Because:
        """Return what kind it is."""
        return Because.REACTION if self.elsewhere is None else Because.LOCAL

    @property
    def system(self) -> PartName:
        """Return the part whose target it replaces; those below inherit."""
        return self.part

    @property
    def new_target(self) -> StateAndMode:
        """Return the target that it puts in force; its action must have one."""
        assert self.declared.target is not None, f"{self.declared.action} has no target"
        return self.declared.target

    @property
    def strength(self) -> int:
        """Return who prevails: the stronger action, then who comes first in the file."""
        return self.declared.action.strength * _MOST - self.number

    @property
    def actor(self) -> Actor:
        """Return in whose name it acts."""
        return Actor(f"reaction:{self.name}")

    @property
    def relief(self) -> str:
        """Return in words why what it replaced may be in force again."""
        return f"reaction {self.name} does not act any more"

    def cause(self, since: Instant | None) -> Blocker:
        """Return what calls for it, as a tree."""
        causes = self.why()
        return Blocker(
            REACTION,
            f"reaction {self.name} of {self.words}",
            (self.part,),
            since=since,
            root_cause=not causes,
            refuses=False,
            causes=causes,
            condition=self.declared.when.text,
        )

    def why(self) -> tuple[Blocker, ...]:
        """Return what calls for it now: its condition, another reaction, or who has yet to see."""
        if self.conditions.truth(self.declared.when) is not Truth.FALSE:
            return self.conditions.explain_true(self.declared.when)
        by = self.escalated_by
        if by is not None and by.declared.escalation is not None:
            after_s = to_seconds(by.declared.escalation.after)
            why = f"reaction {by.name} of {by.part} had no effect within {after_s:g} s"
            return (Blocker(REACTION, why, (by.part,), root_cause=False, causes=by.why()),)
        why = f"its condition is no longer true: {self.declared.when.text}"
        return (Blocker(ACKNOWLEDGE, f"{why}; nobody has acknowledged it", (self.part,)),)

    @cached_property
    def targets(self) -> Mapping[PartName, StateAndMode]:
        """Return what it wants of its part and of all parts below; nothing: it has no target."""
        if self.declared.target is None:
            return {}
        return targets_of(self.model, self.part, self.declared.target)


def reactions_of(
    model: SmhModel,
    conditions: WatchedConditions,
    now: Instant,
    elsewhere: Mapping[str, ComputerName] | None = None,
) -> list[Reaction]:
    """Return the reactions of a model, in the order of the file; their conditions are watched.

    Args:
        model: Declares them.
        conditions: Evaluate the conditions.
        now: The current time.
        elsewhere: By name of a reaction, the device that decides about it; None: there is none.
    """
    declared = [own for of_part in model.reactions.values() for own in of_part.values()]
    conditions.watch((own.when for own in declared), now)
    deciding = elsewhere or {}
    return [
        Reaction(own, number, model, conditions, own.arm, elsewhere=deciding.get(own.name))
        for number, own in enumerate(declared)
    ]
