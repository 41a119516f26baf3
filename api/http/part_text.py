"""JSON text of a part, the same as that of `PartJson`, made in a fraction of its time.

A large robot that changes tells thousands of parts a second.
"""

from collections.abc import Callable

from pydantic_core import to_json

from domain.findings import Blocker
from domain.snapshot import EffectiveTarget, PartView
from domain.timebase import Instant


def part_text(view: PartView, show: Callable[[Instant], str]) -> str:
    """Return a part as clients see it.

    Args:
        view: Of the part.
        show: Returns an instant as RFC 3339.
    """
    target, effective, actual, since, last = (
        view.target,
        view.effective_target,
        view.actual,
        view.deviation_since,
        view.last_known,
    )
    shown = {
        "name": view.name,
        "kind": view.kind,
        "parts": view.parts,
        "target": target and {"state": str(target.state), "mode": target.mode},
        "effective_target": effective and _effective(effective, show),
        "actual": {
            "state": str(actual.state),
            "mode": actual.mode,
            "inferred": actual.inferred,
            "mode_inferred": actual.mode_inferred,
            "undecidable": actual.undecidable,
            "reason": actual.reason,
        },
        "converged": view.converged,
        "deviation_since_at": None if since is None else show(since),
        "deviation_reason": view.deviation_reason,
        "reachable": view.reachable,
        "change": view.change,
        "device": view.device,
        "last_known": last and {"state": str(last.state), "mode": last.mode},
    }
    return to_json(shown, inf_nan_mode="null").decode()


def _effective(target: EffectiveTarget, show: Callable[[Instant], str]) -> dict[str, object]:
    return {
        "state": str(target.state),
        "mode": target.mode,
        "because": str(target.because),
        "rule": target.rule,
        "reaction": target.reaction,
        "cause": target.cause,
        "blockers": [_blocker(blocker, show) for blocker in target.blockers],
    }


def _blocker(blocker: Blocker, show: Callable[[Instant], str]) -> dict[str, object]:
    return {
        "code": blocker.code,
        "message": blocker.message,
        "path": blocker.path,
        "value": blocker.value,
        "threshold": blocker.threshold,
        "since_at": None if blocker.since is None else show(blocker.since),
        "root_cause": blocker.root_cause,
        "refuses": blocker.refuses,
        "causes": [_blocker(cause, show) for cause in blocker.causes],
        "condition": blocker.condition,
    }
