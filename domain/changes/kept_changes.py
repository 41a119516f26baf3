"""The changes that survive a restart: as failed, since nobody knows what became of their steps."""

from collections.abc import Iterable, Iterator

from domain.changes.record import Change
from domain.inputs import ChangeRequest, ModeRequest, ParametersRequest, TransitionRequest
from domain.kept import Kept, KeptChange
from domain.snapshot import ChangeStatus
from domain.timebase import Instant

RESTART = "restart"
"""Why a change failed that had not ended when the service did."""


def kept_of(change: Change) -> KeptChange:
    """Return what is kept of a change while it runs."""
    request = change.request
    return KeptChange(
        change.id,
        change.part,
        change.started_at,
        change.cause,
        mode=request.mode if isinstance(request, ModeRequest) else None,
        transition=request.transition if isinstance(request, TransitionRequest) else None,
        parameters=dict(request.values) if isinstance(request, ParametersRequest) else None,
    )


def ended_by_restart(kept: Iterable[Kept], now: Instant) -> Iterator[Change]:
    """Return the changes that were running, as failed and without their steps, the oldest first."""
    running = [value for value in kept if isinstance(value, KeptChange)]
    for value in sorted(running, key=lambda value: (value.cause, value.id)):
        yield Change(
            value.id,
            value.part,
            _request_of(value),
            {},
            min(value.started_at, now),
            value.cause,
            status=ChangeStatus.FAILED,
            reason=RESTART,
            ended_at=now,
        )


def _request_of(kept: KeptChange) -> ChangeRequest:
    if kept.mode is not None:
        return ModeRequest(kept.part, kept.mode)
    if kept.transition is not None:
        return TransitionRequest(kept.part, kept.transition)
    return ParametersRequest(kept.part, dict(kept.parameters or {}))
