"""Reactions that a model file declares for a part: what the robot does while something is so."""

from dataclasses import dataclass

from domain.conditions.condition import Condition
from domain.reaction_terms import Action, Arm, Until
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Duration, seconds


@dataclass(frozen=True, slots=True)
class Budget:
    """How often a reaction may act."""

    at_most: int = 3
    within: Duration = seconds(60)


@dataclass(frozen=True, slots=True)
class Escalation:
    """What follows if a reaction does not have its effect in time."""

    after: Duration
    to: str
    """Name of another reaction."""


@dataclass(frozen=True, slots=True)
class DeclaredReaction:
    """One reaction of a part; its name is unique in the model."""

    name: str
    part: PartName
    when: Condition
    action: Action
    for_: Duration = 0
    """How long `when` has to be true before it acts."""
    target: StateAndMode | None = None
    """Of the part, for `MODE` and `STATE`; None: the action has none."""
    until: Until = Until.CLEARED
    arm: Arm = Arm.ACTIVE
    """Whether it may act until an operator says otherwise."""
    budget: Budget = Budget()
    """For `MODE`, `STATE` and `RESTART`; the others may act at any time."""
    on_exhausted: Action = Action.HOLD
    """What it does instead once its budget is used up, until it is acknowledged."""
    escalation: Escalation | None = None
