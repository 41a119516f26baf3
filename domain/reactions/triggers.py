"""What calls for reactions: their conditions, escalations, and what nobody has acknowledged."""

from collections.abc import Iterable, Sequence

from domain.conditions.evaluation import Truth
from domain.conditions.tree import TopicKind, comparisons
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.reaction_terms import Arm, Until
from domain.reactions.reaction import Reaction
from domain.reactions.settings import HEARD_WITHIN
from domain.reactions.waits import Wait, Waits
from domain.state_and_mode import PartName
from domain.timebase import Instant


class Triggers:
    """Judges conditions: one calls for a reaction once it was true for a time, until it is false.

    Nodes of which nothing was ever heard count as unknown for some time after a start: that they
    are unreachable then is how each node of each robot begins. As long as other computers may yet
    be heard, no condition is known.
    """

    def __init__(
        self, reactions: Sequence[Reaction], parts: Parts, outbox: Outbox, start: Instant
    ) -> None:
        """Begin without anything that calls for a reaction.

        Args:
            reactions: All of them.
            parts: Tell which nodes were never heard of.
            outbox: Records the inputs with which conditions become true.
            start: The current time.
        """
        self._reactions = reactions
        self._parts = parts
        self._outbox = outbox
        self._heard_by = start + HEARD_WITHIN
        self._unheard = {reaction: _nodes_named(reaction, parts) for reaction in reactions}
        """Nodes on which the condition of a reaction rests, until each was heard of."""
        self._waits: Waits[Reaction] = Waits()
        """Reactions whose condition is true, or was and is unknown."""
        self._latched: set[Reaction] = set()
        """Reactions that acted, and wait for an acknowledgement."""
        self._acknowledged: set[Reaction] = set()
        """Those that were acknowledged while their condition still holds."""

    def begin_anew(self, now: Instant) -> None:
        """Wait again for what is heard of all nodes: the service was restarted."""
        self._heard_by = now + HEARD_WITHIN

    def review(self, now: Instant) -> None:
        """Look at all conditions, and at those that have been true for long enough."""
        for reaction in self._reactions:
            truth = self._truth(reaction, now)
            wait = self._waits.of(reaction)
            holds = truth is Truth.TRUE or (
                truth is Truth.UNKNOWN and wait is not None and wait.is_over
            )
            if holds and wait is None:
                self._acknowledged.discard(reaction)
            lasts, record = reaction.declared.for_, self._outbox.record_input
            self._waits.note(reaction, now, lasts, holds=holds, record=record)
        self._waits.pass_time(now)

    def wake_at(self) -> Instant | None:
        """Return when the next condition has been true for long enough."""
        times = [self._waits.wake_at()]
        if any(self._unheard.values()):
            times.append(self._heard_by)
        return min((at for at in times if at is not None), default=None)

    def pass_time(self, now: Instant) -> bool:
        """Return whether conditions have to be looked at because of the time."""
        due = self.wake_at()
        if now >= self._heard_by:
            self._unheard = {}
        return due is not None and due <= now

    # --- what calls for a reaction ---------------------------------------------------------------

    def calls_for(self, reaction: Reaction) -> bool:
        """Tell whether something calls for a reaction."""
        return self.has_cause(reaction) or (
            reaction in self._latched and reaction not in self._acknowledged
        )

    def has_cause(self, reaction: Reaction) -> bool:
        """Tell whether the condition of a reaction holds, or another one escalates to it."""
        wait = self._waits.of(reaction)
        return reaction.escalated_by is not None or (wait is not None and wait.is_over)

    def pending_since(self, reaction: Reaction) -> Instant | None:
        """Return since when a condition is true that has to be for longer; None: it is not."""
        wait = self._waits.of(reaction)
        return None if wait is None or wait.is_over else wait.since

    def begun(self, reaction: Reaction) -> Wait | None:
        """Return with what the condition began to hold; None: it does not hold."""
        return self._waits.of(reaction)

    # --- what is done about it -------------------------------------------------------------------

    def note_in_effect(self, reaction: Reaction) -> None:
        """Note that a reaction acts, or would if it were active."""
        if reaction.declared.until is Until.ACKNOWLEDGED:
            self._latched.add(reaction)

    def acknowledge(self, reaction: Reaction) -> None:
        """Note that somebody has acknowledged a reaction."""
        if reaction in self._latched:
            self._acknowledged.add(reaction)

    def is_acknowledged(self, reaction: Reaction) -> bool:
        """Tell whether a reaction ends once its condition is no longer true."""
        return reaction in self._acknowledged

    def forget(self, reaction: Reaction) -> None:
        """Forget that a reaction acted, and was acknowledged."""
        self._latched.discard(reaction)
        self._acknowledged.discard(reaction)

    def restore(self, reaction: Reaction, since: Instant, cause: int) -> None:
        """Note that a condition held when an earlier run ended."""
        if reaction.arm is not Arm.DISARMED:
            self._waits.restore(reaction, Wait(since, cause, is_over=True))

    # --- ESTOP -----------------------------------------------------------------------------------

    def follow_stop(self, now: Instant, *, is_stopped: bool) -> None:
        """Note that ESTOP is active, or ends now: nothing is made up for that it prevented."""
        if is_stopped:
            self._waits.stop()
        else:
            self._waits.stop_since(now)

    def note_request(self, parts: Iterable[PartName]) -> None:
        """Note that somebody requested something of parts: what ESTOP prevented is asked anew."""
        asked = set(parts)
        for reaction in self._reactions:
            wait = self._waits.of(reaction)
            if wait is not None and reaction.part in asked:
                wait.was_stopped = False

    # --- inside ----------------------------------------------------------------------------------

    def _truth(self, reaction: Reaction, now: Instant) -> Truth:
        if self._parts.awaits_devices:
            return Truth.UNKNOWN
        truth = reaction.conditions.truth(reaction.declared.when)
        unheard = self._unheard.get(reaction)
        if unheard and now < self._heard_by:
            facts = self._parts.facts
            unheard -= {node for node in unheard if facts[node].reachable}
            return Truth.UNKNOWN if unheard else truth
        return truth


def _nodes_named(reaction: Reaction, parts: Parts) -> set[PartName]:
    """Return the nodes on which the condition of a reaction rests."""
    nodes: set[PartName] = set()
    for leaf in comparisons(reaction.declared.when.root):
        kind, name, part = leaf.subject.topic
        named = PartName(part or name)
        if kind in (TopicKind.PART, TopicKind.ERROR) and named in parts.model:
            nodes.update(parts.model.nodes_below(named))
    return nodes
