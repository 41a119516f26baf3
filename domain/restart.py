"""A restart of the service: the first input of a run, and what an operator is told of it."""

from domain.concern import Concern, Takers
from domain.events.service import ServiceRestored
from domain.inputs import Restored
from domain.kept import (
    KeptChange,
    KeptEmergencyStop,
    KeptError,
    KeptHold,
    KeptPeerStops,
    KeptProgress,
    KeptTarget,
    KeptTask,
    KeptUnacknowledged,
)
from domain.outbox import Outbox
from domain.timebase import Instant


class Restart(Concern):
    """Begins what an earlier run left; the concerns after it bring their part of it back."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {Restored: self.take_restored}

    def take_restored(self, restored: Restored, now: Instant) -> None:
        """Go on with the ids of events, and tell of a restart; a first run is nothing to tell."""
        self._outbox.number_events_from(restored.next_event)
        self._outbox.begin(now, _described(restored))
        if restored.is_restart:
            self._outbox.record_input()


def _described(restored: Restored) -> ServiceRestored:
    """Return the event that records what was kept."""

    def count(kind: type) -> int:
        return sum(isinstance(value, kind) for value in restored.kept)

    is_stopped = any(
        value.engaged if isinstance(value, KeptEmergencyStop) else isinstance(value, KeptPeerStops)
        for value in restored.kept
    )
    ended = {
        value.task
        for value in restored.kept
        if isinstance(value, KeptProgress) and value.ended_as is not None
    }
    tasks = [value for value in restored.kept if isinstance(value, KeptTask)]
    unacknowledged = {
        value.name for value in restored.kept if isinstance(value, KeptError | KeptUnacknowledged)
    }
    return ServiceRestored(
        boot=restored.boot,
        targets=count(KeptTarget),
        changes=count(KeptChange),
        tasks=sum(task.id not in ended for task in tasks),
        holds=count(KeptHold),
        errors=len(unacknowledged),
        emergency_stop=bool(restored.stop_because) or is_stopped,
        reason=restored.stop_because,
    )
