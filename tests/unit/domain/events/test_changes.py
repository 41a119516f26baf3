"""What is told of changes."""

import pytest

from domain.events.changes import (
    CHANGE_ENDS,
    BackendUnavailable,
    ChangeCancelRequested,
    ChangeFailed,
    ChangeRequested,
    ChangeSucceeded,
    ChangeWaiting,
    NodeAnswered,
    NodeNotRestored,
    NodeRestoring,
    StepEnded,
    StepStarted,
)
from domain.events.event import Event
from domain.identifiers import ChangeId
from domain.lifecycle import Transition
from domain.snapshot import ChangeStatus, StepStatus
from domain.state_and_mode import PartName
from tests.support.models import active

ARM, C1 = PartName("arm"), ChangeId("c1")


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (ChangeRequested(ARM, mode="FAST"), "arm: FAST requested"),
        (ChangeRequested(ARM, transition=Transition.ACTIVATE), "arm: activate requested"),
        (
            ChangeRequested(ARM, parameters={"torque": 1.0, "gain": 2}),
            "arm: parameters torque, gain requested",
        ),
        (ChangeCancelRequested("c1"), "cancel of change c1 requested"),
        (StepStarted(C1, ARM, "activate"), "arm: activate"),
        (
            StepEnded(C1, ARM, "activate", StepStatus.TIMED_OUT, "no answer"),
            "arm: activate timed out: no answer",
        ),
        (NodeAnswered(ARM, True, ""), "arm accepts the request"),
        (NodeAnswered(ARM, False, "busy"), "arm rejects the request: busy"),
        (ChangeFailed(C1, ARM, "arm refused"), "arm: change failed: arm refused"),
        (ChangeSucceeded(C1, ARM, None), "arm: change succeeded"),
        (ChangeWaiting(C1, ARM, "hold lunch is set"), "arm: change waits: hold lunch is set"),
        (NodeRestoring(ARM, active("FAST")), "arm reappeared and is restored to active.FAST"),
        (
            NodeNotRestored(ARM, active("FAST"), "ESTOP is on"),
            "arm reappeared and is not restored: ESTOP is on",
        ),
        (BackendUnavailable("no route"), "the backend is unavailable: no route"),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words


def test_every_end_of_a_change_has_an_event() -> None:
    assert set(CHANGE_ENDS) == {status for status in ChangeStatus if status.is_final}
    assert all(end.kind == f"change.{status}" for status, end in CHANGE_ENDS.items())
