"""What may happen to a robot in its life: faults, requests and drives, at random."""

from collections.abc import Callable
from contextlib import suppress
from random import Random

import numpy as np

from domain.actor import Actor
from domain.errors import PilothouseError
from domain.health.chatter import WITHIN
from domain.inputs import (
    AcknowledgeRequest,
    BackendStatus,
    CancelRequest,
    DriveStatus,
    ModeRequest,
    ParametersRequest,
    ReportBacklog,
    ServiceStall,
    SignalValue,
    SourceFault,
    StorageStatus,
    TransitionRequest,
    WriteRecord,
)
from domain.lifecycle import Transition
from domain.parameters import Parameters
from domain.paths.path import Path
from domain.simulation.node_settings import Fault
from domain.state_and_mode import ModeName
from domain.tasks.holds import RESTART_HOLD
from domain.timebase import seconds, to_seconds
from domain.tracking.trackers import TRACKERS
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import BASE

ADA = Actor("ada", "http", "10.0.0.7")
OWNERS = ("cell", "gate", "operator")
_POINTS = 20
_CALM_S = 70.0
"""After so long without a request every change has ended."""
_READ_EVERY_S = 30.0
_STOPS_WITHIN_S = 5.0
_TURNS = 10
"""How often each node is lost and found again, before a day ends."""


def let_happen(robot: CoreRobot, rng: Random, for_s: float, pause_s: float) -> None:
    """Let whatever may happen do so for a while, with pauses that are so long on the average."""
    end = robot.now + seconds(for_s)
    while robot.now < end:
        if rng.random() < 0.7:
            robot.read(**GOOD)
        # Some are rejected, which must change nothing either.
        with suppress(PilothouseError):
            rng.choice(_HAPPENINGS)(robot, rng)
        robot.advance(rng.choice((0.0, 0.01, rng.expovariate(1.0 / (2.0 * pause_s)))))


def calm_down(robot: CoreRobot) -> None:
    """Mend all that is broken, take back all that was asked, and wait until nothing goes on."""
    robot.lose_pose(lost=False)
    for status in (BackendStatus(True), DriveStatus(True), StorageStatus(True)):
        robot.give(status)
    robot.give(ReportBacklog("ros", None))
    robot.cancel_task()
    robot.release_stop()
    for owner in (*OWNERS, RESTART_HOLD):
        robot.release(owner)
    _wait(robot, _CALM_S)
    _bring_up(robot)
    # Of errors that came and went ten minutes are remembered, and each turn forgets two older ones.
    _wait(robot, to_seconds(WITHIN))
    for _ in range(_TURNS):
        _lose_and_find(robot)
    _bring_up(robot)
    # Always the same, so that what is known of the last one is as large.
    _drive(robot, Random(1))
    robot.advance(1.0)
    robot.cancel_task()
    robot.advance(_STOPS_WITHIN_S)
    assert not robot.core.open_errors()
    assert not robot.core.driving.holds


def _bring_up(robot: CoreRobot) -> None:
    """Bring all parts to a mode, whatever has become of them, and leave no error open."""
    _lose_and_find(robot)
    # A change that failed stands until one that drives the part succeeds.
    robot.ask_mode("robot", "RACE")
    _wait(robot, _CALM_S)
    # Of errors that nobody has seen, those of other days would be listed.
    for view in tuple(robot.core.open_errors().values()):
        robot.give(AcknowledgeRequest(view.key.error, ADA, view.key.part))
    robot.advance(1.0)


def _lose_and_find(robot: CoreRobot) -> None:
    """Let the process of each node die and start again, one after the other.

    A service that was started again has not heard of nodes that stayed as they were.
    """
    for node in sorted(robot.model.nodes):
        robot.fault(node, Fault.DIE)
        robot.advance(1.0)
        robot.fault(node, None)
        robot.advance(1.0)


def _wait(robot: CoreRobot, for_s: float) -> None:
    """Let time pass in which the signals are good."""
    end = robot.now + seconds(for_s)
    while robot.now < end:
        robot.read(**GOOD)
        robot.advance(_READ_EVERY_S)


