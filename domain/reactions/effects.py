"""What reactions do besides moving parts: they tell, hold the task, and stop the robot."""

from collections.abc import Iterable, Iterator

from domain.events.event import Event
from domain.events.reactions import (
    ReactionActing,
    ReactionEnded,
    ReactionExhausted,
    ReactionOverruled,
    ReactionWouldAct,
)
from domain.findings import Blocker
from domain.health.emergency_stop import EmergencyStop
from domain.outbox import Outbox
from domain.reaction_terms import Action, Arm, ReactionState
from domain.reactions.contest import Standing
from domain.reactions.reaction import Reaction
from domain.tasks.driving import Driving
from domain.timebase import Instant, to_seconds


class Effects:
    """Holds of reactions, their stops, and their events."""

    def __init__(self, driving: Driving, emergency_stop: EmergencyStop, outbox: Outbox) -> None:
        self._driving = driving
        self._emergency_stop = emergency_stop
        self._outbox = outbox
        self._holding: set[Reaction] = set()
        self._acting: set[Reaction] = set()
        """Reactions that were told to act, or to act too often."""
        self._stopped: set[Reaction] = set()
        """Reactions that engaged the emergency stop, until they end."""

    def restore(self, reaction: Reaction) -> None:
        """Hold again what a reaction held in an earlier run; the emergency stop is kept itself."""
        action = _action_of(reaction)
        if action is not None or reaction.elsewhere is not None:
            self._acting.add(reaction)
        if action is not None and action.holds:
            self._holding.add(reaction)
            since = reaction.since or 0
            self._driving.restore_hold_of_reaction(reaction.name, reaction.words, since)
        elif action is Action.EMERGENCY_STOP:
            self._stopped.add(reaction)

    def begin(self, reactions: Iterable[Reaction], now: Instant) -> None:
        """Stop the robot and set holds, where reactions do."""
        for reaction in reactions:
            action = _action_of(reaction)
            if action is Action.EMERGENCY_STOP and reaction not in self._stopped:
                self._stopped.add(reaction)
                actor, words = reaction.actor, reaction.words
                self._emergency_stop.engage_for(actor, words, reaction.event, now)
            if action is not None and action.holds and reaction not in self._holding:
                self._holding.add(reaction)
                self._outbox.resume(now, reaction.event, reaction.actor)
                self._driving.hold_for_reaction(reaction.name, reaction.words, now)

    def end(self, reactions: Iterable[Reaction], now: Instant) -> None:
        """Release the holds of reactions that hold no more; a person releases the stop."""
        for reaction in reactions:
            action = _action_of(reaction)
            if reaction in self._stopped and action is not Action.EMERGENCY_STOP:
                self._stopped.discard(reaction)
            if reaction in self._holding and not (action is not None and action.holds):
                self._holding.discard(reaction)
                self._outbox.resume(now, reaction.event, reaction.actor)
                self._driving.release_for_reaction(reaction.name, now)

    def tell(self, reaction: Reaction, standing: Standing, cause: int, now: Instant) -> None:
        """Tell that a reaction is going to stand differently; note the event as its cause.

        Args:
            reaction: As it stood so far.
            standing: How it is to stand.
            cause: Id of the event that led to that.
            now: The current time.
        """
        events = [*self._ends(reaction, standing), *_begins(reaction, standing)]
        for event in events:
            self._outbox.begin(now, event, reaction.actor, cause)
            reaction.event = self._outbox.record_input()

    def _ends(self, reaction: Reaction, standing: Standing) -> Iterator[Event]:
        """Yield that what was told to act does so no more; one that is overruled is told so."""
        is_active = reaction.may_act
        if is_active and standing.state in (ReactionState.ACTING, ReactionState.EXHAUSTED):
            self._acting.add(reaction)
        elif reaction in self._acting:
            self._acting.discard(reaction)
            if standing.state is not ReactionState.OVERRULED:
                part, name, action = reaction.part, reaction.name, reaction.declared.action
                yield ReactionEnded(part, name, action, _end_reason(reaction))


def _begins(reaction: Reaction, standing: Standing) -> Iterator[Event]:
    """Yield what is told of how a reaction is to stand."""
    part, name, action = reaction.part, reaction.name, reaction.declared.action
    is_active = reaction.may_act
    match standing.state:
        case ReactionState.ACTING:
            yield ReactionActing(part, name, action, _words(reaction.why()))
        case ReactionState.PASSIVE:
            yield ReactionWouldAct(part, name, action, _words(reaction.why()))
        case ReactionState.OVERRULED if is_active:
            yield ReactionOverruled(part, name, action, _words(standing.kept_from))
        case ReactionState.EXHAUSTED if is_active:
            budget = reaction.declared.budget
            often = f"it acted {budget.at_most} times in {to_seconds(budget.within):g} s"
            yield ReactionExhausted(part, name, action, reaction.declared.on_exhausted, often)


def _action_of(reaction: Reaction) -> Action | None:
    """Return what a reaction does now; None: nothing."""
    if not reaction.may_act:
        return None
    if reaction.state is ReactionState.ACTING:
        return reaction.declared.action if reaction.elsewhere is None else None
    if reaction.state is ReactionState.EXHAUSTED:
        return reaction.declared.on_exhausted
    return None


def _end_reason(reaction: Reaction) -> str:
    if not reaction.may_act:
        return f"it is {reaction.arm}" if reaction.arm is not Arm.ACTIVE else "another acts"
    if reaction.state is ReactionState.EXHAUSTED:
        return "acknowledged"
    return f"no longer true: {reaction.declared.when.text}"


def _words(blockers: tuple[Blocker, ...]) -> str:
    """Return the leaves of a tree of reasons, in words."""
    leaves: list[str] = []
    waiting = list(reversed(blockers))
    while waiting:
        blocker = waiting.pop()
        is_leaf = not blocker.causes or bool(blocker.path)
        if is_leaf:
            leaves.append(blocker.message)
        else:
            waiting.extend(reversed(blocker.causes))
    return "; ".join(dict.fromkeys(leaves))
