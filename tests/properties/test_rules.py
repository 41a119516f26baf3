"""Whatever happens to a robot with rules: they do not fight, and what is requested is reached.

`make soak` plays 10,000 stories, `make test` 300.
"""

import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from typing import TypeAlias

import hypothesis.strategies as st
from hypothesis import given, settings

from domain.commands import AskTransition
from domain.errors import PilothouseError
from domain.lifecycle import Transition
from domain.parts.system_model import NodeModel, Rule, SmhModel, SystemModel
from domain.reactions.settings import MAX_FIRINGS, MAX_RETURNS, WINDOW
from domain.simulation.node_settings import Fault
from domain.snapshot import Because
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from domain.timebase import Instant
from tests.support.models import active, inactive
from tests.support.ruled_robot import RuledRobot

STORIES = 10_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 300

Act: TypeAlias = Callable[[RuledRobot], object]

MODES = (DEFAULT_MODE, ModeName("SLOW"), ModeName("FAST"))
NODES = tuple(PartName(name) for name in ("camera", "guard", "arm"))
INNER, OUTER = PartName("inner"), PartName("outer")
PAIRS = (inactive(), *(active(mode) for mode in MODES))
WAITS = st.sampled_from([0.0, 0.3, 0.9, 1.1, 1.1, 2.5, 2.5, 10.0])


# --- robots --------------------------------------------------------------------------------------


@st.composite
def models(draw: st.DrawFn) -> SmhModel:
    """Return a system in another one, with rules of both about any of the parts."""
    nodes = {
        name: NodeModel(name, {mode: {"p": number} for number, mode in enumerate(MODES)})
        for name in NODES
    }
    outer_parts = (INNER, NODES[2])
    systems = {
        OUTER: _system(draw, OUTER, outer_parts),
        INNER: _system(draw, INNER, NODES[:2]),
    }
    return SmhModel(nodes, systems)


def _system(draw: st.DrawFn, name: PartName, parts: Sequence[PartName]) -> SystemModel:
    wants = {mode: {part: draw(st.sampled_from(PAIRS)) for part in parts} for mode in MODES}
    # What tells the modes apart: each wants the first part in its own.
    for mode in MODES:
        wants[mode][parts[0]] = active(mode)
    rules = [
        Rule(f"{name}_{number}", *draw(_conditions(parts)), draw(st.sampled_from(PAIRS)))
        for number in range(draw(st.integers(3, 8)))
    ]
    return SystemModel(name, wants, tuple(rules))


@st.composite
def _conditions(
    draw: st.DrawFn, parts: Sequence[PartName]
) -> tuple[StateAndMode, tuple[PartName, StateAndMode]]:
    part, pair = draw(st.sampled_from(parts)), draw(st.sampled_from(PAIRS))
    return active(draw(st.sampled_from(MODES))), (part, pair)


# --- what happens --------------------------------------------------------------------------------


def _ask(part: PartName, mode: str) -> Act:
    return lambda robot: robot.ask_mode(part, mode)


def _ask_transition(part: PartName, transition: Transition) -> Act:
    return lambda robot: robot.ask_transition(part, transition)


def _set(node: PartName, mode: str) -> Act:
    return lambda robot: robot.somebody_sets(node, mode)


def _trigger(node: PartName, transition: Transition) -> Act:
    return lambda robot: robot.nodes.handle(AskTransition(0, node, transition), robot.now)


def _break(node: PartName, fault: Fault | None) -> Act:
    return lambda robot: robot.fault(node, fault)


def _stop(robot: RuledRobot) -> None:
    robot.stop()


def _release(robot: RuledRobot) -> None:
    robot.release_stop()


PARTS = st.sampled_from([OUTER, INNER, *NODES])
ANY_NODE = st.sampled_from(NODES)
MOVES = (Transition.ACTIVATE, Transition.DEACTIVATE)
ACTS: st.SearchStrategy[Act] = st.one_of(
    st.builds(_ask, PARTS, st.sampled_from(MODES)),
    st.builds(_ask_transition, PARTS, st.sampled_from(MOVES)),
    st.builds(_set, ANY_NODE, st.sampled_from(MODES)),
    st.builds(_set, ANY_NODE, st.sampled_from(MODES)),
    st.builds(_trigger, ANY_NODE, st.sampled_from(MOVES)),
    st.builds(_break, ANY_NODE, st.sampled_from([None, None, Fault.REFUSE, Fault.DIE])),
    st.sampled_from([_stop, _release, _release, RuledRobot.come_back]),
)
STORY = st.lists(st.tuples(ACTS, WAITS), min_size=8, max_size=25)


