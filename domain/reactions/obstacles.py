"""What keeps a reaction from moving its part, although something calls for it."""

from domain.changes.changing import Changing
from domain.changes.guards import Guards
from domain.deadlines import Deadlines
from domain.findings import Blocker
from domain.health.health import Health
from domain.health.signals import ESTOP
from domain.lifecycle import LifecycleState
from domain.parts.node_doubts import doubt_of
from domain.parts.parts import Parts
from domain.reaction_terms import Action
from domain.reactions.displacing import Displacing
from domain.reactions.reaction import Reaction
from domain.reactions.returns import RESTART, RESTARTED, STOPPED
from domain.reactions.triggers import Triggers
from domain.timebase import Instant

AT_REST = "AT_REST"
NOT_REQUESTED = "NOT_REQUESTED"
NO_LIFECYCLE = "NO_LIFECYCLE"
BACKEND_UNAVAILABLE = "BACKEND_UNAVAILABLE"

_ACTIVE = LifecycleState.ACTIVE
OF_ACTIVATION = frozenset({ESTOP, RESTART, AT_REST, NOT_REQUESTED, BACKEND_UNAVAILABLE})
"""Codes of what keeps a part where it is; its reaction keeps requests from leading elsewhere."""


class Obstacles:
    """Finds what keeps a reaction from acting.

    A part that nobody asked for anything, or that somebody brought to rest, is not activated.
    """

    def __init__(
        self,
        parts: Parts,
        changing: Changing,
        health: Health,
        guards: Guards,
        displacing: Displacing,
        triggers: Triggers,
    ) -> None:
        self._parts = parts
        self._changing = changing
        self._health = health
        self._guards = guards
        self._displacing = displacing
        self._triggers = triggers
        self.asks_elsewhere = False
        """Whether another computer knows what was requested, so that no target is needed."""
        self.deadlines: Deadlines[Reaction] = Deadlines()
        """When the grace of an invariant of a target ends."""

    def of(self, reaction: Reaction, now: Instant) -> Blocker | None:
        """Return what keeps a reaction from acting, or from going on; None: nothing does."""
        if reaction.declared.action is Action.RESTART:
            return None if reaction.is_in_effect else self._of_restart(reaction)
        if reaction.is_in_effect:
            return self._at_rest(reaction) or self._of_invariants(reaction, now)
        self.deadlines.clear(reaction)
        return self._at_rest(reaction) or self._of_target(reaction)

    # --- a mode or a state -----------------------------------------------------------------------

    def _at_rest(self, reaction: Reaction) -> Blocker | None:
        """Return that a request brought the part to rest, deeper than its target would."""
        part, asked = reaction.part, self._parts.asked(reaction.part)
        if asked is None or not self._parts.stays_at_rest(part, reaction.new_target):
            return None
        return self._blocker(reaction, AT_REST, f"{part} was brought to {asked.label} on request")

    def _of_invariants(self, reaction: Reaction, now: Instant) -> Blocker | None:
        """Return an invariant of the target that is broken for too long."""
        part, target = reaction.part, reaction.new_target
        blocker, due = self._guards.broken_for_too_long((part,), {part: target}, now)
        if due is None:
            self.deadlines.clear(reaction)
        else:
            self.deadlines.set(reaction, due)
        return blocker

    def _of_target(self, reaction: Reaction) -> Blocker | None:
        """Return what keeps the target from being put in force."""
        if not self._changing.is_available:
            why = "the backend is not available"
            return self._blocker(reaction, BACKEND_UNAVAILABLE, why)
        way = self._displacing.way_ahead(reaction)
        asked = self._parts.asked(reaction.part)
        is_activating = (
            reaction.new_target.state is _ACTIVE
            and (asked is None or asked.state is not _ACTIVE)
            and not (asked is None and self.asks_elsewhere)
        )
        if is_activating or self._displacing.would_activate(way):
            blocker = self._of_activation(reaction)
            if blocker is not None:
                return blocker
        return self._displacing.guard_ahead(reaction, way)

    # --- a restart -------------------------------------------------------------------------------

    def _of_restart(self, reaction: Reaction) -> Blocker | None:
        node = reaction.part
        facts, target = self._parts.facts[node], self._parts.target(node)
        if not facts.has_lifecycle:
            why = f"{node} has no lifecycle, and cannot be restarted"
            return self._blocker(reaction, NO_LIFECYCLE, why)
        if facts.known_state is LifecycleState.FINALIZED:
            return doubt_of(node, facts, (node,))
        if not self._changing.is_available:
            why = "the backend is not available"
            return self._blocker(reaction, BACKEND_UNAVAILABLE, why)
        is_activating = target is not None and target.state is _ACTIVE
        if is_activating or self._was_stopped(reaction):
            return self._of_activation(reaction)
        return None

    # --- both ------------------------------------------------------------------------------------

    def _of_activation(self, reaction: Reaction) -> Blocker | None:
        """Return what keeps everything from being activated that nobody requests now."""
        part = reaction.part
        if self._was_stopped(reaction):
            stops = self._health.stop_reasons
            return stops[0] if stops else self._blocker(reaction, ESTOP, STOPPED)
        if self._parts.waits_for_operator(part):
            return self._blocker(reaction, RESTART, RESTARTED)
        above = (part, *self._parts.model.ancestors[part])
        if all(self._parts.asked(each) is None for each in above):
            why = f"nothing was requested of {part}: reactions activate nothing until then"
            return self._blocker(reaction, NOT_REQUESTED, why)
        return None

    def _was_stopped(self, reaction: Reaction) -> bool:
        begun = self._triggers.begun(reaction)
        return self._health.is_stopped or (begun is not None and begun.was_stopped)

    @staticmethod
    def _blocker(reaction: Reaction, code: str, why: str) -> Blocker:
        return Blocker(code, why, (reaction.part,), refuses=False)
