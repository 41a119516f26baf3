"""Parts of which two systems can require different states or modes at the same time."""

from collections import defaultdict
from collections.abc import Iterator, Mapping

from domain.findings import Finding
from domain.parts.lint.warning import meaning, warning
from domain.parts.system_model import SmhModel
from domain.state_and_mode import ModeName, PartName, StateAndMode


def conflicting_systems(model: SmhModel) -> Iterator[Finding]:
    """Yield a warning for each system that can conflict with the first one of a shared part."""
    wants: dict[PartName, dict[PartName, dict[StateAndMode, ModeName]]] = defaultdict(dict)
    for system in model.systems.values():
        for mode, wanted in system.modes.items():
            for part, want in wanted.items():
                wants[part].setdefault(system.name, {}).setdefault(meaning(want), mode)
    for part, by_system in wants.items():
        (first, its), *others = by_system.items()
        for second, other in others:
            pair = _first_conflict(its, other)
            if pair is not None:
                message = (
                    f"{part} belongs to {first} and to {second}, whose requirements can conflict: "
                    f"{first} in {its[pair[0]]} requires {pair[0].label}, {second} in "
                    f"{other[pair[1]]} requires {pair[1].label}"
                )
                path = (second, "modes", other[pair[1]], part)
                yield warning("CONFLICTING_SYSTEMS", message, *path)


def _first_conflict(
    one: Mapping[StateAndMode, ModeName], other: Mapping[StateAndMode, ModeName]
) -> tuple[StateAndMode, StateAndMode] | None:
    for want in one:
        for different in other:
            if want != different:
                return want, different
    return None
