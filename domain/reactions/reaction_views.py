"""Reactions as clients see them."""

from collections.abc import Sequence

from domain.findings import Blocker
from domain.outbox import Outbox
from domain.reaction_terms import Arm, ReactionState, Until
from domain.reactions.budgets import Budgets
from domain.reactions.reaction import Reaction
from domain.reactions.reaction_view import ReactionView
from domain.reactions.triggers import Triggers
from domain.timebase import to_seconds


class ReactionViews:
    """One view for each reaction; the same object until it changes."""

    def __init__(
        self,
        reactions: Sequence[Reaction],
        budgets: Budgets,
        triggers: Triggers,
        outbox: Outbox,
    ) -> None:
        self._budgets = budgets
        self._triggers = triggers
        self._outbox = outbox
        self._views: dict[Reaction, ReactionView] = {}
        self._why: dict[Reaction, tuple[Blocker, ...]] = {}
        """What calls for each reaction, or keeps it from acting, as it was shown last."""
        self._by_key = {reaction.key: reaction for reaction in reactions}

    def note(self, reaction: Reaction) -> None:
        """Note that a reaction stands differently."""
        self._views.pop(reaction, None)
        self._outbox.reactions.add(reaction.key)

    def explain(self, reaction: Reaction) -> None:
        """Look at why a reaction stands as it does."""
        why: tuple[Blocker, ...] = ()
        if reaction.state is not ReactionState.IDLE:
            why = (*reaction.kept_from, *reaction.why())
        if why != self._why.get(reaction, ()):
            self._why[reaction] = why
            self.note(reaction)

    def of_key(self, key: str) -> ReactionView:
        """Return the view of a reaction by its name among all."""
        return self.of(self._by_key[key])

    def of(self, reaction: Reaction) -> ReactionView:
        """Return the view of a reaction."""
        view = self._views.get(reaction)
        if view is None:
            view = self._views[reaction] = self._built(reaction)
        return view

    def _built(self, reaction: Reaction) -> ReactionView:
        declared = reaction.declared
        return ReactionView(
            reaction.name,
            reaction.part,
            reaction.arm,
            reaction.state,
            declared.action,
            declared.target,
            reaction.since,
            self._why.get(reaction, ()),
            self._budgets.left(reaction),
            declared.when.text,
            declared.for_,
            declared.until,
            self._waits_for(reaction),
        )

    def _waits_for(self, reaction: Reaction) -> str:
        """Return what has to happen next, in words."""
        declared, when = reaction.declared, reaction.declared.when.text
        match reaction.state:
            case ReactionState.PENDING:
                return f"{when}, for {to_seconds(declared.for_):g} s"
            case ReactionState.OVERRULED:
                return f"an end of: {reaction.kept_from[0].message}"
            case ReactionState.EXHAUSTED:
                return "an acknowledgement"
            case ReactionState.ACTING | ReactionState.PASSIVE:
                is_gone = not self._triggers.has_cause(reaction)
                if is_gone:
                    return "an acknowledgement"
                by = reaction.called_by
                ends = f"an end of: {when if by is None else f'reaction {by.name}'}"
                is_latched = declared.until is Until.ACKNOWLEDGED
                is_seen = self._triggers.is_acknowledged(reaction)
                return f"{ends}, and an acknowledgement" if is_latched and not is_seen else ends
            case _:
                return when if reaction.arm is not Arm.DISARMED else "being armed"
