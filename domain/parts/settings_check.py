"""Checks of the settings of modes: what they name exists, and nothing leads back to itself."""

from collections.abc import Collection, Iterator, Mapping
from itertools import chain

from domain.circles import circles, in_words
from domain.findings import Finding
from domain.parts.mode_settings import ModeSettings
from domain.state_and_mode import ModeName, PartName


def check_settings(
    part: PartName,
    settings: Mapping[ModeName, ModeSettings],
    modes: Collection[ModeName],
    parts: Collection[PartName],
) -> Iterator[Finding]:
    """Yield the errors in the settings of a part.

    Args:
        part: The part.
        settings: Its settings by mode; a key that is no mode stands for all that have none.
        modes: The modes of the part.
        parts: The parts of a system; a node has none.
    """
    for mode, of_mode in settings.items():
        place = (part, "mode_settings", mode)
        if of_mode.fallback is not None and of_mode.fallback not in modes:
            message = f"{part} has no mode {of_mode.fallback!r} to fall back to from {mode}"
            yield Finding("error", "UNKNOWN_MODE", message, part, (*place, "fallback"))
        yield from _check_order(part, mode, of_mode.transition.after, parts)
    yield from fallback_circles(part, {mode: own.fallback for mode, own in settings.items()})


def _check_order(
    part: PartName,
    mode: ModeName,
    after: Mapping[PartName, tuple[PartName, ...]],
    parts: Collection[PartName],
) -> Iterator[Finding]:
    place = (part, "mode_settings", mode, "transition", "after")
    for name in dict.fromkeys(chain(after, *after.values())):
        if name not in parts:
            message = f"{name} is not a part of {part}, and has no place in the order of {mode}"
            yield Finding("error", "UNKNOWN_PART", message, part, (*place, name))
    yield from order_circles(part, mode, after)


def order_circles(
    part: PartName, mode: ModeName, after: Mapping[PartName, tuple[PartName, ...]]
) -> Iterator[Finding]:
    """Yield an error for parts that wait for each other."""
    for circle in circles(after):
        message = (
            f"{part} in {mode}: {circle[0]} waits for itself: {in_words(circle, ' after ')}; "
            "none of these could ever begin"
        )
        place = (part, "mode_settings", mode, "transition", "after", circle[-2])
        yield Finding("error", "DAG_CYCLE", message, part, place)


def fallback_circles(
    part: PartName, fallbacks: Mapping[ModeName, ModeName | None]
) -> Iterator[Finding]:
    """Yield an error for modes that fall back to each other.

    Args:
        part: The part.
        fallbacks: The mode that replaces each mode; None: none does.
    """
    edges = {mode: (other,) for mode, other in fallbacks.items() if other is not None}
    for circle in circles(edges):
        message = f"{part}: {circle[0]} falls back to itself: {in_words(circle, ' > ')}"
        place = (part, "mode_settings", circle[-2], "fallback")
        yield Finding("error", "FALLBACK_CIRCLE", message, part, place)
