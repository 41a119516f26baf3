"""What is not as it should be with the parts of a robot, in words."""

from collections.abc import Mapping
from typing import Any

from api.cli.monitor import words
from api.cli.monitor.device_words import device_problems, is_away

Json = Mapping[str, Any]

_NAMED = 3
_NO_DEVICES: Mapping[str, Json] = {}


def part_problems(
    parts: Mapping[str, Json], devices: Mapping[str, Json] = _NO_DEVICES
) -> list[str]:
    """Return the first few problems; a system that deviates because of a node is not named.

    Args:
        parts: By name, as in frames.
        devices: By name, as in frames; one that is away stands for all parts of it.
    """
    found: dict[str, str | None] = {}
    # Nodes first: they explain why their systems deviate.
    for part in sorted(parts.values(), key=_is_system):
        problem = _problem_of(part)
        if problem is not None and not (_is_system(part) and _is_explained(part, parts, found)):
            is_told = is_away(devices.get(part.get("device") or ""))
            found[part["name"]] = None if is_told else problem
    every = [problem for problem in dict.fromkeys(found.values()) if problem is not None]
    left = len(every) - _NAMED
    such = "part" if left == 1 else "parts"
    first = every if left <= 0 else [*every[:_NAMED], f"{left} more such {such}"]
    return [*device_problems(devices), *first]


def _is_explained(part: Json, parts: Mapping[str, Json], found: Mapping[str, str | None]) -> bool:
    return any(
        name in found or (name in parts and _is_explained(parts[name], parts, found))
        for name in part.get("parts", ())
    )


def _is_system(part: Json) -> bool:
    return bool(part.get("kind") == "system")


def _problem_of(part: Json) -> str | None:
    name, actual = part["name"], part["actual"]
    if not part.get("reachable", True) and not _is_system(part):
        return f"{name} is unreachable"
    if actual["state"] == "errorprocessing":
        return f"{name} is in errorprocessing"
    target = part.get("effective_target") or part.get("target")
    if part["converged"] or part.get("change") or not target:
        return None
    known = words.label(actual)
    stands = "in an unknown state" if actual["state"] == "unknown" else known
    reason = part.get("deviation_reason")
    return str(reason) if reason else f"{name} is {stands}, target {words.label(target)}"
