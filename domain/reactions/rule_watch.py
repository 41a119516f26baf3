"""When one rule of the model matches.

Source: micro-ROS system_modes, `mode_handling.cpp`, of which the comparison of states is kept: a
target without a mode means `__DEFAULT__`.
"""

from dataclasses import dataclass
from functools import cached_property

from domain.actor import Actor
from domain.changes.plan import targets_of
from domain.findings import Blocker
from domain.lifecycle import LifecycleState
from domain.parts.convergence import is_there
from domain.parts.mode_inference import ModeInference
from domain.parts.system_model import Rule
from domain.snapshot import Actual, Because
from domain.state_and_mode import DEFAULT_MODE, PartName, StateAndMode
from domain.timebase import Instant

RULE = "RULE"
"""Code of the blocker that names the cause of a displacement."""


@dataclass(eq=False)
class RuleWatch:
    """One rule of one system, and whether it matches."""

    system: PartName
    rule: Rule
    number: int
    """In the order in which rules act that are due at the same time."""
    inference: ModeInference
    """Read only."""

    @property
    def because(self) -> Because:
        """Return what kind it is."""
        return Because.RULE

    @property
    def new_target(self) -> StateAndMode:
        """Return the target that it puts in force."""
        return self.rule.new_target

    @property
    def strength(self) -> int:
        """Return that none is stronger than others: who came later prevails."""
        return 0

    @property
    def actor(self) -> Actor:
        """Return in whose name changes begin that lead there and back."""
        return Actor(f"rule:{self.name}")

    @property
    def relief(self) -> str:
        """Return in words why what it replaced may be in force again."""
        return f"no longer true that {self.reason}"

    def cause(self, since: Instant) -> Blocker:
        """Return why its target is in force."""
        part, pair = self.rule.if_part
        path = (self.system, part)
        return Blocker(RULE, self.reason, path, pair.label, since=since, refuses=False)

    @property
    def name(self) -> str:
        """Return its name, which is unique in its system."""
        return self.rule.name

    @property
    def part(self) -> PartName:
        """Return the part that causes it."""
        return self.rule.if_part[0]

    @property
    def reason(self) -> str:
        """Return the cause in words."""
        part, pair = self.rule.if_part
        return f"{part} is {pair.label}"

    @property
    def may_act(self) -> bool:
        """Tell whether the rule could ever set a target that a system can be brought to."""
        new = self.rule.new_target
        return new.state.is_primary and not new.agrees_with(self.rule.if_target)

    def matches(self) -> bool:
        """Tell whether the target of the system is that of the rule, and its part deviates."""
        target = self.inference.target(self.system)
        if target is None or not self.rule.if_target.agrees_with(target):
            return False
        return self.has_cause() and self._deviates()

    def has_cause(self) -> bool:
        """Tell whether the part is as the rule says."""
        actual, pair = self._actual, self.rule.if_part[1]
        if actual.state is LifecycleState.UNKNOWN or actual.state is not pair.state:
            return False
        if pair.state is not LifecycleState.ACTIVE:
            return True
        has_modes = bool(self.inference.model.modes_of(self.part))
        return not has_modes or actual.mode == (pair.mode or DEFAULT_MODE)

    def is_cause_gone(self) -> bool:
        """Tell whether the part is otherwise than the rule says; unknown is not gone."""
        return self._actual.state is not LifecycleState.UNKNOWN and not self.has_cause()

    @property
    def _actual(self) -> Actual:
        return self.inference.actual(self.part)

    def _deviates(self) -> bool:
        """Tell whether the part is not where the target of the system wants it.

        Of a part of which that wants nothing, such as one of another system: whether the system
        itself deviates.
        """
        if self._wanted is None:
            return not self.inference.converged(self.system)
        return not is_there(self._actual, self._wanted)

    @cached_property
    def _wanted(self) -> StateAndMode | None:
        """Return what the target of the rule wants of its part; looked up once it is needed."""
        wanted = targets_of(self.inference.model, self.system, self.rule.if_target)
        return wanted.get(self.part)
