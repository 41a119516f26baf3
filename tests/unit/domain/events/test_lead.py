"""What a device tells of its supervisor, and of what it does without it."""

import pytest

from domain.events.event import Event
from domain.events.lead import (
    DeviceActsAlone,
    DeviceFollowsAgain,
    DeviceTargetLeft,
    OrderRefused,
    OrderTaken,
    SupervisorConnected,
    SupervisorLate,
    SupervisorLost,
)
from domain.lifecycle import LifecycleState
from domain.state_and_mode import StateAndMode
from tests.support.models import BASE


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (SupervisorConnected("base"), "device base follows its supervisor"),
        (
            SupervisorLate("base", "not heard for 0.5 s"),
            "device base hears its supervisor late: not heard for 0.5 s",
        ),
        (
            SupervisorLost("base", "not heard for 1.5 s"),
            "device base is cut off from its supervisor: not heard for 1.5 s",
        ),
        (OrderTaken(BASE, "activate"), "the supervisor orders drive_base: activate"),
        (
            OrderRefused(BASE, "activate", "ESTOP is active"),
            "an order is refused, drive_base: activate: ESTOP is active",
        ),
        (
            DeviceActsAlone("base", "after 2 s: drive_base to inactive"),
            "device base acts alone: after 2 s: drive_base to inactive",
        ),
        (
            DeviceTargetLeft("base", BASE, StateAndMode(LifecycleState.INACTIVE), "it is busy"),
            "device base does not bring drive_base to inactive: it is busy",
        ),
        (
            DeviceFollowsAgain("base"),
            "device base follows its supervisor again, and acts alone no longer",
        ),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words
