"""What is told of the processes of nodes."""

import pytest

from domain.events.event import Event
from domain.events.processes import (
    ProcessEnded,
    ProcessGivenUp,
    ProcessReady,
    ProcessRequested,
    ProcessStarted,
    ProcessWaits,
)
from domain.process_terms import ProcessAction
from domain.state_and_mode import PartName

ARM = PartName("arm")


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (ProcessReady(ARM), "the process of arm does not run yet"),
        (ProcessStarted(ARM, 4711), "the process of arm runs: 4711"),
        (ProcessEnded(ARM, 1, "", "exit code 1"), "the process of arm ended: exit code 1"),
        (ProcessRequested(ARM, ProcessAction.STOP), "stop of the process of arm requested"),
        (ProcessWaits(ARM, 0.5, 2), "the process of arm is started again in 0.5 s"),
        (
            ProcessGivenUp(ARM, 5, 60.0),
            "the process of arm is not started again: started 5 times in 60 s",
        ),
    ],
)
def test_an_event_is_told_in_a_sentence(event: Event, words: str) -> None:
    assert event.words == words


def test_that_nothing_runs_yet_is_no_news() -> None:
    assert not ProcessReady(ARM).notable
    assert ProcessStarted(ARM, 1).notable
