"""Checks of reactions: what they name exists, fits their action, and does not undo itself."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import chain

from domain.circles import circles, in_words
from domain.conditions.condition import Condition
from domain.conditions.tree import Comparison, TopicKind, comparisons
from domain.errors import near_match
from domain.findings import Finding
from domain.lifecycle import LifecycleState
from domain.parts.declared_errors import DeclaredError
from domain.parts.declared_reactions import DeclaredReaction
from domain.reaction_terms import HOLD_PREFIX, Action, Until
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

REACTIONS = "reactions"

_OF_PART = ("state", "mode", "converged", "parameters")
"""What an action changes of its own part."""

Errors = Mapping[PartName, Mapping[str, DeclaredError]]


def check_reactions(
    reactions: Iterable[DeclaredReaction],
    modes_of: Mapping[PartName, Collection[ModeName]],
    nodes: Collection[PartName],
    errors: Errors,
) -> Iterator[Finding]:
    """Yield the errors in the reactions of a model.

    Args:
        reactions: All of them, in the order of the file.
        modes_of: The modes of each part of the model.
        nodes: Which of the parts are nodes.
        errors: Errors that the model declares, by part and name.
    """
    known: dict[str, DeclaredReaction] = {}
    for own in reactions:
        first = known.setdefault(own.name, own)
        if first is not own:
            message = f"{own.part} and {first.part} both have a reaction {own.name}"
            yield _error(own, "DUPLICATE_REACTION", message)
    rests = _Rests(errors)
    for own in known.values():
        yield from _check_target(own, modes_of[own.part], own.part in nodes)
        yield from _check_escalation(own, known)
        yield from rests.on_itself(own)
    yield from _circles(known)
    yield from rests.in_circles(known)


def _check_target(
    own: DeclaredReaction, modes: Collection[ModeName], is_node: bool
) -> Iterator[Finding]:
    """Check that the action can be done to the part."""
    where, target = f"reaction {own.name} of {own.part}", own.target
    if own.action is Action.RESTART and not is_node:
        message = f"{where}: only nodes can be restarted, and {own.part} is a system"
        yield _error(own, "INVALID_REACTION", message, "action")
    if target is None:
        if own.action.has_target:
            message = f"{where}: {own.action} needs a target, such as active.SLOW or inactive"
            yield _error(own, "INCOMPLETE_REACTION", message)
    elif not own.action.has_target:
        message = f"{where}: {own.action} has no target; leave it out"
        yield _error(own, "INVALID_REACTION", message, "target")
    else:
        if why := _misfit(own.action, target, own.part, modes):
            yield _error(own, "INVALID_REACTION", f"{where}: {why}", "target")
        elif own.action is Action.MODE and target.mode not in modes:
            near = near_match(str(target.mode), tuple(modes))
            hint = f"did you mean {near}?" if near else f"it has {', '.join(modes)}"
            message = f"{where}: {own.part} has no mode {target.mode!r}; {hint}"
            yield _error(own, "UNKNOWN_MODE", message, "target")


def _misfit(
    action: Action, target: StateAndMode, part: PartName, modes: Collection[ModeName]
) -> str:
    """Return why an action cannot have a target, in words; empty: it can."""
    if not target.state.is_primary:
        return f"no part can stay in {target.state}"
    if action is Action.MODE:
        if not modes:
            return f"{part} has no modes; write action: state"
        if target.state is not LifecycleState.ACTIVE:
            return f"a mode is entered by active.MODE; for {target.state}, write action: state"
    elif target.mode not in (None, DEFAULT_MODE):
        return f"a state has no mode; for {target.label}, write action: mode"
    return ""


def _check_escalation(
    own: DeclaredReaction, known: Mapping[str, DeclaredReaction]
) -> Iterator[Finding]:
    if own.escalation is None or own.escalation.to in known:
        return
    to = own.escalation.to
    near = near_match(to, tuple(known))
    hint = f"; did you mean {near}?" if near else ""
    message = f"reaction {own.name} of {own.part} escalates to {to!r}, which does not exist{hint}"
    yield _error(own, "UNKNOWN_REACTION", message, "escalate_to")


def _circles(known: Mapping[str, DeclaredReaction]) -> Iterator[Finding]:
    """Yield an error for reactions that escalate to each other."""
    edges = {own.name: (own.escalation.to,) for own in known.values() if own.escalation}
    for circle in circles(edges):
        message = f"{circle[0]} escalates to itself: {in_words(circle, ' > ')}"
        yield _error(known[circle[-2]], "REACTION_CIRCLE", message, "escalate_to")


class _Rests:
    """Finds conditions that rest on what reactions do, which would end as soon as it is done."""

    def __init__(self, errors: Errors) -> None:
        self._errors = errors

    def on_itself(self, own: DeclaredReaction) -> Iterator[Finding]:
        """Yield an error if a reaction undoes its own cause."""
        if own.action is Action.TELL or own.until is Until.ACKNOWLEDGED:
            return
        leaf = next((leaf for leaf in self._leaves(own.when) if _is_effect(own, leaf)), None)
        if leaf is not None:
            message = (
                f"reaction {own.name} of {own.part} rests on its own effect: {leaf.subject.text}; "
                "name another cause, or write until: acknowledged"
            )
            yield _error(own, "REACTION_RESTS_ON_ITSELF", message, "when", own.when.text)

    def in_circles(self, known: Mapping[str, DeclaredReaction]) -> Iterator[Finding]:
        """Yield an error for holds of reactions that are set because of each other."""
        holding = {
            own.name: own
            for own in known.values()
            if own.action.holds and own.until is Until.CLEARED
        }
        rest_on = {
            name: tuple(other for other in self._holds(own.when) if other in holding)
            for name, own in holding.items()
        }
        for circle in circles(rest_on):
            if len(set(circle)) == 1:
                continue  # It rests on itself.
            own = known[circle[-2]]
            message = (
                f"reaction {circle[0]} rests on its own effect: {in_words(circle, ' on ')}; name "
                "another cause, or write until: acknowledged"
            )
            yield _error(own, "REACTION_RESTS_ON_ITSELF", message, "when", own.when.text)

    def _holds(self, when: Condition) -> Iterator[str]:
        """Yield the reactions whose holds a condition rests on."""
        for leaf in self._leaves(when):
            kind, name, _ = leaf.subject.topic
            if kind is TopicKind.HOLD and name.startswith(HOLD_PREFIX):
                yield name.removeprefix(HOLD_PREFIX)

    def _leaves(self, when: Condition) -> Iterator[Comparison]:
        """Yield what a condition compares, and what the errors that it names rest on."""
        waiting, seen = [when], {when.text}
        while waiting:
            for leaf in comparisons(waiting.pop().root):
                yield leaf
                for below in self._below(leaf):
                    if below.text not in seen:
                        seen.add(below.text)
                        waiting.append(below)

    def _below(self, leaf: Comparison) -> Iterator[Condition]:
        """Yield the conditions of an error, and those of its causes."""
        kind, name, part = leaf.subject.topic
        if kind is not TopicKind.ERROR or not part:
            return
        waiting, seen = [(PartName(part), name)], {(PartName(part), name)}
        while waiting:
            whose, error = waiting.pop()
            own = self._errors.get(whose, {}).get(error)
            if own is None:
                continue
            if own.when is not None:
                yield own.when
                continue  # Causes only explain an error that is detected.
            if own.unless is not None:
                yield own.unless
            for cause in own.caused_by:
                if cause.part is not None and (key := (cause.part, cause.error)) not in seen:
                    seen.add(key)
                    waiting.append(key)


def _is_effect(own: DeclaredReaction, leaf: Comparison) -> bool:
    """Tell whether a reaction changes what a comparison looks at."""
    kind, name, _ = leaf.subject.topic
    match kind:
        case TopicKind.PART:
            is_moved = own.action.has_budget and name == own.part
            return is_moved and leaf.subject.attribute in _OF_PART
        case TopicKind.HOLD:
            return name == f"{HOLD_PREFIX}{own.name}"
        case TopicKind.ROBOT:
            return True
        case TopicKind.TASK:
            return leaf.subject.attribute == "status"
        case _:
            return False


def _error(own: DeclaredReaction, code: str, message: str, *keys: str) -> Finding:
    return Finding("error", code, message, own.part, (own.part, REACTIONS, own.name, *keys))


def all_reactions(
    by_part: Mapping[PartName, Mapping[str, DeclaredReaction]],
) -> Iterator[DeclaredReaction]:
    """Yield all reactions in their order."""
    return chain.from_iterable(own.values() for own in by_part.values())
