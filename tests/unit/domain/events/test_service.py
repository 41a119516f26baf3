"""What is told of the service itself."""

import pytest

from domain.events.event import Event
from domain.events.service import NotRestored, ServiceStalled, TimeWasDue, WriteAnswered


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            WriteAnswered("PUT", "/holds/gate", 409, "10.0.0.7:5"),
            "PUT /holds/gate from 10.0.0.7:5 answered 409",
        ),
        (ServiceStalled(1.234), "the service itself was 1.23 s late"),
        (
            NotRestored("hold gate-3", "there are 64 holds already"),
            "not restored: hold gate-3: there are 64 holds already",
        ),
        (TimeWasDue(), "a deadline passed"),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words
