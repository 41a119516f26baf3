"""Conditions on a robot in all sorts of trouble, beside what its views say.

After each step of a random story every comparison has the value that follows from the views of the
robot, and every explanation ends in leaves; nothing that can be written raises.
"""

import itertools
import random
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from typing import TypeAlias

import pytest

from domain.conditions.condition import Condition
from domain.conditions.evaluation import Truth, evaluate
from domain.conditions.explanation import explain
from domain.conditions.tree import TopicKind, comparisons
from domain.conditions.watched import WatchedConditions
from domain.errors import PilothouseError
from domain.findings import Blocker
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault
from domain.snapshot import PartView, SignalView
from domain.state_and_mode import ModeName, PartName
from domain.supervision import Supervision
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import nested_model

STEPS = 60
PARTS = ("robot", "actuation", "drive_base", "manipulator", "lidar")
NODES = PARTS[2:]

Expected: TypeAlias = Callable[[Supervision], bool | None]
"""Whether a condition is true; None: unknown."""


def _part(core: Supervision, name: str) -> PartView:
    return core.part(PartName(name))


def _known(core: Supervision, name: str) -> bool:
    return _part(core, name).actual.state is not LifecycleState.UNKNOWN


def _signal(core: Supervision, name: str) -> SignalView | None:
    view = core.signal(name)
    return None if view.value is None or view.stale else view


def _state_is(name: str, state: str) -> Expected:
    return lambda core: _part(core, name).actual.state == state if _known(core, name) else None


def _mode_is_none_of(name: str, modes: tuple[str, ...]) -> Expected:
    return lambda core: _part(core, name).actual.mode not in modes if _known(core, name) else None


def _is_reachable(name: str) -> Expected:
    return lambda core: _part(core, name).reachable


def _has_converged(name: str) -> Expected:
    return lambda core: _part(core, name).converged


def _has_error(error: str) -> Expected:
    return lambda core: error in core.system_state().errors


def _is_held(owner: str) -> Expected:
    return lambda core: owner in core.driving.holds


def _of_parts() -> Iterator[tuple[str, Expected]]:
    for name in PARTS:
        part = f"part('{name}')"
        for state in ("active", "inactive", "finalized", "errorprocessing"):
            yield f"{part}.state == {state}", _state_is(name, state)
        modes = ("FAST", "PERFORMANCE")
        yield f"{part}.mode not in [{', '.join(modes)}]", _mode_is_none_of(name, modes)
        yield f"{part}.reachable", _is_reachable(name)
        yield f"{part}.converged", _has_converged(name)


def _of_the_robot() -> Iterator[tuple[str, Expected]]:
    for error in ("ESTOP", "BATTERY_LOW", "STALE_DATA"):
        yield f"error.{error}", _has_error(error)
    for owner in ("operator", "error", "vehicle"):
        yield f"hold.{owner}", _is_held(owner)
    yield "robot.state == ERROR", lambda core: core.system_state().state == "ERROR"
    yield "task.status == RUNNING_TASK", _runs
    yield "task.progress > 0.1", _is_under_way
    yield "vehicle.speed_mps > 0.5", _is_fast
    yield "battery_level >= 0.3", _is_charged
    yield "signal_strength == CONNECTED", _is_connected


def _runs(core: Supervision) -> bool:
    return core.system_state().task_status == "RUNNING_TASK"


def _is_under_way(core: Supervision) -> bool:
    task = core.driving.current_task
    return task is not None and task.progress > 0.1


def _is_fast(core: Supervision) -> bool | None:
    view = core.driving.vehicle
    if view.state is None or "vehicle" in core.driving.holds:
        return None
    return view.state.speed_mps > 0.5


def _is_charged(core: Supervision) -> bool | None:
    view = _signal(core, "battery_level")
    return None if view is None else float(view.value or 0.0) >= 0.3


def _is_connected(core: Supervision) -> bool | None:
    view = _signal(core, "signal_strength")
    return None if view is None else view.value == "CONNECTED"


EXPECTED = dict(itertools.chain(_of_parts(), _of_the_robot()))
TRUTHS = {True: Truth.TRUE, False: Truth.FALSE, None: Truth.UNKNOWN}


