"""Puts targets in force instead of others, and takes them back: events, changes, what is kept."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from domain.changes.changing import Changing
from domain.changes.plan import ChangeGoal
from domain.changes.pursuit import request_towards
from domain.events.targets import (
    DisplacementBegan,
    DisplacementEnded,
    DisplacementStays,
)
from domain.findings import Blocker
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest, Restored
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.parts.targets import OF_REACTIONS, Displacement
from domain.reactions.displacer import Displacer
from domain.reactions.kept_displacements import KeptDisplacements
from domain.snapshot import Because
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant


@dataclass(frozen=True, slots=True)
class Way:
    """What leads a part, and those below that inherit, to their targets."""

    request: ChangeRequest
    """What it would be as a request."""
    goal: ChangeGoal
    """Of the parts whose targets in force change."""
    targets: dict[PartName, StateAndMode]
    """Of all parts that inherit."""


@dataclass(frozen=True, slots=True)
class Ground:
    """Why a target is put in force."""

    reason: str
    blockers: tuple[Blocker, ...]
    since: Instant
    cause: int
    """Id of the event with which it began to be so."""


class Displacing:
    """What each rule and each fallback displaces; decides nothing."""

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
        self._kept = KeptDisplacements(parts.model, changing.requests, outbox)
        self._of: dict[Displacer, Displacement] = {}

    def acts(self, displacer: Displacer) -> bool:
        """Tell whether a displacer displaces something, or did until the current request."""
        return displacer in self._of

    def is_ended(self, displacer: Displacer) -> bool:
        """Tell whether a request has ended what was displaced."""
        return self._of[displacer] not in self._parts.displacements

    def prevails(self, displacer: Displacer) -> bool:
        """Tell whether what a displacer set is in force for its own part."""
        return self._parts.prevails(self._of[displacer])

    def restore(
        self,
        restored: Restored,
        because: Because,
        displacers: Iterable[Displacer],
        now: Instant,
    ) -> list[Displacer]:
        """Displace again what an earlier run had displaced; return what does.

        Args:
            restored: What it left.
            because: Of which kind.
            displacers: All of that kind.
            now: The current time; nothing began later.
        """
        found = []
        for displaced, displacer in self._kept.restore(restored.kept, because, displacers, now):
            displaced.blockers = (displacer.cause(self._kept.since(displaced)),)
            self._of[displacer] = displaced
            self._parts.displace(displaced)
            found.append(displacer)
        return found

    # --- what is displaced -----------------------------------------------------------------------

    def way_ahead(self, displacer: Displacer) -> Way:
        """Return what leads to the target of a displacer, where nothing stronger stands."""
        request = self._towards(displacer, displacer.new_target)
        goal = self._changing.admission.goal(request)
        targets = {displacer.system: displacer.new_target, **goal.targets}
        system = displacer.system
        beyond = self._parts.beyond(displacer.because, displacer.strength, besides=system)
        if displacer.because in OF_REACTIONS:
            stays = self._parts.stays_at_rest
            beyond = beyond | {part for part, target in targets.items() if stays(part, target)}
        if beyond:
            goal = ChangeGoal(
                {part: target for part, target in goal.targets.items() if part not in beyond},
                {node: want for node, want in goal.nodes.items() if node not in beyond},
            )
        return Way(request, goal, targets)

    def would_activate(self, way: Way) -> bool:
        """Tell whether a way would activate a node, or might."""
        return self._changing.admission.would_activate(way.goal)

    def guard_ahead(self, displacer: Displacer, way: Way) -> Blocker | None:
        """Return a guard on a way that does not hold; None: all do."""
        blockers = self._changing.admission.guard_blockers(displacer.system, way.goal)
        return blockers[0] if blockers else None

    def displace(
        self,
        displacer: Displacer,
        way: Way,
        ground: Ground,
        now: Instant,
        instead_of: Displacer | None = None,
    ) -> None:
        """Put the target of a displacer in force; `set_out` begins the change that leads there.

        Args:
            displacer: The rule or fallback.
            way: Leads there.
            ground: Why.
            now: The current time.
            instead_of: What displaced the same part so far; None: nothing of this kind.
        """
        system, target = displacer.system, displacer.new_target
        was = self._parts.target(system)
        because, (rule, reaction) = displacer.because, _rule_or_reaction(displacer)
        began = DisplacementBegan(system, target, was, because, rule, ground.reason, reaction)
        self._outbox.begin(now, began, displacer.actor, ground.cause)
        recorded = self._outbox.record_input()
        if instead_of is not None:
            self._parts.end_displacement(self._of[instead_of])
            self._forget(instead_of)
        displaced = Displacement(
            system,
            way.targets,
            because,
            displacer.name,
            recorded,
            ground.blockers,
            displacer.strength,
        )
        self._of[displacer] = displaced
        self._kept.begin(displaced, ground.since)
        self._parts.displace(displaced)

    def set_out(
        self, displacer: Displacer, way: Way, now: Instant, *, is_guarded: bool = True
    ) -> ChangeId:
        """Begin the change that leads to targets that are in force already; return it.

        Args:
            displacer: In whose name.
            way: Leads there.
            now: The current time.
            is_guarded: Whether the guards of the mode of its own part count.
        """
        unguarded = () if is_guarded else (displacer.system,)
        return self._changing.drive(displacer.system, way.request, way.goal, now, unguarded)

    # --- and how that ends -----------------------------------------------------------------------

    def way_back(self, displacer: Displacer) -> Way | None:
        """Return what leads to the targets that the end of a displacement would put in force.

        None: others are in force, none was requested, or it is the same one.
        """
        targets = dict(self._parts.targets_without(self._of[displacer]))
        if all(self._is_in_force(part, target) for part, target in targets.items()):
            return None
        target = targets.get(displacer.system, self._parts.target(displacer.system))
        if not targets or target is None:
            return None
        goal = self._changing.admission.goal_of_targets(targets)
        return Way(self._towards(displacer, target), goal, targets)

    def target_back(self, displacer: Displacer) -> StateAndMode | None:
        """Return the target that the end of a displacement would put in force for its own part.

        None: none was requested, or something else is in force.
        """
        return self._parts.targets_without(self._of[displacer]).get(displacer.system)

    def obstacles(self, way: Way) -> tuple[Blocker, ...]:
        """Return why a request for where a way leads would be rejected, besides ESTOP."""
        blockers = self._changing.admission.blockers_of(way.request, way.goal)
        return tuple(blocker for blocker in blockers if blocker.refuses)

    def take_back(self, displacer: Displacer, way: Way | None, cause: int, now: Instant) -> None:
        """Put what is displaced in force again, and begin the change that leads there.

        Args:
            displacer: The rule or fallback.
            way: Leads there; None: nothing has to move.
            cause: Id of the event with which the cause was gone.
            now: The current time.
        """
        displaced = self._of[displacer]
        ended = self._ended(displacer, displacer.relief, way)
        self._outbox.begin(now, ended, displacer.actor, cause)
        self._outbox.record_input()
        self._parts.end_displacement(displaced)
        self._forget(displacer)
        if way is not None:
            self.set_out(displacer, way, now)

    def end_by_request(self, displacer: Displacer) -> None:
        """Tell that the current input, a request, ended what was displaced."""
        self._outbox.emit(self._ended(displacer, "a newer request"))
        self._forget(displacer)

    def let_stay(self, displacer: Displacer, why: Blocker, cause: int, now: Instant) -> None:
        """Tell that only a request ends what is displaced, and why.

        Args:
            displacer: The rule or fallback.
            why: What keeps the part from returning.
            cause: Id of the event with which the cause was gone.
            now: The current time.
        """
        displaced = self._of[displacer]
        because, (rule, reaction) = displacer.because, _rule_or_reaction(displacer)
        target, system = displaced.target, displacer.system
        stays = DisplacementStays(system, target, because, rule, why.message, reaction)
        self._outbox.begin(now, stays, displacer.actor, cause)
        self._outbox.record_input()
        self._parts.explain(displaced, (why,))

    def keep(self, displacer: Displacer) -> None:
        """Keep which nodes turned out to be elsewhere than where they were led."""
        self._kept.renew(self._of[displacer])

    def explain(self, displacer: Displacer, why: Sequence[Blocker]) -> bool:
        """Show why something is displaced; return whether something else was shown before."""
        return self._parts.explain(self._of[displacer], tuple(why))

    def explain_cause(self, displacer: Displacer) -> bool:
        """Show the cause of a displacement; return whether something else was shown before."""
        return self.explain(displacer, [displacer.cause(self._kept.since(self._of[displacer]))])

    def let_go(self, displacer: Displacer, *, is_over: bool) -> None:
        """Note whether something calls for a displacement; if not, a request may end it."""
        self._of[displacer].is_over = is_over

    # --- inside ----------------------------------------------------------------------------------

    def _ended(
        self, displacer: Displacer, reason: str, way: Way | None = None
    ) -> DisplacementEnded:
        displaced, system = self._of[displacer], displacer.system
        target = self._parts.target(system)
        if way is not None:
            target = way.targets.get(system, target)
        because, (rule, of_reaction) = displacer.because, _rule_or_reaction(displacer)
        was = displaced.target
        return DisplacementEnded(system, target, was, because, rule, reason, of_reaction)

    def _is_in_force(self, part: PartName, target: StateAndMode) -> bool:
        in_force = self._parts.target(part)
        return in_force is not None and in_force.agrees_with(target)

    def _forget(self, displacer: Displacer) -> None:
        self._kept.forget(self._of.pop(displacer))

    def _towards(self, displacer: Displacer, target: StateAndMode) -> ChangeRequest:
        parts = self._parts
        return request_towards(parts.model, parts.facts, displacer.system, target, displacer.actor)


def _rule_or_reaction(displacer: Displacer) -> tuple[str | None, str | None]:
    """Return its name as that of a rule, or of a reaction."""
    if displacer.because in OF_REACTIONS:
        return None, displacer.name
    return displacer.name, None
