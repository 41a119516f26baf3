"""What is told of the announcing of errors, in words."""

import pytest

from domain.events.announcing import (
    ErrorChattering,
    ErrorShelved,
    ErrorUnshelved,
    duration_words,
)
from domain.events.event import Event
from domain.state_and_mode import PartName

ARM = PartName("arm")


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            ErrorShelved("DEVIATES", 600.0, "it is being mended", ARM),
            "arm.DEVIATES shelved for 10 min: it is being mended",
        ),
        (ErrorUnshelved("BATTERY_LOW"), "BATTERY_LOW is no longer shelved"),
        (
            ErrorChattering("DEVIATES", 2.5, ARM),
            "arm.DEVIATES: it changed more than 5 times in 10 min; clear_for_s: 2.5 would calm it",
        ),
        (
            ErrorChattering("BATTERY_LOW", None),
            "BATTERY_LOW: it changed more than 5 times in 10 min",
        ),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words


@pytest.mark.parametrize(
    ("time_s", "words"),
    [
        (0.5, "0.5 s"),
        (59.0, "59 s"),
        (90.0, "1.5 min"),
        (100.0, "100 s"),
        (600.0, "10 min"),
        (5_400.0, "1.5 h"),
        (28_800.0, "8 h"),
    ],
)
def test_a_time_is_said_in_the_unit_that_fits(time_s: float, words: str) -> None:
    assert duration_words(time_s) == words
