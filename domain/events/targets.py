"""Events of targets in force that differ from the requested ones."""

from dataclasses import dataclass

from domain.events.event import Event, because
from domain.snapshot import Because
from domain.state_and_mode import PartName, StateAndMode


@dataclass(frozen=True, slots=True)
class DisplacementBegan(Event):
    """Another target than the requested one is in force for a system."""

    kind = "target.displacement_began"
    optional = frozenset({"reaction"})

    part: PartName
    target: StateAndMode
    was: StateAndMode | None
    because: Because
    rule: str | None
    reason: str
    reaction: str | None = None

    def _words(self) -> str:
        instead = f" instead of {self.was.label}" if self.was else ""
        setter = _setter(self.because, self.rule or self.reaction)
        return because(f"{self.part}: {setter} sets {self.target.label}{instead}", self.reason)


@dataclass(frozen=True, slots=True)
class DisplacementEnded(Event):
    """What a displacement replaced is in force again, or a request replaced both."""

    kind = "target.displacement_ended"
    optional = frozenset({"reaction"})

    part: PartName
    target: StateAndMode | None
    was: StateAndMode
    because: Because
    rule: str | None
    reason: str
    reaction: str | None = None

    def _words(self) -> str:
        now = self.target.label if self.target else "no target"
        what = f"{self.was.label} of {_setter(self.because, self.rule or self.reaction)}"
        return because(f"{self.part}: {now} replaces {what}", self.reason)


@dataclass(frozen=True, slots=True)
class DisplacementStays(Event):
    """The cause of a displacement is gone, and the displacement stays until a request ends it."""

    kind = "target.displacement_stays"
    optional = frozenset({"reaction"})

    part: PartName
    target: StateAndMode
    because: Because
    rule: str | None
    reason: str
    reaction: str | None = None

    def _words(self) -> str:
        setter = _setter(self.because, self.rule or self.reaction)
        return because(f"{self.part} stays {self.target.label} after {setter}", self.reason)


@dataclass(frozen=True, slots=True)
class RuleNotApplied(Event):
    """A rule matches and is not applied, for a reason."""

    kind = "rule.not_applied"

    part: PartName
    rule: str
    target: StateAndMode
    reason: str

    def _words(self) -> str:
        words = f"{self.part}: rule {self.rule} does not set {self.target.label}"
        return because(words, self.reason)


def _setter(kind: Because, name: str | None) -> str:
    """Return who set a target, as in "rule slow_down"."""
    if kind is Because.LOCAL:
        return f"reaction {name}, on its device,"
    return "a broken invariant" if kind is Because.INVARIANT else f"{kind} {name}"
