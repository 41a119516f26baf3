"""Events of reactions of parts."""

from dataclasses import dataclass

from domain.events.event import Event, because
from domain.reaction_terms import Action, Arm, ReactionState
from domain.state_and_mode import PartName


@dataclass(frozen=True, slots=True)
class ReactionReported(Event):
    """A device tells how a reaction stands that it decides about."""

    kind = "reaction.reported"
    is_input = True
    is_notable = False

    part: PartName
    reaction: str
    state: ReactionState

    def _words(self) -> str:
        return f"the device of {self.part} tells that reaction {self.reaction} is {self.state}"


@dataclass(frozen=True, slots=True)
class ReactionActing(Event):
    """A reaction begins to act."""

    kind = "reaction.acting"

    part: PartName
    reaction: str
    action: Action
    reason: str

    def _words(self) -> str:
        return because(f"reaction {self.reaction} of {self.part}: {self.action}", self.reason)


@dataclass(frozen=True, slots=True)
class ReactionEnded(Event):
    """A reaction does not act any more, since nothing calls for it, or it may not."""

    kind = "reaction.ended"

    part: PartName
    reaction: str
    action: Action
    reason: str

    def _words(self) -> str:
        return because(f"reaction {self.reaction} of {self.part} has ended", self.reason)


@dataclass(frozen=True, slots=True)
class ReactionWouldAct(Event):
    """A passive reaction would begin to act."""

    kind = "reaction.would_act"

    part: PartName
    reaction: str
    action: Action
    reason: str

    def _words(self) -> str:
        would = f"reaction {self.reaction} of {self.part} would act ({self.action}) and is passive"
        return because(would, self.reason)


@dataclass(frozen=True, slots=True)
class ReactionOverruled(Event):
    """Something calls for a reaction, and something else keeps it from acting."""

    kind = "reaction.overruled"

    part: PartName
    reaction: str
    action: Action
    reason: str

    def _words(self) -> str:
        return because(f"reaction {self.reaction} of {self.part} is overruled", self.reason)


@dataclass(frozen=True, slots=True)
class ReactionExhausted(Event):
    """A reaction would act more often than it may."""

    kind = "reaction.exhausted"

    part: PartName
    reaction: str
    action: Action
    instead: Action
    """What it does until somebody acknowledges it."""
    reason: str

    def _words(self) -> str:
        words = f"reaction {self.reaction} of {self.part} acts no more: {self.instead} instead"
        return because(words, self.reason)


@dataclass(frozen=True, slots=True)
class ReactionArmRequested(Event):
    """A request to let a reaction act, only tell, or neither."""

    kind = "reaction.arm_requested"
    is_input = True

    part: PartName
    reaction: str
    arm: Arm
    reason: str

    def _words(self) -> str:
        return because(f"reaction {self.reaction} of {self.part} is now {self.arm}", self.reason)


@dataclass(frozen=True, slots=True)
class ReactionAcknowledged(Event):
    """A request to acknowledge a reaction."""

    kind = "reaction.acknowledged"
    is_input = True

    part: PartName
    reaction: str

    def _words(self) -> str:
        return f"reaction {self.reaction} of {self.part} acknowledged"
