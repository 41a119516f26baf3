"""What is told of targets in force that differ from the requested ones."""

import pytest

from domain.events.event import Event
from domain.events.targets import (
    DisplacementBegan,
    DisplacementEnded,
    DisplacementStays,
    RuleNotApplied,
)
from domain.snapshot import Because
from tests.support.models import ACTUATION, active, inactive

RULE, INVARIANT = Because.RULE, Because.INVARIANT
FAST, SLOW = active("FAST"), active("SLOW")


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            DisplacementBegan(ACTUATION, SLOW, FAST, RULE, "slow_down", "arm is inactive"),
            "actuation: rule slow_down sets active.SLOW instead of active.FAST: arm is inactive",
        ),
        (
            DisplacementEnded(ACTUATION, FAST, SLOW, RULE, "slow_down", "a newer request"),
            "actuation: active.FAST replaces active.SLOW of rule slow_down: a newer request",
        ),
        (
            DisplacementEnded(ACTUATION, None, SLOW, RULE, "slow_down", "a newer request"),
            "actuation: no target replaces active.SLOW of rule slow_down: a newer request",
        ),
        (
            DisplacementStays(ACTUATION, SLOW, RULE, "slow_down", "ESTOP was active"),
            "actuation stays active.SLOW after rule slow_down: ESTOP was active",
        ),
        (
            DisplacementBegan(ACTUATION, SLOW, FAST, INVARIANT, None, "it is too hot"),
            "actuation: a broken invariant sets active.SLOW instead of active.FAST: it is too hot",
        ),
        (
            DisplacementEnded(ACTUATION, FAST, SLOW, INVARIANT, None, "its guards hold again"),
            "actuation: active.FAST replaces active.SLOW of a broken invariant: its guards hold "
            "again",
        ),
        (
            DisplacementStays(ACTUATION, SLOW, INVARIANT, None, "ESTOP was active"),
            "actuation stays active.SLOW after a broken invariant: ESTOP was active",
        ),
        (
            DisplacementStays(ACTUATION, SLOW, Because.REACTION, None, "ESTOP was active", "LIMP"),
            "actuation stays active.SLOW after reaction LIMP: ESTOP was active",
        ),
        (
            DisplacementBegan(ACTUATION, SLOW, FAST, Because.LOCAL, None, "it is hot", "CALM"),
            "actuation: reaction CALM, on its device, sets active.SLOW instead of active.FAST: "
            "it is hot",
        ),
        (
            RuleNotApplied(ACTUATION, "park", inactive(), "ESTOP was active"),
            "actuation: rule park does not set inactive: ESTOP was active",
        ),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words


def test_who_set_a_target_is_told_by_its_name() -> None:
    began = DisplacementBegan(ACTUATION, SLOW, FAST, RULE, "slow_down", "arm is inactive")

    assert began.data()["because"] == "rule"
    assert began.data()["was"] == "active.FAST"
