"""The words of reactions: what one does, whether it may, how long, and how it stands."""

from enum import StrEnum

HOLD_PREFIX = "reaction:"
"""Of the name of the hold that a reaction sets."""


class Action(StrEnum):
    """What a reaction does, the weakest first."""

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


class ReactionState(StrEnum):
    """How a reaction stands."""

    IDLE = "idle"
    """Nothing calls for it."""
    PENDING = "pending"
    """Its condition is true, and not yet for long enough."""
    ACTING = "acting"
    OVERRULED = "overruled"
    """Something calls for it, and something else keeps it from acting."""
    EXHAUSTED = "exhausted"
    """It acted too often, and waits for an acknowledgement."""
    PASSIVE = "passive"
    """It would act if it were active."""
