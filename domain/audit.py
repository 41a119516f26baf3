"""The audit trail: who requested a change of anything, and the answer."""

from domain.concern import Concern, Takers
from domain.events.service import WriteAnswered
from domain.inputs import WriteRecord
from domain.outbox import Outbox
from domain.timebase import Instant


class Audit(Concern):
    """Records every write request, accepted or rejected."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {WriteRecord: self.take_record}

    def take_record(self, record: WriteRecord, now: Instant) -> None:
        """Record a request and its answer."""
        written = WriteAnswered(record.method, record.path, record.status, record.address)
        self._outbox.begin(now, written, record.actor)
        self._outbox.record_input()
