"""Whenever the service dies: nothing is forgotten, nothing moves by itself, and the task goes on.

`make soak` tells 3,000 stories, `make test` 40.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import hypothesis.strategies as st
import numpy as np
from hypothesis import HealthCheck, given, settings

from domain.commands import Drive
from domain.health.signals import Recovery, SignalSettings
from domain.inputs import TaskRequest
from domain.parts.system_model import SmhModel
from domain.paths.path import Path
from domain.simulation.vehicle_settings import Plant, VehicleSettings
from domain.snapshot import EmergencyStopView, HoldView, TaskPhase, TaskView
from domain.supervision import SupervisionSettings
from domain.tasks.holds import RESERVED, RESTART_HOLD
from domain.tasks.kept_tasks import LOST_AT_MOST
from domain.timebase import seconds, to_seconds
from domain.vehicle import Pose
from service.files.robot_settings import SignalsBlock
from tests.support.drives import through
from tests.support.good import GOOD
from tests.support.paths import straight
from tests.support.restarting_robot import RestartingRobot

PLANT = Plant(acceleration_mps2=1.0, braking_mps2=1.0, delay=seconds(0.05))
PATHS: dict[str, Path] = {
    "short": straight(8.0),
    "long": straight(60.0),
    "beside": straight(30.0, y_m=2.0),
    "right angle": through(
        *((float(x), 0.0) for x in range(16)), *((15.0, y) for y in range(1, 16))
    ),
}
FASTEST_MPS = 2.8
MAY_BE_LOST_M = to_seconds(LOST_AT_MOST) * FASTEST_MPS
OWNERS = ("operator", "gate-3")


def waiting_signals() -> tuple[SignalSettings, ...]:
    """Return the signals, none of which becomes stale; the temperature is to be acknowledged."""
    return tuple(
        replace(item, recovery=Recovery.ACKNOWLEDGE) if item.spec.name == "temperature" else item
        for item in SignalsBlock(stale_after_s=0.0).to_domain()
    )


@dataclass(frozen=True, slots=True)
class Shown:
    """What an operator sees of that which must not be forgotten."""

    holds: dict[str, HoldView]
    stop: EmergencyStopView
    to_acknowledge: dict[str, str | None]
    ended: list[TaskView]
    current: TaskView | None

    @classmethod
    def of(cls, robot: RestartingRobot) -> "Shown":
        """Look at a robot."""
        core = robot.core
        tasks = list(core.driving.tasks())
        return cls(
            {o: h for o, h in core.driving.holds.items() if o not in (*RESERVED, RESTART_HOLD)},
            replace(core.emergency_stop(), standstill_at=None),
            {s: v.error for s, v in core.signals().items() if v.needs_acknowledgement},
            [task for task in tasks if task.ended_at is not None],
            core.driving.current_task,
        )


# --- what happens --------------------------------------------------------------------------------


def submit(robot: RestartingRobot, name: str) -> None:
    """Submit a path that begins where the vehicle stands; one that moves is not asked to turn."""
    state = robot.core.driving.vehicle.state
    if state is None or abs(state.speed_mps) > 0.01:
        return
    robot.give(TaskRequest(seen_from(state.pose, PATHS[name]), 0, "pure_pursuit", FASTEST_MPS))


def seen_from(pose: Pose, path: Path) -> Path:
    """Return a path with its origin at a pose."""
    c, s = np.cos(pose.yaw_rad), np.sin(pose.yaw_rad)
    places = path.waypoints[:, :2] @ np.array([[c, s], [-s, c]]) + (pose.x_m, pose.y_m)
    return Path(np.column_stack((places, path.waypoints[:, 2])))


ACTS: dict[str, Callable[[RestartingRobot, Any], object]] = {
    "submit": submit,
    "hold": lambda robot, owner: robot.hold(owner),
    "release": lambda robot, owner: robot.release(owner),
    "stop": lambda robot, _: robot.stop(),
    "release the stop": lambda robot, _: robot.release_stop(),
    "read": lambda robot, degrees: robot.read(**{**GOOD, "temperature": degrees}),
    "acknowledge": lambda robot, _: robot.acknowledge("TEMPERATURE_HIGH"),
    "cancel": lambda robot, _: robot.cancel_task(),
    "wait": lambda robot, by_s: robot.advance(by_s),
}
Step: TypeAlias = tuple[str, object, float | None]
"""What happens, with what, and how long the service is down thereafter; None: it goes on."""


def steps() -> st.SearchStrategy[Step]:
    """Generate what happens next."""
    durations = st.floats(0.01, 12.0)
    acts = st.one_of(
        st.tuples(st.just("submit"), st.sampled_from(sorted(PATHS))),
        st.tuples(st.just("hold"), st.sampled_from(OWNERS)),
        st.tuples(st.just("release"), st.sampled_from((*OWNERS, RESTART_HOLD))),
        st.tuples(st.sampled_from(("stop", "release the stop", "acknowledge")), st.none()),
        st.tuples(st.just("read"), st.sampled_from((20.0, 60.0))),
        st.tuples(st.just("cancel"), st.none()),
        st.tuples(st.just("wait"), durations),
        st.tuples(st.just("wait"), durations),
    )
    return st.tuples(acts, st.none() | st.floats(0.0, 5.0)).map(lambda step: (*step[0], step[1]))


# --- what has to hold ----------------------------------------------------------------------------


def restart(robot: RestartingRobot, down_s: float) -> None:
    """Kill the service, start it again, and look at what is left of it."""
    before = Shown.of(robot)
    robot.restart(down_s)
    after = Shown.of(robot)
    assert after.holds == before.holds
    assert after.stop == before.stop
    assert {s: e for s, e in after.to_acknowledge.items() if s != "estop"} == before.to_acknowledge
    assert robot.core.emergency_stop().engaged is ("ESTOP" in robot.core.system_state().errors)
    assert after.ended == before.ended
    compare(before.current, after.current)
    assert (RESTART_HOLD in robot.core.driving.holds) is (after.current is not None)
    nothing_moves(robot, 0.2)
    again = Shown.of(robot)
    robot.restart(0.0)
    compare(again.current, robot.core.driving.current_task, lost_m=0.0)
    assert replace(Shown.of(robot), current=again.current) == again
    nothing_moves(robot, 3.0)


def compare(before: TaskView | None, after: TaskView | None, lost_m: float = MAY_BE_LOST_M) -> None:
    """Look whether a task is the same, with all of its progress but what was driven last."""
    if before is None or after is None:
        assert before is after
        return
    assert after.status is TaskPhase.PAUSED
    assert 0.0 <= before.distance_m - after.distance_m <= lost_m
    same = replace(
        before,
        status=after.status,
        reason=after.reason,
        target_index=after.target_index,
        progress=after.progress,
        distance_m=after.distance_m,
        cross_track_error_m=after.cross_track_error_m,
    )
    assert after == same


def nothing_moves(robot: RestartingRobot, for_s: float) -> None:
    """Let time pass after a restart, in which nobody asks for anything."""
    robot.read(**GOOD)
    robot.advance(for_s)
    drives = [command for command in robot.commands if isinstance(command, Drive)]
    assert all(drive.command.speed_mps == 0.0 for drive in drives)
    assert robot.happened("task.started") == robot.happened("task.resumed") == []


def finish(robot: RestartingRobot) -> None:
    """Release everything, and drive to the end."""
    robot.read(**GOOD)
    robot.release_stop()
    robot.advance(0.5)
    for error in robot.core.system_state().errors:
        robot.acknowledge(error)
    for owner in (*OWNERS, RESTART_HOLD):
        robot.release(owner)
    current = robot.core.driving.current_task
    for _ in range(120):
        if robot.core.driving.current_task is None:
            break
        robot.advance(1.0)
    assert list(robot.core.system_state().reasons) == []
    if current is not None:
        task = robot.core.driving.task(current.id)
        assert (task.status, task.reason, task.progress) == (TaskPhase.SUCCEEDED, None, 1.0)


SOAK = bool(os.environ.get("PILOTHOUSE_SOAK"))


@settings(
    max_examples=3_000 if SOAK else 40, suppress_health_check=[HealthCheck.too_slow], deadline=None
)
@given(st.lists(steps(), min_size=1, max_size=12))
def test_a_restart_forgets_nothing_and_moves_nothing(story: list[Step]) -> None:
    known = SupervisionSettings(waiting_signals())
    robot = RestartingRobot(SmhModel({}, {}), known, VehicleSettings(plant=PLANT))
    robot.read(**GOOD)
    robot.advance(0.1)
    submit(robot, "long")
    robot.advance(1.0)
    for act, argument, down_s in story:
        ACTS[act](robot, argument)
        if down_s is not None:
            restart(robot, down_s)
    finish(robot)
