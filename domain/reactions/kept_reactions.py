"""How reactions stand, kept over a restart."""

from collections.abc import Iterator, Mapping

from domain.events.service import NotRestored
from domain.inputs import Restored
from domain.kept import KeptReaction
from domain.outbox import Outbox
from domain.reaction_terms import ReactionState
from domain.reactions.budgets import Budgets
from domain.reactions.escalations import Escalations
from domain.reactions.reaction import Reaction
from domain.reactions.triggers import Triggers
from domain.timebase import Instant

_KEPT_STATES = (ReactionState.ACTING, ReactionState.PASSIVE, ReactionState.EXHAUSTED)


class KeptReactions:
    """What is kept of each reaction; of one that is as the model says and idle, nothing."""

    def __init__(
        self,
        by_name: Mapping[str, Reaction],
        triggers: Triggers,
        budgets: Budgets,
        escalations: Escalations,
        outbox: Outbox,
    ) -> None:
        self._by_name = by_name
        self._triggers = triggers
        self._budgets = budgets
        self._escalations = escalations
        self._outbox = outbox
        self._kept: dict[str, tuple[object, ...]] = {}
        """By reaction, what the value that is kept was made of."""

    def renew(self, reaction: Reaction, now: Instant) -> None:
        """Keep a reaction as it stands now, if that is not kept already."""
        ages = self._budgets.ages(reaction, now)
        value = self._value(reaction)
        made_of = (value, *(now - age for age in ages))
        if value == KeptReaction(reaction.part, reaction.name) and not ages:
            if self._kept.pop(reaction.name, None) is not None:
                self._outbox.forget(KeptReaction, reaction.name)
        elif self._kept.get(reaction.name) != made_of:
            self._kept[reaction.name] = made_of
            self._outbox.keep(self._value(reaction, ages))

    def restore(self, restored: Restored, now: Instant) -> Iterator[Reaction]:
        """Let reactions stand as an earlier run left them; yield those that do not stand idle.

        Those that the model no longer has are left out, and told.
        """
        for kept in restored.kept:
            if not isinstance(kept, KeptReaction):
                continue
            reaction = self._by_name.get(kept.reaction)
            if reaction is None or reaction.part != kept.part:
                self._outbox.forget(KeptReaction, kept.name)
                what = f"the reaction {kept.reaction} of {kept.part}"
                self._outbox.emit(NotRestored(what, "the model has no such reaction"))
                continue
            reaction.arm = kept.arm or reaction.declared.arm
            self._budgets.restore(reaction, kept.used, now)
            if kept.since is not None:
                self._restore(reaction, kept, min(kept.since, now))
            self._kept[reaction.name] = ()
            yield reaction

    def _restore(self, reaction: Reaction, kept: KeptReaction, since: Instant) -> None:
        is_active = reaction.may_act
        state = ReactionState.ACTING if is_active else ReactionState.PASSIVE
        reaction.state = ReactionState.EXHAUSTED if kept.is_exhausted else state
        reaction.is_exhausted = kept.is_exhausted
        reaction.since = since
        reaction.event = self._outbox.record_input()
        self._triggers.restore(reaction, since, reaction.event)
        if reaction.is_in_effect:
            self._triggers.note_in_effect(reaction)
        if kept.is_acknowledged:
            self._triggers.acknowledge(reaction)
        if kept.escalated:
            self._escalations.restore(reaction)

    def _value(self, reaction: Reaction, used: tuple[int, ...] = ()) -> KeptReaction:
        is_of_model = reaction.arm is reaction.declared.arm
        return KeptReaction(
            reaction.part,
            reaction.name,
            None if is_of_model else reaction.arm,
            reaction.since if reaction.state in _KEPT_STATES else None,
            reaction.state is ReactionState.EXHAUSTED,
            self._triggers.is_acknowledged(reaction),
            self._escalations.has_escalated(reaction),
            used,
        )
