"""Whatever a robot with invariants reads and is asked: it falls back, or says what is broken.

`make soak` plays 10,000 stories, `make test` 200.
"""

import os
from collections import defaultdict
from collections.abc import Callable
from contextlib import suppress
from typing import TypeAlias

import hypothesis.strategies as st
from hypothesis import given, settings

from domain.commands import AskTransition
from domain.conditions.condition import Condition
from domain.errors import PilothouseError
from domain.lifecycle import LifecycleState, Transition
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import SmhModel
from domain.reactions.settings import MAX_RETURNS, WINDOW
from domain.simulation.node_settings import Fault
from domain.snapshot import Because
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName
from domain.timebase import Instant, seconds
from tests.support.falling_robot import FallingRobot
from tests.support.models import ACTUATION, ARM, BASE, nested_model

STORIES = 10_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 200

Act: TypeAlias = Callable[["Story"], object]

ROBOT = PartName("robot")
GOOD_READINGS = {"temperature": 20.0, "battery_level": 0.9}
READINGS = [{"temperature": 20.0}, {"temperature": 60.0}, {"temperature": 45.0},
            {"battery_level": 0.9}, {"battery_level": 0.1}, {"battery_level": 0.3}]  # fmt: skip
HOLDS: dict[str, Callable[[dict[str, float]], bool]] = {
    "temperature < 50": lambda now: now["temperature"] < 50,
    "temperature < 40": lambda now: now["temperature"] < 40,
    "battery_level >= 0.2": lambda now: now["battery_level"] >= 0.2,
    "battery_level >= 0.5": lambda now: now["battery_level"] >= 0.5,
}
"""Guards, and a judgement of their own of each."""
MODES = {
    ROBOT: (DEFAULT_MODE, "RACE"),
    ACTUATION: (DEFAULT_MODE, "MODERATE", "PERFORMANCE"),
    BASE: (DEFAULT_MODE, "SLOW", "FAST"),
    ARM: (DEFAULT_MODE, "WEAK", "STRONG"),
}
"""Of each part, those that can fall back, the least demanding first."""


@st.composite
def models(draw: st.DrawFn) -> SmhModel:
    """Return a robot whose modes have guards, and fall back to what is less demanding."""
    model, texts = nested_model(), st.lists(st.sampled_from(sorted(HOLDS)), max_size=2)
    own: dict[PartName, dict[ModeName, ModeSettings]] = defaultdict(dict)
    for part, modes in MODES.items():
        for number, mode in enumerate(modes):
            fallback = draw(st.sampled_from([None, *modes[:number]]))
            own[part][ModeName(mode)] = ModeSettings(
                tuple(map(Condition, draw(texts) if number else [])),
                tuple(map(Condition, draw(texts))),
                seconds(draw(st.sampled_from([0.0, 0.0, 0.7, 2.0]))),
                None if fallback is None else ModeName(fallback),
            )
    return SmhModel(model.nodes, model.systems, own)


