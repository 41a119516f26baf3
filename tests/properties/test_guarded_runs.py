"""Random stories of a robot with orders, guards and rules; each ends with every change ended.

`make soak` plays 10,000 stories, `make test` 150.
"""

import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import hypothesis.strategies as st
from hypothesis import given, settings

from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth, evaluate
from domain.errors import BlockedError, PilothouseError
from domain.findings import Blocker
from domain.inputs import CancelRequest, ModeRequest, TransitionRequest
from domain.lifecycle import LifecycleState, Transition
from domain.parts.mode_settings import ModeSettings, OnFailure, TransitionSettings
from domain.parts.system_model import EVERY_MODE, Rule, SmhModel
from domain.simulation.node_settings import Fault
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import seconds
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import ACTUATION, ARM, BASE, FAST, PERFORMANCE, active, nested_model

STORIES = 10_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 150


def _model(on_failure: OnFailure, grace_s: float) -> SmhModel:
    """Return a robot whose parts wait for each other, and whose modes have guards."""
    model = nested_model()
    order = TransitionSettings({ARM: (BASE,)}, seconds(20), on_failure)
    guarded = ModeSettings(
        (Condition("battery_level >= 0.3"),),
        (Condition("temperature < 50"),),
        seconds(grace_s),
        transition=order,
    )
    rule = Rule(
        "no_base",
        active(PERFORMANCE),
        (BASE, StateAndMode(LifecycleState.INACTIVE)),
        StateAndMode(LifecycleState.INACTIVE),
    )
    systems = dict(model.systems)
    systems[ACTUATION] = replace(systems[ACTUATION], rules=(rule,))
    of_modes = {
        ACTUATION: {PERFORMANCE: guarded, EVERY_MODE: ModeSettings(transition=order)},
        BASE: {FAST: ModeSettings(requires=(Condition("not hold.charging"),))},
    }
    return SmhModel(model.nodes, systems, of_modes)


MODELS = st.builds(_model, st.sampled_from(OnFailure), st.sampled_from([0.0, 0.5]))
PARTS = st.sampled_from(nested_model().parts)
NODES = st.sampled_from(list(nested_model().nodes))
MODES = PARTS.flatmap(lambda p: st.tuples(st.just(p), st.sampled_from(nested_model().modes_of(p))))
Act = Callable[["Story"], None]


class Story:
    """A robot, and what was asked of it."""

    def __init__(self, model: SmhModel) -> None:
        self.robot = CoreRobot(model)
        self.signals = dict(GOOD)
        # A vehicle that reports 20 times a second would be most of what happens.
        self.robot.lose_pose()
        self.robot.read(**self.signals)

    def pass_time(self, duration_s: float) -> None:
        """Let time pass while all signals stay fresh."""
        while duration_s > 0:
            self.robot.advance(min(duration_s, 1.0))
            self.robot.read(**self.signals)
            duration_s -= 1.0

    def read(self, **signals: float | bool) -> None:
        """Let signals have other values."""
        self.signals |= signals
        self.robot.read(**self.signals)

    def ask_mode(self, part: PartName, mode: str, wait_for_s: float | None) -> None:
        """Ask for a mode, which is taken exactly if it can be entered."""
        view = self.robot.core.mode(part, self.robot.model.require_mode(part, mode))
        wait_for = None if wait_for_s is None else seconds(wait_for_s)
        request = ModeRequest(part, mode, wait_for=wait_for)
        if view.can_enter:
            self.robot.give(request)
            return
        refused = _refusal(self.robot, request)
        if refused is None:
            assert wait_for is not None, "only a request that may wait is taken"
        else:
            assert refused == view.blockers


def _refusal(robot: CoreRobot, request: ModeRequest) -> tuple[Blocker, ...] | None:
    """Make a request; return its blockers if it is refused, or None if it is taken."""
    try:
        robot.give(request)
    except BlockedError as refusal:
        return refusal.blockers
    return None


def ask_mode(what: tuple[PartName, str], wait_for_s: float | None) -> Act:
    return lambda story: story.ask_mode(*what, wait_for_s)


def ask_state(part: PartName, transition: Transition) -> Act:
    def ask(story: Story) -> None:
        with suppress(PilothouseError):
            story.robot.give(TransitionRequest(part, transition))

    return ask


def cancel(story: Story) -> None:
    for view in story.robot.core.changes(1):
        story.robot.give(CancelRequest(view.id))


def fault(node: PartName, what: Fault | None) -> Act:
    return lambda story: story.robot.fault(node, what)


def read(signal: str, value: float | bool) -> Act:
    return lambda story: story.read(**{signal: value})


def hold(is_set: bool) -> Act:
    def set_or_release(story: Story) -> None:
        with suppress(PilothouseError):
            (story.robot.hold if is_set else story.robot.release)("charging")

    return set_or_release


ACTS: st.SearchStrategy[Act] = st.one_of(
    st.builds(ask_mode, MODES, st.sampled_from([None, None, 5.0])),
    st.builds(ask_mode, st.just((ACTUATION, PERFORMANCE)), st.sampled_from([None, 5.0])),
    st.builds(ask_state, PARTS, st.sampled_from(list(Transition)[:4])),
    st.just(cancel),
    st.builds(fault, NODES, st.sampled_from([*Fault, None, None])),
    st.builds(read, st.just("battery_level"), st.sampled_from([0.2, 0.9])),
    st.builds(read, st.just("temperature"), st.sampled_from([20.0, 52.0])),
    st.builds(read, st.just("estop"), st.booleans()),
    st.builds(hold, st.booleans()),
)
TURNS = st.tuples(ACTS, st.sampled_from([0.0, 0.1, 0.4, 1.0, 3.0]))


@settings(max_examples=STORIES, deadline=None)
@given(MODELS, st.lists(TURNS, max_size=12))
def test_every_change_ends_and_what_stands_has_a_reason(
    model: SmhModel, turns: list[tuple[Act, float]]
) -> None:
    story = Story(model)
    for act, then_s in turns:
        act(story)
        story.pass_time(then_s)
        _assert_stays_as_its_invariants_say(story)
    for node in model.nodes:
        story.robot.fault(node, None)
    story.read(battery_level=0.9, temperature=20.0, estop=False)
    story.pass_time(45)
    ends = {view.id: (view.status, view.ended_at) for view in story.robot.core.changes()}
    assert all(status.is_final for status, _ in ends.values()), "every change ends"
    _assert_one_step_at_a_time(story)
    for view in story.robot.core.parts().values():
        assert view.converged or view.deviation_reason, view.name
        assert view.converged or story.robot.core.why(view.name), view.name
    story.pass_time(10)
    later = {view.id: (view.status, view.ended_at) for view in story.robot.core.changes()}
    assert {change: later[change] for change in ends} == ends, "outcomes are final"


def _assert_stays_as_its_invariants_say(story: Story) -> None:
    core = story.robot.core
    for part in core.model.parts:
        for view in core.modes(part):
            holds = all(
                evaluate(Condition(text), core.facts) is Truth.TRUE for text in view.invariants
            )
            assert view.can_stay in (None, holds)


def _assert_one_step_at_a_time(story: Story) -> None:
    """Each node executes one step at a time, of whichever change."""
    under_way: dict[object, object] = {}
    for recorded in story.robot.events:
        data = recorded.event.data()
        if recorded.event.kind == "change.step_started":
            assert data["node"] not in under_way
            under_way[data["node"]] = data["change"]
        elif recorded.event.kind == "change.step_ended":
            assert under_way.pop(data["node"]) == data["change"]
