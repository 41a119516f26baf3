"""Reactions that a model file declares for a part: what the robot does while something is so."""

from dataclasses import dataclass
from enum import StrEnum

from domain.conditions.condition import Condition
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Duration, seconds


class Action(StrEnum):
    """What a reaction does."""

    TELL = "tell"
    """An event, and nothing else."""
    MODE = "mode"
    """Sets the mode of its part."""
    STATE = "state"
    """Sets the lifecycle state of its part."""
    RESTART = "restart"
    """Takes a node through deactivate, cleanup and configure to its effective target."""
    HOLD = "hold"
    """Holds the task."""
    STOP = "stop"
    """Commands speed 0, and holds the task."""
    EMERGENCY_STOP = "emergency_stop"
    """Engages the emergency stop, which a person releases."""

    @property
    def has_target(self) -> bool:
        """Tell whether it sets a target of its part."""
        return self in (Action.MODE, Action.STATE)

    @property
    def has_budget(self) -> bool:
        """Tell whether it moves its part, so that a reaction may do it only so often.

        Of several reactions of a part that do, the strongest one acts.
        """
        return self in (Action.MODE, Action.STATE, Action.RESTART)

    @property
    def holds(self) -> bool:
        """Tell whether it keeps tasks from running while it lasts."""
        return self in (Action.HOLD, Action.STOP)

    @property
    def strength(self) -> int:
        """Return its place in the order of strength, from 0."""
        return tuple(Action).index(self)


class Arm(StrEnum):
    """Whether a reaction may act."""

    ACTIVE = "active"
    PASSIVE = "passive"
    """It tells when it would act, and does nothing."""
    DISARMED = "disarmed"


class Until(StrEnum):
    """How long a reaction acts."""

    CLEARED = "cleared"
    """While its condition is true."""
    ACKNOWLEDGED = "acknowledged"
    """Until its condition is no longer true, and an operator has acknowledged it."""


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
