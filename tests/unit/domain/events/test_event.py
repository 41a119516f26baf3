from domain.actor import NOBODY
from domain.events.changes import ChangeRequested
from domain.events.event import RecordedEvent, because
from domain.events.health import SystemStateChanged
from domain.events.parts import NodeReported, PartActualChanged
from domain.lifecycle import LifecycleState, Transition
from domain.snapshot import SystemState
from domain.state_and_mode import PartName
from tests.support.models import active, inactive

ARM = PartName("arm")


def test_data_is_what_clients_see_labels_texts_and_lists() -> None:
    reported = NodeReported(ARM, LifecycleState.ACTIVE, parameters={"gains": (1.0, 2.0)})

    assert RecordedEvent(3, 7, None, NOBODY, reported).data == {
        "node": "arm",
        "state": "active",
        "parameters": {"gains": (1.0, 2.0)},
    }
    state = SystemStateChanged(SystemState.ERROR, SystemState.IDLE, ("ESTOP",), 2)
    assert state.data()["errors"] == ["ESTOP"]
    assert PartActualChanged(ARM, active("FAST"), inactive(), None).data() == {
        "part": "arm",
        "actual": "active.FAST",
        "was": "inactive",
        "reason": None,
    }


def test_what_was_not_requested_is_left_out() -> None:
    request = ChangeRequested(ARM, transition=Transition.ACTIVATE)
    assert request.data() == {"part": "arm", "transition": "activate"}


def test_a_reason_follows_what_happened_where_there_is_one() -> None:
    assert because("hold gate set", "closed") == "hold gate set: closed"
    assert because("hold gate set", "") == because("hold gate set", None) == "hold gate set"
