"""Restarts of nodes: through deactivate, cleanup and configure to their targets in force."""

from dataclasses import dataclass

from domain.changes.changing import Changing
from domain.changes.plan import ChangeGoal
from domain.changes.pursuit import request_towards
from domain.health.health import Health
from domain.identifiers import ChangeId
from domain.inputs import TransitionRequest
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.reactions.reaction import Reaction
from domain.snapshot import ChangeStatus
from domain.state_and_mode import StateAndMode
from domain.timebase import Instant

_UNCONFIGURED = StateAndMode(LifecycleState.UNCONFIGURED)
_INACTIVE = StateAndMode(LifecycleState.INACTIVE)


@dataclass(slots=True)
class _Restart:
    """The restart of one node."""

    change: ChangeId
    cause: int
    is_coming_back: bool = False
    """It is unconfigured, and on its way to its target."""
    is_done: bool = False


class Restarts:
    """One restart for each reaction that acts; once begun, it goes on whatever becomes of that."""

    def __init__(self, parts: Parts, changing: Changing, health: Health, outbox: Outbox) -> None:
        self._parts = parts
        self._changing = changing
        self._health = health
        self._outbox = outbox
        self._restarts: dict[Reaction, _Restart] = {}

    def begin(self, reaction: Reaction, cause: int, now: Instant) -> None:
        """Take the node of a reaction to rest first.

        Args:
            reaction: Its part is a node with a lifecycle.
            cause: Id of the event that tells that it acts.
            now: The current time.
        """
        node = reaction.part
        goal = self._changing.admission.goal_of_targets({node: _UNCONFIGURED})
        request = TransitionRequest(node, Transition.CLEANUP, reaction.actor)
        self._outbox.resume(now, cause, reaction.actor)
        # Its target stays what it is.
        change = self._changing.drive(node, request, ChangeGoal({}, goal.nodes), now)
        self._restarts[reaction] = _Restart(change, cause)

    def is_done(self, reaction: Reaction) -> bool:
        """Tell whether the node of a reaction is back."""
        own = self._restarts.get(reaction)
        return own is not None and own.is_done

    def go_on(self, now: Instant) -> bool:
        """Bring nodes back that are unconfigured; return whether one goes on."""
        has_moved = False
        for reaction, own in list(self._restarts.items()):
            if not own.is_done:
                has_moved |= self._go_on(reaction, own, now)
        return has_moved

    def _go_on(self, reaction: Reaction, own: _Restart, now: Instant) -> bool:
        status = self._changing.change(own.change).status
        if not status.is_final:
            return False
        if status is not ChangeStatus.SUCCEEDED:
            # Somebody asked for something else, or it failed, which is told.
            del self._restarts[reaction]
        elif own.is_coming_back:
            own.is_done = True
        else:
            self._bring_back(reaction, own, now)
        return True

    def _bring_back(self, reaction: Reaction, own: _Restart, now: Instant) -> None:
        node = reaction.part
        target = self._parts.target(node) or _INACTIVE
        model, facts = self._parts.model, self._parts.facts
        request = request_towards(model, facts, node, target, reaction.actor)
        goal = self._changing.admission.goal(request)
        may_not = self._health.is_stopped or self._parts.waits_for_operator(node)
        if may_not and self._changing.admission.would_activate(goal):
            del self._restarts[reaction]
            return
        self._outbox.resume(now, own.cause, reaction.actor)
        own.change = self._changing.drive(node, request, ChangeGoal({}, goal.nodes), now)
        own.is_coming_back = True
