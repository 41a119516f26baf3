"""What is told of the service itself."""

import pytest

from domain.events.event import Event
from domain.events.service import (
    NotRestored,
    ServiceRestored,
    ServiceStalled,
    TimeWasDue,
    WriteAnswered,
)


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            WriteAnswered("PUT", "/holds/gate", 409, "10.0.0.7:5"),
            "PUT /holds/gate from 10.0.0.7:5 answered 409",
        ),
        (
            ServiceRestored(3, 1, 2, 1, 2, 0, True, ""),
            "restored after a restart: 1 requested target, 2 changes failed, 1 task held, 2 holds, "
            "emergency stop engaged",
        ),
        (
            NotRestored("the target active.FAST of arm", "the model has no part arm"),
            "the target active.FAST of arm is not restored: the model has no part arm",
        ),
        (ServiceStalled(1.234), "the service itself was 1.23 s late"),
        (TimeWasDue(), "a deadline passed"),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words
