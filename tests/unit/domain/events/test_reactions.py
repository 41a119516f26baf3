"""What is told of reactions."""

import pytest

from domain.events.event import Event
from domain.events.reactions import (
    ReactionAcknowledged,
    ReactionActing,
    ReactionArmRequested,
    ReactionEnded,
    ReactionExhausted,
    ReactionOverruled,
    ReactionWouldAct,
)
from domain.events.targets import DisplacementBegan
from domain.reaction_terms import Action, Arm
from domain.snapshot import Because
from tests.support.models import ACTUATION, active

LIMP = (ACTUATION, "LIMP", Action.MODE)


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            ReactionActing(*LIMP, "arm is inactive"),
            "reaction LIMP of actuation: mode: arm is inactive",
        ),
        (
            ReactionEnded(*LIMP, "acknowledged"),
            "reaction LIMP of actuation has ended: acknowledged",
        ),
        (
            ReactionWouldAct(*LIMP, "arm is inactive"),
            "reaction LIMP of actuation would act (mode) and is passive: arm is inactive",
        ),
        (
            ReactionOverruled(*LIMP, "ESTOP is active"),
            "reaction LIMP of actuation is overruled: ESTOP is active",
        ),
        (
            ReactionExhausted(*LIMP, Action.HOLD, "it acted 3 times in 60 s"),
            "reaction LIMP of actuation acts no more: hold instead: it acted 3 times in 60 s",
        ),
        (
            ReactionArmRequested(ACTUATION, "LIMP", Arm.PASSIVE, "on trial"),
            "reaction LIMP of actuation is now passive: on trial",
        ),
        (
            ReactionAcknowledged(ACTUATION, "LIMP"),
            "reaction LIMP of actuation acknowledged",
        ),
        (
            DisplacementBegan(
                ACTUATION, active("SLOW"), None, Because.REACTION, None, "too hot", "LIMP"
            ),
            "actuation: reaction LIMP sets active.SLOW: too hot",
        ),
    ],
)
def test_words(event: Event, words: str) -> None:
    assert event.words == words


def test_events_of_reactions_say_whose_and_what() -> None:
    assert ReactionActing(*LIMP, "hot").data() == {
        "part": "actuation",
        "reaction": "LIMP",
        "action": "mode",
        "reason": "hot",
    }


def test_requests_are_inputs() -> None:
    assert ReactionArmRequested.is_input
    assert ReactionAcknowledged.is_input
    assert not ReactionActing.is_input
