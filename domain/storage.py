"""Whether what happens can be written down; if not, only what makes the robot safer is durable."""

from domain.concern import Concern, Takers
from domain.events.service import StorageDegraded, StorageRecovered
from domain.inputs import StorageStatus
from domain.outbox import Outbox
from domain.timebase import Instant


class Storage(Concern):
    """Tells when storage fails and when it works again; nothing is stopped for it."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self.fault: str | None = None
        """Why storage fails; None: it works."""

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {StorageStatus: self.take_status}

    def take_status(self, status: StorageStatus, now: Instant) -> None:
        """Take how storage is; only a change is told."""
        fault = None if status.available else status.reason
        if fault == self.fault:
            return
        self.fault = fault
        told = StorageRecovered() if fault is None else StorageDegraded(fault)
        self._outbox.begin(now, told)
        self._outbox.record_input()
        self._outbox.system_state = True
