"""Checks of declared errors: what each depends on, and that none depends on itself."""

from collections.abc import Iterator, Mapping

from domain.circles import circles, in_words
from domain.conditions.condition import Condition
from domain.conditions.tree import Topic, TopicKind, comparisons
from domain.findings import Finding
from domain.parts.declared_errors import DeclaredError
from domain.snapshot import ErrorKey
from domain.state_and_mode import PartName

_STATE = ErrorKey(None, "robot.state")
"""Stands for all that follows at once from the state ERROR; it is no error itself."""

_FOLLOWS_FROM_ERROR = frozenset(
    (Topic(TopicKind.ROBOT), Topic(TopicKind.TASK), Topic(TopicKind.HOLD, "error"))
)
"""What changes in the step in which the robot enters ERROR: a task is held, too."""


def named_errors(condition: Condition | None) -> tuple[ErrorKey, ...]:
    """Return the errors that a condition names; None: it is no condition."""
    if condition is None:
        return ()
    topics = (leaf.subject.topic for leaf in comparisons(condition.root))
    found = (
        ErrorKey(PartName(part) if part else None, name)
        for kind, name, part in topics
        if kind is TopicKind.ERROR
    )
    return tuple(dict.fromkeys(found))


def error_circles(
    errors: Mapping[PartName, Mapping[str, DeclaredError]],
) -> Iterator[Finding]:
    """Yield an error for errors that depend on each other, or on the ERROR that they lead to."""
    declared = {
        ErrorKey(part, name): own
        for part, of_part in errors.items()
        for name, own in of_part.items()
    }
    needs: dict[ErrorKey, tuple[ErrorKey, ...]] = {
        key: (*own.caused_by, *_named(own.when), *_named(own.unless))
        for key, own in declared.items()
    }
    needs[_STATE] = tuple(
        key for key, own in declared.items() if own.severity and own.severity.stops_task
    )
    for circle in circles(needs):
        # It begins and ends with the same error; begin with one that the file declares.
        at = next(number for number, key in enumerate(circle) if key in declared)
        turned = (*circle[at:-1], *circle[: at + 1])
        names = in_words([key.name for key in turned], " < ")
        key = turned[0]
        message = f"{key.name} depends on itself: {names}"
        place = _place(key, declared[key], turned[1])
        yield Finding("error", "ERROR_CIRCLE", message, key.part, place)


def _named(condition: Condition | None) -> Iterator[ErrorKey]:
    """Yield what a condition rests on: errors, and what follows from ERROR."""
    yield from named_errors(condition)
    if condition is not None and _rests_on_error(condition):
        yield _STATE


def _rests_on_error(condition: Condition) -> bool:
    return any(leaf.subject.topic in _FOLLOWS_FROM_ERROR for leaf in comparisons(condition.root))


def _place(key: ErrorKey, own: DeclaredError, needed: ErrorKey) -> tuple[str, ...]:
    """Return the keys that lead to the dependency in the file."""
    block = (key.part or "", "errors", key.error)
    if needed in own.caused_by:
        return (*block, "caused_by", needed.name)
    return (*block, "when" if needed in _named(own.when) else "unless")