class Story:
    """A robot, and what a bystander counts."""

    def __init__(self, model: SmhModel) -> None:
        self.robot = RuledRobot(model)
        # Nothing is about the vehicle, whose reports would be most of the work.
        self.robot.lose_pose()
        self.began: dict[object, list[Instant]] = defaultdict(list)
        self.returned: dict[object, list[Instant]] = defaultdict(list)
        self._seen = 0

    def play(self, act: Act, wait_s: float) -> None:
        """Let something happen that may be rejected, and some time pass."""
        with suppress(PilothouseError):
            act(self.robot)
        self.look()
        self.robot.advance(wait_s)
        self.look()

    def look(self) -> None:
        """Check what is shown, and count what rules did."""
        self._check_targets()
        # A restart begins the list anew.
        self._seen = min(self._seen, len(self.robot.events))
        events = self.robot.events[self._seen :]
        begun_by = {change.cause for change in self.robot.core.changes()}
        self._seen = len(self.robot.events)
        for event in events:
            if event.kind == "target.displacement_began":
                self.began[event.data["part"], event.data["rule"]].append(event.at)
            if event.kind == "target.displacement_ended" and event.id in begun_by:
                # Without a change, something else is in force: nothing returns.
                self.returned[event.data["part"]].append(event.at)
        if self.robot.core.emergency_stop().engaged:
            activated = [
                command
                for command in self.robot.commands
                if isinstance(command, AskTransition) and command.transition is Transition.ACTIVATE
            ]
            assert activated == [], "nothing is activated under ESTOP"
        self.robot.commands.clear()

    def _check_targets(self) -> None:
        for part in self.robot.core.parts().values():
            pursued = part.effective_target
            if pursued is None:
                assert part.target is None
            elif pursued.because is Because.REQUESTED:
                assert part.target == StateAndMode(pursued.state, pursued.mode)
                assert (pursued.rule, pursued.cause, pursued.blockers) == (None, None, ())
            else:
                assert pursued.because is Because.RULE
                assert pursued.rule
                assert pursued.cause
                assert pursued.blockers


def within_bound(times: Iterable[Instant], most: int) -> bool:
    """Tell whether nothing happened more often within the window than it may."""
    ordered = sorted(times)
    return all(later - ordered[number] >= WINDOW for number, later in enumerate(ordered[most:]))


@settings(max_examples=STORIES, deadline=None)
@given(models(), STORY, st.sampled_from(MODES))
def test_rules_keep_their_bounds_and_what_is_requested_is_reached_and_stays(
    model: SmhModel, story: list[tuple[Act, float]], wanted: ModeName
) -> None:
    told = Story(model)
    robot = told.robot
    told.play(_ask(OUTER, DEFAULT_MODE), 2.5)
    for act, wait_s in story:
        told.play(act, wait_s)
    restarts = robot.boot - 1

    for node in NODES:
        robot.fault(node, None)
    told.look()
    robot.release_stop()
    robot.advance(30)
    told.look()
    robot.ask_mode(OUTER, wanted)
    robot.advance(30)
    told.look()

    assert robot.actual(OUTER) == f"active.{wanted}"
    assert robot.target(OUTER) == f"active.{wanted}"
    changes = len(robot.core.changes())
    robot.advance(200)
    told.look()
    assert robot.actual(OUTER) == f"active.{wanted}"
    assert len(robot.core.changes()) == changes, "nothing fights"
    assert all(robot.core.part(part).converged for part in (OUTER, INNER, *NODES))
    if not restarts:
        assert all(within_bound(times, MAX_FIRINGS) for times in told.began.values())
        assert all(within_bound(times, MAX_RETURNS) for times in told.returned.values())
