"""What is told of the service itself."""

import pytest

from domain.events.event import Event
from domain.events.service import TimeWasDue, WriteAnswered


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            WriteAnswered("PUT", "/holds/gate", 409, "10.0.0.7:5"),
            "PUT /holds/gate from 10.0.0.7:5 answered 409",
        ),
        (TimeWasDue(), "a deadline passed"),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words
