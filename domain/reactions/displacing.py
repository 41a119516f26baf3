"""Puts the targets of rules in force, and takes them back: events, changes, and what is kept."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from domain.actor import Actor
from domain.changes.changing import Changing
from domain.changes.plan import ChangeGoal
from domain.changes.pursuit import request_towards
from domain.events.targets import (
    DisplacementBegan,
    DisplacementEnded,
    DisplacementStays,
    RuleNotApplied,
)
from domain.findings import Blocker
from domain.inputs import ChangeRequest, Restored
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.parts.targets import Displacement
from domain.reactions.kept_rules import KeptRules
from domain.reactions.rule_watch import RuleWatch
from domain.reactions.waits import Wait
from domain.snapshot import Because
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant

RULE = "RULE"
"""Code of the blocker that names the cause of a displacement."""


@dataclass(frozen=True, slots=True)
class Way:
    """What leads a system, and the parts below that inherit, to their targets."""

    request: ChangeRequest
    """What it would be as a request."""
    goal: ChangeGoal


class Displacing:
    """What each rule displaces; decides nothing."""

    def __init__(self, parts: Parts, changing: Changing, outbox: Outbox) -> None:
        """Begin without a displacement.

        Args:
            parts: Holds the targets.
            changing: Begins the changes that lead to them.
            outbox: Receives events.
        """
        self._parts = parts
        self._changing = changing
        self._outbox = outbox
        self._kept = KeptRules(parts.model, changing.requests, outbox)
        self._of_rule: dict[RuleWatch, Displacement] = {}

    def acts(self, watch: RuleWatch) -> bool:
        """Tell whether a rule displaces something, or did until the current request."""
        return watch in self._of_rule

    def is_ended(self, watch: RuleWatch) -> bool:
        """Tell whether a request has ended what a rule displaced."""
        return self._of_rule[watch] not in self._parts.displacements

    def restore(
        self, restored: Restored, rules: Mapping[tuple[PartName, str], RuleWatch], now: Instant
    ) -> None:
        """Displace again what an earlier run had displaced.

        Args:
            restored: What it left.
            rules: By system and name.
            now: The current time; nothing began later.
        """
        for displaced, watch in self._kept.restore(restored.kept, rules, now):
            displaced.blockers = (_cause(watch, self._kept.since(displaced)),)
            self._of_rule[watch] = displaced
            self._parts.displace(displaced)

    # --- what a rule does ------------------------------------------------------------------------

    def way_ahead(self, watch: RuleWatch) -> Way:
        """Return what leads to the target of a rule."""
        request = self._towards(watch, watch.rule.new_target)
        return Way(request, self._changing.admission.goal(request))

    def would_activate(self, way: Way) -> bool:
        """Tell whether a way would activate a node, or might."""
        return self._changing.admission.would_activate(way.goal)

    def guard_ahead(self, watch: RuleWatch, way: Way) -> Blocker | None:
        """Return a guard on a way that does not hold; None: all do."""
        blockers = self._changing.admission.guard_blockers(watch.system, way.goal)
        return blockers[0] if blockers else None

    def displace(self, watch: RuleWatch, way: Way, wait: Wait, now: Instant) -> None:
        """Put the target of a rule in force, and begin the change that leads there.

        Args:
            watch: The rule.
            way: Leads there.
            wait: For how long the rule has matched.
            now: The current time.
        """
        system, rule = watch.system, watch.rule
        was = self._parts.target(system)
        assert was is not None, "it is the target that the rule replaces"
        began = DisplacementBegan(
            system, rule.new_target, was, Because.RULE, rule.name, watch.reason
        )
        self._outbox.begin(now, began, _actor(watch), wait.cause)
        targets = {system: rule.new_target, **way.goal.targets}
        recorded = self._outbox.record_input()
        displaced = Displacement(system, targets, Because.RULE, rule.name, recorded)
        displaced.blockers = (_cause(watch, wait.since),)
        self._of_rule[watch] = displaced
        self._kept.begin(displaced, wait.since)
        self._parts.displace(displaced)
        self._changing.drive(system, way.request, way.goal, now)

    def refuse(self, watch: RuleWatch, why: str, wait: Wait, now: Instant) -> None:
        """Tell once that a rule is not applied, and why."""
        if wait.is_told:
            return
        wait.is_told = True
        told = RuleNotApplied(watch.system, watch.rule.name, watch.rule.new_target, why)
        self._outbox.begin(now, told, _actor(watch), wait.cause)
        self._outbox.record_input()

    # --- and how that ends -----------------------------------------------------------------------

    def way_back(self, watch: RuleWatch) -> Way | None:
        """Return what leads to the targets that the end of a displacement would put in force.

        None: others are in force, or none was requested.
        """
        targets = self._parts.targets_without(self._of_rule[watch])
        target = targets.get(watch.system, self._parts.target(watch.system))
        if not targets or target is None:
            return None
        goal = self._changing.admission.goal_of_targets(targets)
        return Way(self._towards(watch, target), goal)

    def obstacles(self, way: Way) -> tuple[Blocker, ...]:
        """Return why a request for where a way leads would be rejected, besides ESTOP."""
        blockers = self._changing.admission.blockers_of(way.request, way.goal)
        return tuple(blocker for blocker in blockers if blocker.refuses)

    def take_back(self, watch: RuleWatch, way: Way | None, wait: Wait, now: Instant) -> None:
        """Put what a rule displaces in force again, and begin the change that leads there.

        Args:
            watch: The rule.
            way: Leads there; None: nothing has to move.
            wait: For how long its cause has been gone.
            now: The current time.
        """
        displaced = self._of_rule[watch]
        ended = self._ended(watch, f"no longer true that {watch.reason}", way)
        self._outbox.begin(now, ended, _actor(watch), wait.cause)
        self._outbox.record_input()
        self._parts.end_displacement(displaced)
        self._forget(watch)
        if way is not None:
            self._changing.drive(watch.system, way.request, way.goal, now)

    def end_by_request(self, watch: RuleWatch) -> None:
        """Tell that the current input, a request, ended what a rule displaced."""
        self._outbox.emit(self._ended(watch, "a newer request"))
        self._forget(watch)

    def let_stay(self, watch: RuleWatch, why: Blocker, wait: Wait, now: Instant) -> None:
        """Tell that only a request ends what a rule displaces, and why."""
        displaced = self._of_rule[watch]
        name, target = watch.rule.name, displaced.target
        stays = DisplacementStays(watch.system, target, Because.RULE, name, why.message)
        self._outbox.begin(now, stays, _actor(watch), wait.cause)
        self._outbox.record_input()
        self._parts.explain(displaced, (why,))

    def keep(self, watch: RuleWatch) -> None:
        """Keep which nodes turned out to be elsewhere than where a rule led them."""
        self._kept.renew(self._of_rule[watch])

    def explain(self, watch: RuleWatch, why: Sequence[Blocker]) -> bool:
        """Show why a rule displaces something; return whether something else was shown before."""
        return self._parts.explain(self._of_rule[watch], tuple(why))

    def explain_cause(self, watch: RuleWatch) -> bool:
        """Show the cause of a rule; return whether something else was shown before."""
        return self.explain(watch, [_cause(watch, self._kept.since(self._of_rule[watch]))])

    # --- inside ----------------------------------------------------------------------------------

    def _ended(self, watch: RuleWatch, reason: str, way: Way | None = None) -> DisplacementEnded:
        displaced, system = self._of_rule[watch], watch.system
        target = self._parts.target(system)
        if way is not None:
            target = way.goal.targets.get(system, target)
        name = watch.rule.name
        return DisplacementEnded(system, target, displaced.target, Because.RULE, name, reason)

    def _forget(self, watch: RuleWatch) -> None:
        self._kept.forget(self._of_rule.pop(watch))

    def _towards(self, watch: RuleWatch, target: StateAndMode) -> ChangeRequest:
        parts = self._parts
        return request_towards(parts.model, parts.facts, watch.system, target, _actor(watch))


def _actor(watch: RuleWatch) -> Actor:
    return Actor(f"rule:{watch.rule.name}")


def _cause(watch: RuleWatch, since: Instant) -> Blocker:
    part, pair = watch.rule.if_part
    path = (watch.system, part)
    return Blocker(RULE, watch.reason, path, pair.label, since=since, refuses=False)