def _let_happen(robot: CoreRobot, rng: random.Random) -> None:
    """Let one thing happen, and some time pass; what the robot rejects changes nothing."""
    node = rng.choice(NODES)
    actions: list[Callable[[], object]] = [
        lambda: robot.read(**GOOD),
        lambda: robot.read(battery_level=rng.choice([0.1, 0.4, 0.9])),
        lambda: robot.read(estop=rng.random() < 0.5),
        lambda: robot.ask_mode("actuation", rng.choice(["PERFORMANCE", "MODERATE"])),
        lambda: robot.ask_mode("drive_base", "FAST"),
        lambda: robot.ask_transition("robot", rng.choice(["activate", "deactivate"])),
        lambda: robot.fault(node, rng.choice([Fault.DIE, Fault.SILENT, None])),
        lambda: robot.give(
            NodeReport(
                PartName(node),
                rng.choice([LifecycleState.ERROR_PROCESSING, LifecycleState.ACTIVE]),
            )
        ),
        robot.submit_task,
        robot.hold,
        robot.release,
        lambda: robot.lose_pose(lost=rng.random() < 0.5),
    ]
    with suppress(PilothouseError):
        rng.choice(actions)()
    robot.advance(rng.choice([0.0, 0.1, 0.7, 3.0]))


def _leaves(blocker: Blocker) -> Iterator[Blocker]:
    if not blocker.causes:
        yield blocker
    for cause in blocker.causes:
        yield from _leaves(cause)


@pytest.mark.parametrize("seed", range(6))
def test_conditions_say_what_the_views_say_whatever_happens(seed: int) -> None:
    rng = random.Random(seed)
    robot = CoreRobot(nested_model())
    conditions = {text: Condition(text) for text in EXPECTED}
    watched = WatchedConditions(robot.core.facts)
    watched.watch(conditions.values(), robot.now)
    for _ in range(STEPS):
        _let_happen(robot, rng)
        for condition in conditions.values():
            for leaf in comparisons(condition.root):
                watched.touch(leaf.subject.topic)
        watched.renew(robot.now)
        for text, condition in conditions.items():
            truth = TRUTHS[EXPECTED[text](robot.core)]
            assert evaluate(condition, robot.core.facts) is truth, text
            assert watched.truth(condition) is truth
            explanation = watched.explain(condition)
            assert (explanation == ()) is (truth is Truth.TRUE)
            for blocker in explanation:
                assert (blocker.since or 0) <= robot.now
                assert all(leaf.root_cause and leaf.message for leaf in _leaves(blocker))


def test_what_does_not_exist_is_unknown_and_never_raises() -> None:
    robot = CoreRobot(nested_model())
    for text in (
        *("no_signal < 1", "nobody.state == active", "nobody.mode == X", "nobody.reachable"),
        *("nobody.converged", "nobody.parameters.x < 1", "nobody.errors.E"),
        *("actuation.parameters.x < 1", "drive_base.parameters.x < 1", "hold('x y')"),
    ):
        condition = Condition(text)
        truth = evaluate(condition, robot.core.facts)

        assert truth is not Truth.TRUE
        assert explain(condition, robot.core.facts)
        (leaf,) = comparisons(condition.root)
        is_hold = leaf.subject.topic.kind is TopicKind.HOLD
        assert (truth is Truth.FALSE) is is_hold, text


# --- what the core keeps up to date by itself ----------------------------------------------------

MORE = (
    *("drive_base.parameters.max_speed > 0.5", "manipulator.parameters.max_torque > 0.12"),
    *("drive_base.parameters.other > 1", "vehicle.x_m > 0.5", "task.progress > 0.02"),
    *("drive_base.errors.UNREACHABLE", "actuation.errors.DEVIATES", "robot.state == RUNNING"),
    *("drive_base.errors.PARAMETERS_DRIFTED", "part('robot').errors.CHANGE_FAILED"),
)


def _guarded(conditions: tuple[Condition, ...]) -> SmhModel:
    """Return the nested model, with all conditions as guards of a mode."""
    guards = {ModeName("MODERATE"): ModeSettings(requires=conditions)}
    return replace(nested_model(), mode_settings={PartName("actuation"): guards})


def _set_a_parameter(robot: CoreRobot, rng: random.Random) -> None:
    """Let a node report a parameter; that may change nothing else about it."""
    name, value = (
        rng.choice(["max_speed", "max_torque", "other"]),
        rng.choice([0.1, 0.15, 0.9, 5.0]),
    )
    robot.give(NodeReport(PartName(rng.choice(NODES)), parameters={name: value}))


@pytest.mark.parametrize("seed", range(6))
def test_every_change_of_a_fact_reaches_the_guards_that_name_it(seed: int) -> None:
    rng = random.Random(seed)
    guards = tuple(map(Condition, (*EXPECTED, *MORE)))
    robot = CoreRobot(_guarded(guards))
    for _ in range(STEPS):
        rng.choice([_set_a_parameter, _let_happen, _let_happen])(robot, rng)
        for guard in guards:
            kept = robot.core.conditions.truth(guard)
            assert kept is evaluate(guard, robot.core.facts), guard.text
