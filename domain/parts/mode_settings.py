"""How a mode of a part is entered, what it needs, and what replaces it when that breaks."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from domain.conditions.condition import Condition
from domain.state_and_mode import ModeName, PartName
from domain.timebase import Duration, seconds


class OnFailure(StrEnum):
    """What a change does when one of its steps fails or times out."""

    CONTINUE = "continue"
    """The other parts go on."""
    STOP = "stop"
    """No further step begins; steps in flight end."""
    ROLLBACK = "rollback"
    """As `STOP`, then the parts go back to where they were."""


@dataclass(frozen=True, slots=True)
class TransitionSettings:
    """The order in which the parts of a system enter a mode, and what happens on a failure."""

    after: Mapping[PartName, tuple[PartName, ...]] = field(default_factory=dict)
    """The parts that must be done before a part begins; parts that it does not name begin at once.
    A sequence `a, b, c` is `{b: (a,), c: (b,)}`. It has no cycle.
    """
    deadline: Duration | None = None
    """Of the whole change; None: only its steps have deadlines."""
    on_failure: OnFailure = OnFailure.CONTINUE
    followers: Mapping[PartName, tuple[PartName, ...]] = field(
        init=False, compare=False, repr=False
    )
    """The parts that wait for a part: `after` the other way round."""

    def __post_init__(self) -> None:
        """Note who waits for whom, each once."""
        after = {part: tuple(dict.fromkeys(before)) for part, before in self.after.items()}
        followers: dict[PartName, list[PartName]] = {}
        for part, before in after.items():
            for name in before:
                followers.setdefault(name, []).append(part)
        object.__setattr__(self, "after", after)
        object.__setattr__(
            self, "followers", {part: tuple(names) for part, names in followers.items()}
        )


@dataclass(frozen=True, slots=True)
class ModeSettings:
    """Settings of one mode of a part; without any, a mode has the defaults."""

    requires: tuple[Condition, ...] = ()
    """Guards of entering the mode."""
    invariants: tuple[Condition, ...] = ()
    """Guards of entering the mode and of staying in it."""
    grace: Duration = seconds(0)
    """How long an invariant may be broken before it counts."""
    fallback: ModeName | None = None
    """The mode that replaces this one while an invariant is broken."""
    transition: TransitionSettings = field(default_factory=TransitionSettings)

    @property
    def guards(self) -> tuple[Condition, ...]:
        """Return all guards."""
        return (*self.requires, *self.invariants)
