"""What a reading costs does not depend on how many signals there are: counted, not timed."""

import sys
from types import FrameType

import pytest

from domain.health.signals import (
    Bound,
    Comparison,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.inputs import Input, Reading, Readings, TimePassed
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.good import GOOD
from tests.support.models import actuation_model


def robot_with(count: int) -> Supervision:
    """Return a robot with so many signals, of which all but the usual ones were never seen."""
    further = (
        SignalSettings(
            SignalSpec(f"signal_{number}", SignalKind.NUMBER),
            (Bound(f"ERROR_{number}", Comparison.ABOVE, 10.0, for_=seconds(1)),),
        )
        for number in range(count - len(GOOD))
    )
    signals = (*default_signals(), *further)
    core = Supervision(actuation_model(), SupervisionSettings(signals), 0)
    core.handle(Readings(tuple(Reading(name, value) for name, value in GOOD.items()), "test"), 1)
    return core


def calls_of(core: Supervision, given: Input, at_s: float) -> int:
    """Return how many functions are called for an input, those of C among them."""
    calls = 0

    def note(frame: FrameType, event: str, argument: object) -> None:
        nonlocal calls
        calls += event in ("call", "c_call")

    sys.setprofile(note)
    try:
        core.handle(given, seconds(at_s))
    finally:
        sys.setprofile(None)
    return calls


STORIES: dict[str, list[tuple[float, Input]]] = {
    "a good reading": [(0.1, Readings((Reading("battery_level", 0.9),), "test"))],
    "an error begins, changes and ends": [
        (0.1, Readings((Reading("battery_level", 0.4),), "test")),
        (0.2, Readings((Reading("battery_level", 0.3),), "test")),
        (0.7, Readings((Reading("battery_level", 0.8),), "test")),
    ],
    "a signal that never was is seen": [(0.1, Readings((Reading("signal_1", 11.0),), "test"))],
    "time passes": [(0.1, TimePassed()), (0.2, TimePassed())],
}


@pytest.mark.parametrize("story", STORIES.values(), ids=STORIES)
def test_an_input_costs_as_much_with_a_thousand_signals(story: list[tuple[float, Input]]) -> None:
    few, many = robot_with(10), robot_with(1_000)
    for at_s, given in story:
        assert calls_of(many, given, at_s) <= calls_of(few, given, at_s) + 20