def _read(robot: CoreRobot, rng: Random) -> None:
    values = dict(GOOD)
    if rng.random() < 0.5:
        name = rng.choice(sorted(values))
        bad: dict[str, SignalValue] = {"estop": True, "signal_strength": "NOT_CONNECTED"}
        values[name] = bad.get(name, rng.choice((0.0, 99.5)))
    robot.read(**values)


def _drive(robot: CoreRobot, rng: Random) -> None:
    """Submit a bend from where the vehicle is."""
    state = robot.core.driving.vehicle.state
    if state is None:
        return
    xs = np.linspace(0.0, rng.uniform(5.0, 40.0), _POINTS)
    ys = np.sin(xs / 9.0) * rng.uniform(0.0, 2.0)
    c, s = np.cos(state.pose.yaw_rad), np.sin(state.pose.yaw_rad)
    places = np.column_stack((xs, ys)) @ np.array([[c, s], [-s, c]])
    places += (state.pose.x_m, state.pose.y_m)
    # It may have gone far in a week; further than coordinates reach it cannot.
    yaws = np.full(_POINTS, state.pose.yaw_rad)
    path = Path(np.column_stack((places, yaws)))
    speed_mps = rng.choice((0.5, 1.5, 2.8))
    robot.submit_task(path, controller=rng.choice(sorted(TRACKERS)), speed_mps=speed_mps)


def _ask(robot: CoreRobot, rng: Random) -> None:
    part = rng.choice(robot.model.parts)
    kind = rng.randrange(4)
    if kind == 0:
        values: Parameters = {"max_speed": rng.choice((0.25, 1.0)), "controller": "PID"}
        robot.give(ParametersRequest(BASE, values, ADA))
    elif kind == 1:
        robot.give(TransitionRequest(part, rng.choice(list(Transition)), ADA))
    else:
        modes = [*robot.model.modes_of(part), ModeName("NO_SUCH")]
        robot.give(ModeRequest(part, rng.choice(modes), ADA))


def _cancel_change(robot: CoreRobot, rng: Random) -> None:
    changes = robot.core.changes(20)
    if changes:
        robot.give(CancelRequest(rng.choice(changes).id, ADA))


def _break_or_mend(robot: CoreRobot, rng: Random) -> None:
    robot.fault(rng.choice(sorted(robot.model.nodes)), rng.choice([None, None, *Fault]))


_HAPPENINGS: tuple[Callable[[CoreRobot, Random], object], ...] = (
    *(_read, _drive, _ask) * 4,
    *(_break_or_mend,) * 2,
    _cancel_change,
    lambda robot, rng: robot.stop(),
    *(lambda robot, rng: robot.release_stop(),) * 3,
    lambda robot, rng: robot.hold(rng.choice(OWNERS)),
    *(lambda robot, rng: robot.release(rng.choice((*OWNERS, RESTART_HOLD))),) * 5,
    lambda robot, rng: robot.cancel_task(),
    *(lambda robot, rng: robot.acknowledge("TEMPERATURE_HIGH"),) * 3,
    lambda robot, rng: robot.lose_pose(lost=rng.random() < 0.3),
    lambda robot, rng: robot.give(BackendStatus(rng.random() < 0.7, "no network")),
    lambda robot, rng: robot.give(DriveStatus(rng.random() < 0.7, "no driver")),
    lambda robot, rng: robot.give(
        SourceFault("temperature", rng.choice(["a", "b"]), rng.choice(["no bus", "no file"]))
    ),
    lambda robot, rng: robot.give(StorageStatus(rng.random() < 0.5, "disk full")),
    lambda robot, rng: robot.give(ReportBacklog("ros", rng.choice((None, robot.now)))),
    lambda robot, rng: robot.give(WriteRecord("POST", "/tasks", 201, "10.0.0.7:5", ADA)),
    lambda robot, rng: robot.give(ServiceStall(seconds(rng.uniform(0.3, 3.0)))),
)
