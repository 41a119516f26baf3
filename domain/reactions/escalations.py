"""What follows when reactions do not have their effect in time."""

from collections.abc import Mapping

from domain.deadlines import Deadlines
from domain.parts.parts import Parts
from domain.reaction_terms import Action
from domain.reactions.reaction import Reaction
from domain.reactions.restarts import Restarts
from domain.snapshot import TaskStatus
from domain.tasks.driving import Driving
from domain.timebase import Instant


class Escalations:
    """Calls for another reaction while something calls for one that had no effect in time."""

    def __init__(
        self, by_name: Mapping[str, Reaction], parts: Parts, driving: Driving, restarts: Restarts
    ) -> None:
        """Begin without an escalation.

        Args:
            by_name: All reactions.
            parts: Tell whether a part is where it should be.
            driving: Tells whether the vehicle stands.
            restarts: Tell whether a node is back.
        """
        self._by_name = by_name
        self._parts = parts
        self._driving = driving
        self._restarts = restarts
        self._deadlines: Deadlines[Reaction] = Deadlines()
        """By when those that act must have their effect."""
        self._unverified: set[Reaction] = set()
        """Those that act, and of which no effect was seen yet."""
        self._escalated: dict[Reaction, None] = {}

    @property
    def awaited(self) -> bool:
        """Tell whether the effect of a reaction is awaited."""
        return bool(self._unverified)

    def has_escalated(self, reaction: Reaction) -> bool:
        """Tell whether a reaction had no effect in time."""
        return reaction in self._escalated

    def begin(self, reaction: Reaction, now: Instant) -> None:
        """Await the effect of a reaction that begins to act."""
        if reaction.declared.escalation is not None and reaction not in self._escalated:
            self._unverified.add(reaction)
            self._deadlines.set(reaction, now + reaction.declared.escalation.after)

    def end(self, reaction: Reaction) -> None:
        """Await no effect of a reaction that acts no more."""
        self._unverified.discard(reaction)
        self._deadlines.clear(reaction)

    def withdraw(self, reaction: Reaction) -> bool:
        """Take back the escalation of a reaction that nothing calls for; tell whether it had."""
        if reaction not in self._escalated:
            return False
        del self._escalated[reaction]
        target = self._target(reaction)
        others = (each for each in self._escalated if self._target(each) is target)
        target.escalated_by = next(others, None)
        return True

    def restore(self, reaction: Reaction) -> None:
        """Escalate as an earlier run had done."""
        if reaction.declared.escalation is not None:
            self._escalate(reaction)

    def wake_at(self) -> Instant | None:
        """Return by when the next effect must be seen."""
        return self._deadlines.next()

    def judge(self, now: Instant) -> list[Reaction]:
        """Note which effects are there; escalate what is late, and return it."""
        for reaction in [each for each in self._unverified if self._is_verified(each)]:
            self.end(reaction)
        escalated = []
        while (late := self._deadlines.pop_due(now)) is not None:
            self._unverified.discard(late)
            self._escalate(late)
            escalated.append(late)
        return escalated

    def _escalate(self, reaction: Reaction) -> None:
        self._escalated[reaction] = None
        self._target(reaction).escalated_by = reaction

    def _target(self, reaction: Reaction) -> Reaction:
        assert reaction.declared.escalation is not None
        return self._by_name[reaction.declared.escalation.to]

    def _is_verified(self, reaction: Reaction) -> bool:
        """Tell whether the effect of a reaction is there; of one that only tells, it never is."""
        match reaction.declared.action:
            case Action.MODE | Action.STATE:
                return self._parts.inference.converged(reaction.part)
            case Action.RESTART:
                return self._restarts.is_done(reaction)
            case Action.TELL:
                return False
            case _:
                watch = self._driving.watch
                is_driven = self._driving.status is TaskStatus.RUNNING_TASK
                return not is_driven and (watch.state is None or watch.stands)
