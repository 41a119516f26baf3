"""Changes that a restart interrupted are found under their ids, as failed."""

import pytest

from domain.actor import Actor
from domain.changes.kept_changes import RESTART
from domain.errors import UnknownChangeError
from domain.identifiers import ChangeId
from domain.inputs import (
    CancelRequest,
    ChangeRequest,
    ModeRequest,
    NodeReport,
    ParametersRequest,
    Restored,
    TransitionRequest,
)
from domain.kept import KeptChange, KeptTarget
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.snapshot import ChangeStatus, ChangeView
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.kept_values import KeptValues
from tests.support.models import ACTUATION, ARM, BASE, PERFORMANCE, actuation_model

REQUESTS: list[ChangeRequest] = [
    ModeRequest(ACTUATION, PERFORMANCE),
    TransitionRequest(ARM, Transition.CONFIGURE),
    ParametersRequest(BASE, {"max_speed": 0.5}),
]


def _core(model: SmhModel | None = None) -> Supervision:
    return Supervision(model or actuation_model(), SupervisionSettings(), 0)


class Service:
    """A core, and what it keeps."""

    def __init__(self, kept: KeptValues | None = None, **restored: int) -> None:
        self.kept = kept or KeptValues()
        self.core = _core()
        self.started = self.kept.take(
            self.core.handle(self.kept.restored(**restored) if kept else Restored(), seconds(9))
        )

    def ask(self, request: ChangeRequest | CancelRequest, at_s: float = 9) -> Outputs:
        return self.kept.take(self.core.handle(request, seconds(at_s)))

    def begin(self, request: ChangeRequest, at_s: float = 9) -> ChangeView:
        change = self.ask(request, at_s).change
        assert change is not None
        return self.core.change(change)


@pytest.mark.parametrize("request_", REQUESTS, ids=lambda value: type(value).__name__)
def test_a_change_that_was_running_is_there_and_failed(request_: ChangeRequest) -> None:
    before = Service()
    begun = before.begin(request_)
    after = Service(before.kept)

    found = after.core.change(begun.id)
    assert (found.request, found.part, found.cause) == (request_, begun.part, begun.cause)
    assert (found.status, found.reason, found.ended_at) == (
        ChangeStatus.FAILED,
        RESTART,
        seconds(9),
    )
    assert list(found.steps) == []


def test_its_end_is_told_as_a_consequence_of_the_restart() -> None:
    before = Service()
    begun = before.begin(ModeRequest(BASE, "FAST", Actor("alice")))
    events = Service(before.kept, next_event=51).started.events

    (failed,) = [event for event in events if event.kind == "change.failed"]
    assert failed.data == {"change": begun.id, "part": BASE, "reason": "restart"}
    assert (events[0].kind, events[0].id) == ("service.restored", 51)
    assert failed.cause == 51


def test_it_is_told_once_however_often_the_service_starts() -> None:
    before = Service()
    begun = before.begin(ModeRequest(BASE, "FAST"))
    again = Service(Service(before.kept).kept)

    assert again.kept.of(KeptChange) == []
    with pytest.raises(UnknownChangeError):
        again.core.change(begun.id)


def test_a_change_that_ended_is_no_longer_kept() -> None:
    service = Service()
    begun = service.begin(ModeRequest(BASE, "FAST"))
    assert service.kept.of(KeptChange) != []
    service.ask(CancelRequest(begun.id))

    assert service.kept.of(KeptChange) == []
    assert service.kept.of(KeptTarget) != [], "its target is in force nevertheless"


def test_a_change_that_ends_with_the_request_leaves_nothing() -> None:
    service = Service()
    known = NodeReport(BASE, LifecycleState.INACTIVE, parameters={"max_speed": 0.5})
    service.core.handle(known, seconds(9))
    done = service.begin(ParametersRequest(BASE, {"max_speed": 0.5}))

    assert done.status is ChangeStatus.SUCCEEDED
    assert service.kept.of(KeptChange) == []


def test_a_new_change_gets_an_id_that_no_earlier_run_gave() -> None:
    before = Service()
    before.begin(ModeRequest(BASE, "FAST"))
    after = Service(before.kept, next_change=1001)

    assert after.begin(ModeRequest(ARM, "WEAK")).id == "c1001"
    assert [change.id for change in after.core.changes()] == ["c1001", "c1"]


def test_no_step_of_it_goes_on_when_its_nodes_report() -> None:
    before = Service()
    before.begin(ModeRequest(BASE, "FAST"))
    after = Service(before.kept)
    report = NodeReport(BASE, LifecycleState.UNCONFIGURED, reachable=True)

    assert after.core.handle(report, seconds(10)).commands == ()
    assert after.core.part(BASE).change is None


def test_a_change_of_a_part_that_the_model_no_longer_has_is_found_as_well() -> None:
    kept = KeptChange(ChangeId("c7"), PartName("gripper"), 3, 12, mode="OPEN")
    core = _core()
    core.handle(Restored((kept,), boot=2, next_change=8), 0)

    assert core.change("c7").request == ModeRequest(PartName("gripper"), "OPEN")


def test_a_change_is_never_older_than_its_end() -> None:
    kept = KeptChange(ChangeId("c7"), BASE, seconds(99), 12, transition=Transition.CONFIGURE)
    core = _core()
    core.handle(Restored((kept,), boot=2, next_change=8), seconds(5))

    assert core.change("c7").started_at == core.change("c7").ended_at == seconds(5)
