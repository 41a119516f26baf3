"""What is told of nodes and systems."""

import pytest

from domain.events.event import Event
from domain.events.parts import (
    CheckpointReached,
    DeviationBegan,
    DeviationEnded,
    NodeReachable,
    NodeReported,
    NodeUnreachable,
    PartActualChanged,
)
from domain.lifecycle import LifecycleState
from domain.state_and_mode import PartName
from tests.support.models import active, inactive

ARM, ACTUATION = PartName("arm"), PartName("actuation")


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (
            NodeReported(ARM, LifecycleState.INACTIVE, parameters={"torque": 1.0}),
            "arm reports inactive, parameters torque",
        ),
        (NodeReported(ARM, reachable=False), "arm reports unreachable"),
        (NodeReported(ARM, reachable=True), "arm reports that it is reachable"),
        (CheckpointReached(ARM, "cycle"), "arm reached cycle"),
        (NodeReachable(ARM), "arm is reachable"),
        (NodeUnreachable(ARM), "arm is unreachable"),
        (
            PartActualChanged(ACTUATION, active("FAST"), inactive(), None),
            "actuation: inactive -> active.FAST",
        ),
        (
            DeviationBegan(ARM, active("FAST"), inactive(), "arm is unreachable"),
            "arm is inactive, target active.FAST: arm is unreachable",
        ),
        (
            DeviationBegan(ACTUATION, None, inactive(), "arm is unconfigured, target active.FAST"),
            "actuation is inactive: arm is unconfigured, target active.FAST",
        ),
        (DeviationEnded(ARM, None, inactive(), None), "arm is inactive"),
    ],
    ids=lambda value: value.kind if isinstance(value, Event) else "",
)
def test_an_event_says_in_words_what_happened(event: Event, words: str) -> None:
    assert event.words == words


def test_a_short_list_has_the_steps_of_systems_and_not_those_of_each_node() -> None:
    assert not PartActualChanged(ARM, active(), inactive(), None).notable
    assert PartActualChanged(ACTUATION, active(), inactive(), None, of_system=True).notable


def test_a_short_list_leaves_out_what_is_lost_with_its_device() -> None:
    assert NodeUnreachable(ARM).notable
    assert not NodeUnreachable(ARM, with_device=True).notable
    assert not NodeReachable(ARM, with_device=True).notable
    assert NodeReachable(ARM, with_device=True).data() == {"node": "arm"}
