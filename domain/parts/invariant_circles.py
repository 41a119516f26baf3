"""Invariants that rest on whether an invariant is broken: theirs, directly or through others."""

from collections.abc import Iterator, Mapping
from itertools import pairwise

from domain.circles import circles, in_words
from domain.conditions.condition import Condition
from domain.conditions.tree import TopicKind, comparisons
from domain.findings import Finding
from domain.parts.declared_errors import DeclaredError
from domain.parts.mode_settings import ModeSettings
from domain.snapshot import ErrorKey
from domain.state_and_mode import ModeName, PartName

_BROKEN = "INVARIANT_BROKEN"


def invariant_circles(
    settings: Mapping[PartName, Mapping[ModeName, ModeSettings]],
    errors: Mapping[PartName, Mapping[str, DeclaredError]],
) -> Iterator[Finding]:
    """Yield an error for invariants whose being broken breaks or mends them.

    They would never come to rest, or never hold again. A circle counts in whatever modes the
    invariants are: the parts may be in these modes at the same time.

    Args:
        settings: Of the modes of each part.
        errors: What the model declares; a circle may lead through them.
    """
    places: dict[tuple[ErrorKey, ErrorKey], tuple[str, ...]] = {}
    rests_on: dict[ErrorKey, list[ErrorKey]] = {}
    for part, modes in settings.items():
        for mode, own in modes.items():
            for invariant in own.invariants:
                for named in _errors_in(invariant):
                    link = (ErrorKey(part, _BROKEN), named)
                    place = (part, "mode_settings", mode, "invariants", invariant.text)
                    if link not in places:
                        places[link] = place
                        rests_on.setdefault(link[0], []).append(named)
    if not places:
        return
    for part, declared in errors.items():
        for name, error in declared.items():
            rests_on.setdefault(ErrorKey(part, name), []).extend(_causes_of(error))
    for circle in circles(rests_on):
        found = [places[link] for link in pairwise(circle) if link in places]
        if found:
            words = in_words([key.name for key in circle], " > ")
            message = f"invariants of {found[0][0]} rest on their own being broken: {words}"
            yield Finding("error", "INVARIANT_CIRCLE", message, found[0][0], found[0])


def _causes_of(error: DeclaredError) -> Iterator[ErrorKey]:
    yield from error.caused_by
    for condition in (error.when, error.unless):
        if condition is not None:
            yield from _errors_in(condition)


def _errors_in(condition: Condition) -> Iterator[ErrorKey]:
    """Yield the errors of parts that a condition names."""
    for leaf in comparisons(condition.root):
        topic = leaf.subject.topic
        if topic.kind is TopicKind.ERROR and topic.part:
            yield ErrorKey(PartName(topic.part), topic.name)
