"""Storage that fails is told, and told again only when that changes."""

from domain.inputs import StorageStatus
from domain.outbox import Outbox, Outputs
from domain.storage import Storage

FULL = StorageStatus(available=False, reason="the disk is full")
FINE = StorageStatus(available=True)


class Told:
    """The concern, and what it tells."""

    def __init__(self) -> None:
        self._outbox = Outbox()
        self.storage = Storage(self._outbox)

    def take(self, status: StorageStatus) -> Outputs:
        self.storage.take_status(status, 5)
        return self._outbox.take()


def test_a_disk_that_is_full_is_told_with_its_reason() -> None:
    told = Told()
    outputs = told.take(FULL)

    (event,) = outputs.events
    assert (event.kind, event.data) == ("storage.degraded", {"reason": "the disk is full"})
    assert event.event.words == "storage fails: the disk is full"
    assert outputs.system_state
    assert told.storage.fault == "the disk is full"


def test_that_it_works_again_is_told_once() -> None:
    told = Told()
    told.take(FULL)
    (event,) = told.take(FINE).events

    assert event.kind == "storage.recovered"
    assert told.storage.fault is None
    assert told.take(FINE).events == ()


def test_the_same_fault_is_not_told_twice_and_another_one_is() -> None:
    told = Told()
    told.take(FULL)

    assert told.take(FULL).events == ()
    assert told.take(StorageStatus(available=False, reason="read-only")).events
