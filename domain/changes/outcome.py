"""Why a change ended as it did, in words."""

from collections.abc import Sequence

from domain.changes.record import Change
from domain.parts.convergence import is_there
from domain.parts.mode_inference import ModeInference

MOST_TOLD = 20
"""Largest number of reasons of one change; more would not be read."""


def joined(reasons: Sequence[str]) -> str:
    """Return the first reasons, and how many there are besides."""
    more = len(reasons) - MOST_TOLD
    told = [*reasons[:MOST_TOLD], *([f"and {more} more"] if more > 0 else [])]
    return "; ".join(told)


def missed_target(change: Change, inference: ModeInference) -> str | None:
    """Return how the requested part deviates from its target although all steps succeeded."""
    target = change.targets.get(change.part)
    if target is None or inference.converged(change.part):
        return None
    actual = inference.actual(change.part)
    if is_there(actual, target):
        return inference.deviation_reason(change.part)
    words = f"{change.part} is {actual.state_and_mode.label}, not {target.label}"
    others = [
        f"{node} is {inference.actual(node).state_and_mode.label}"
        for node in inference.model.nodes_below(change.part)
        if node != change.part and inference.actual(node).state is not target.state
    ]
    return joined([actual.reason or words, *others])
