from domain.actor import Actor
from domain.audit import Audit
from domain.inputs import WriteRecord
from domain.outbox import Outbox


def test_a_write_is_recorded_with_who_asked_and_how_it_was_answered() -> None:
    outbox = Outbox()

    Audit(outbox).take_record(
        WriteRecord("PUT", "/holds/gate", 409, "10.0.0.7:5", Actor("anna")), 7
    )

    (event,) = outbox.take().events
    assert (event.kind, event.at, event.actor.label, event.cause) == (
        "audit.write",
        7,
        "anna",
        None,
    )
    assert event.data == {
        "method": "PUT",
        "path": "/holds/gate",
        "status": 409,
        "address": "10.0.0.7:5",
    }