class Story:
    """A robot, and what a bystander knows of its guards."""

    def __init__(self, model: SmhModel) -> None:
        self.robot = FallingRobot(model)
        self.robot.lose_pose()
        self.values: dict[str, float] = {}
        self.broken_since: dict[str, Instant] = {}
        self.returned: dict[object, list[Instant]] = defaultdict(list)
        self._seen = 0
        self.read(GOOD_READINGS)

    def read(self, values: dict[str, float]) -> None:
        """Hand in readings, and judge all guards by them."""
        self.robot.read(**values)
        self.values |= values
        for text, holds in HOLDS.items():
            if holds(self.values):
                self.broken_since.pop(text, None)
            else:
                self.broken_since.setdefault(text, self.robot.now)

    def play(self, act: Act, wait_s: float) -> None:
        """Let something happen that may be rejected, and some time pass."""
        with suppress(PilothouseError):
            act(self)
        self.look()
        self.robot.advance(wait_s)
        self.look()

    def look(self) -> None:
        """Check what is in force and what is told."""
        for part in MODES:
            self._check(part)
        for event in self.robot.events[self._seen :]:
            if event.kind == "target.displacement_ended" and event.actor.label.startswith("inv"):
                self.returned[event.data["part"]].append(event.at)
        self._seen = len(self.robot.events)
        if self.robot.core.emergency_stop().engaged:
            activated = [c for c in self.robot.commands if isinstance(c, AskTransition)]
            assert Transition.ACTIVATE not in [command.transition for command in activated]
        self.robot.commands.clear()

    def _check(self, part: PartName) -> None:
        view = self.robot.core.part(part)
        pursued = view.effective_target
        if pursued is None:
            return
        if pursued.because is Because.INVARIANT:
            assert pursued.blockers
            assert pursued.cause
        told = self.robot.broken(part)
        if view.change is None:
            late = self.is_broken_for_long(part)
            assert bool(told) is late, (part, pursued, told)
            if late:
                assert self._settings(part).fallback is None, "else it would have fallen back"

    def is_broken_for_long(self, part: PartName) -> bool:
        """Tell whether an invariant of the mode in force is broken for longer than its grace."""
        settings, broken = self._settings(part), self.broken_since
        return any(
            condition.text in broken and broken[condition.text] + settings.grace <= self.robot.now
            for condition in settings.invariants
        )

    def _settings(self, part: PartName) -> ModeSettings:
        pursued = self.robot.pursued(part)
        if pursued.state is not LifecycleState.ACTIVE:
            return ModeSettings()
        return self.robot.model.settings_of(part, pursued.mode)


# --- what happens --------------------------------------------------------------------------------


def _read(values: dict[str, float]) -> Act:
    return lambda story: story.read(values)


def _ask(part: PartName, number: int) -> Act:
    modes = MODES[part]
    return lambda story: story.robot.ask_mode(part, modes[number % len(modes)])


def _ask_transition(part: PartName, transition: Transition) -> Act:
    return lambda story: story.robot.ask_transition(part, transition)


def _break(node: PartName, fault: Fault | None) -> Act:
    return lambda story: story.robot.fault(node, fault)


PARTS = st.sampled_from(sorted(MODES))
MOVES = (Transition.ACTIVATE, Transition.DEACTIVATE)
ACTS: st.SearchStrategy[Act] = st.one_of(
    st.builds(_read, st.sampled_from(READINGS)),
    st.builds(_read, st.sampled_from(READINGS)),
    st.builds(_read, st.sampled_from(READINGS)),
    st.builds(_ask, PARTS, st.integers(0, 2)),
    st.builds(
        _ask_transition, PARTS, st.sampled_from([Transition.ACTIVATE, Transition.DEACTIVATE])
    ),
    st.builds(_break, st.sampled_from([BASE, ARM]), st.sampled_from([None, None, Fault.REFUSE])),
    st.sampled_from([lambda story: story.robot.stop(), lambda story: story.robot.release_stop()]),
)
WAITS = st.sampled_from([0.0, 0.3, 0.7, 1.0, 1.1, 2.0, 5.0])


@settings(max_examples=STORIES, deadline=None)
@given(models(), st.lists(st.tuples(ACTS, WAITS), min_size=5, max_size=25))
def test_a_broken_invariant_is_followed_or_told_and_what_is_requested_is_returned_to(
    model: SmhModel, acts: list[tuple[Act, float]]
) -> None:
    story = Story(model)
    robot = story.robot
    story.play(_ask(ROBOT, 1), 2.0)
    for act, wait_s in acts:
        story.play(act, wait_s)

    for node in (BASE, ARM):
        robot.fault(node, None)
    robot.release_stop()
    robot.advance(70)
    story.read(GOOD_READINGS)
    story.look()
    robot.ask_mode(ROBOT, "RACE")
    robot.advance(3)
    story.read({"temperature": 60.0})
    robot.advance(5)
    story.look()
    story.read({"temperature": 20.0})
    robot.advance(20)
    story.look()

    for part in MODES:
        pursued = robot.pursued(part)
        assert pursued.because is Because.REQUESTED, "nothing is broken, and no bound was hit"
    assert robot.actual(ROBOT) == "active.RACE"
    for times in story.returned.values():
        assert all(
            later - earlier >= WINDOW
            for earlier, later in zip(times, times[MAX_RETURNS:], strict=False)
        )
    changes = len(robot.core.changes())
    robot.advance(200)
    assert len(robot.core.changes()) == changes, "nothing fights"
