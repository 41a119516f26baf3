"""A stall of the event loop, as a robot in virtual time lives through it."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.actor import Actor
from domain.inputs import (
    EmergencyStopRequest,
    HoldRequest,
    NodeReport,
    Reading,
    TaskRequest,
    TransitionRequest,
)
from domain.lifecycle import LifecycleState, Transition
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.robot import SimulatedRobot
from domain.snapshot import ChangeStatus, SystemState, TaskPhase
from domain.timebase import Instant, seconds
from service.catch_up import LATE, MOST_WINDOWS, WINDOW, CatchUp
from service.files.model_file import LoadedModel
from service.simulation.simulated import SimulatedBackend
from service.supervisor import Supervisor
from tests.support.live_robot import make_onboard, running
from tests.support.manual_clock import ManualClock
from tests.support.models import ACTUATION, BASE, actuation_model
from tests.support.paths import straight

STALL_S = 1.0
"""Longer than the age at which a pose is too old (0.3 s)."""


class Robot:
    """A supervised robot, and a clock that a test moves."""

    def __init__(self, nodes: dict[str, NodeSettings] | None = None) -> None:
        self.clock = ManualClock()
        model: SmhModel = actuation_model()
        by_name = {part: (nodes or {}).get(part, NodeSettings()) for part in model.nodes}
        robot = SimulatedRobot(model, 0, by_name, mock=True)
        self.backend = SimulatedBackend(robot, self.clock)
        self.supervisor = Supervisor(
            LoadedModel(model, (), ""),
            make_onboard(model, 0),
            self.clock,
            self.backend,
            self.backend.readings,
            simulated=robot.what,
        )
        self.core = self.supervisor.core

    async def drive(self) -> None:
        """Begin a task, and drive for two seconds."""
        await self.clock.advance(1)
        self.supervisor.submit(TaskRequest(straight(), 0, "stanley", 2.0))
        await self.clock.advance(2)
        assert self.task is TaskPhase.RUNNING

    async def stall(self, by_s: float = STALL_S) -> None:
        """Let no task run for a while, and then all that have something to do."""
        self.clock.stall(by_s)
        await self.clock.advance(0)

    @property
    def task(self) -> TaskPhase:
        """Return the status of the task that was served last."""
        return next(iter(self.core.driving.tasks())).status

    @property
    def holds(self) -> set[str]:
        """Return the owners of the holds."""
        return set(self.core.driving.holds)

    def told(self, kind: str) -> list[dict[str, object]]:
        """Return the data of all events of a kind."""
        return [dict(e.data) for e in self.supervisor.events.oldest_first() if e.kind == kind]


@pytest.fixture
async def robot() -> AsyncIterator[Robot]:
    robot = Robot()
    async with running(robot.supervisor):
        yield robot


# --- what arrived meanwhile ----------------------------------------------------------------------


async def test_a_task_goes_on_after_a_stall_that_the_poses_outlived(robot: Robot) -> None:
    await robot.drive()
    await robot.stall()
    assert (robot.task, robot.holds) == (TaskPhase.RUNNING, set())
    await robot.clock.advance(15)
    assert robot.task is TaskPhase.SUCCEEDED
    assert robot.told("hold.set") == []
    assert robot.told("service.stalled") == [{"late_s": pytest.approx(STALL_S, abs=0.051)}]


async def test_whoever_comes_first_after_a_stall_makes_nothing_too_old(robot: Robot) -> None:
    """A deadline and a request may come before the sockets are read."""
    await robot.drive()
    robot.clock.stall(STALL_S)
    robot.supervisor.let_pass()
    robot.supervisor.submit(HoldRequest("gate", "it is shut"))
    assert robot.holds == {"gate"}
    await robot.clock.advance(1)
    assert robot.holds == {"gate"}


async def test_signals_that_arrived_during_a_stall_are_not_stale(robot: Robot) -> None:
    await robot.clock.advance(1)
    assert robot.core.system_state().state is SystemState.IDLE
    robot.clock.stall(5)
    robot.supervisor.let_pass()
    await robot.clock.advance(1)
    assert robot.told("error.raised") == []


async def test_a_node_that_arrived_during_a_stall_has_not_timed_out() -> None:
    robot = Robot({"drive_base": NodeSettings(configure=seconds(9.9))})
    async with running(robot.supervisor):
        await robot.clock.advance(1)
        change = robot.supervisor.submit(TransitionRequest(ACTUATION, Transition.CONFIGURE)).change
        assert change is not None
        await robot.clock.advance(9)
        robot.clock.stall(15)
        robot.supervisor.let_pass()
        await robot.clock.advance(1)
        assert robot.core.change(change).status is ChangeStatus.SUCCEEDED


async def test_whoever_waits_for_a_change_learns_of_an_end_that_arrived_in_time() -> None:
    robot = Robot({"drive_base": NodeSettings(configure=seconds(2))})
    async with running(robot.supervisor):
        await robot.clock.advance(1)
        change = robot.supervisor.submit(TransitionRequest(BASE, Transition.CONFIGURE)).change
        assert change is not None
        waiting = asyncio.ensure_future(robot.supervisor.change_ends.wait(change, 2.5))
        await robot.clock.advance(1.9)
        await robot.stall()
        await robot.clock.advance(0.1)
        assert (await waiting).status is ChangeStatus.SUCCEEDED


async def test_a_stop_takes_effect_at_once_after_a_stall(robot: Robot) -> None:
    await robot.drive()
    robot.clock.stall(STALL_S)
    robot.supervisor.submit(EmergencyStopRequest(engaged=True, reason="", actor=Actor("test")))
    assert robot.core.driving.vehicle.command.speed_mps == 0.0
    assert robot.core.system_state().errors == ("ESTOP",)


async def test_an_error_that_a_reading_shows_is_raised_at_once_after_a_stall(
    robot: Robot,
) -> None:
    await robot.drive()
    robot.clock.stall(STALL_S)
    robot.supervisor.readings.submit([Reading("temperature", 90.0)])
    assert "TEMPERATURE_HIGH" in robot.core.system_state().errors


# --- what did not arrive -------------------------------------------------------------------------


async def test_a_pose_that_does_not_come_is_too_old_in_spite_of_the_stall(robot: Robot) -> None:
    await robot.drive()
    robot.backend.set_vehicle_fault("silent")
    await robot.clock.advance(0.1)
    await robot.stall()
    await robot.clock.advance(0.06)
    assert robot.holds == {"vehicle"}
    assert robot.core.driving.vehicle.command.speed_mps == 0.0


async def test_a_node_that_does_nothing_times_out_in_spite_of_the_stall(robot: Robot) -> None:
    await robot.clock.advance(1)
    robot.backend.set_fault(BASE, Fault.SILENT)
    change = robot.supervisor.submit(TransitionRequest(BASE, Transition.CONFIGURE)).change
    assert change is not None
    await robot.clock.advance(9.9)
    await robot.stall()
    await robot.clock.advance(3)
    assert robot.core.change(change).status is ChangeStatus.TIMED_OUT


async def test_a_reading_that_does_not_come_is_stale_in_spite_of_the_stall(robot: Robot) -> None:
    await robot.clock.advance(1)
    assert robot.backend.mock is not None
    robot.backend.mock.set_publishing("temperature", False)
    await robot.clock.advance(1.9)
    await robot.stall()
    await robot.clock.advance(0.06)
    assert robot.core.system_state().errors == ("STALE_DATA",)


# --- how much is told ----------------------------------------------------------------------------


async def test_a_turn_that_is_a_little_late_is_not_told(robot: Robot) -> None:
    await robot.clock.advance(1)
    await robot.stall(0.2)
    await robot.clock.advance(1)
    assert robot.told("service.stalled") == []


async def test_stalls_that_come_again_and_again_are_told_once_in_ten_seconds(
    robot: Robot,
) -> None:
    await robot.clock.advance(1)
    for _ in range(15):
        await robot.stall(0.5)
        await robot.clock.advance(0.5)
    assert 1 <= len(robot.told("service.stalled")) <= 2


# --- a node that reports by hand -----------------------------------------------------------------


async def test_what_arrives_within_the_window_comes_before_what_was_due(robot: Robot) -> None:
    robot.backend.set_fault(BASE, Fault.SILENT)
    change = robot.supervisor.submit(TransitionRequest(BASE, Transition.CONFIGURE)).change
    assert change is not None
    await robot.clock.advance(9.9)
    robot.clock.stall(STALL_S)
    robot.supervisor.let_pass()
    robot.supervisor.deliver(NodeReport(BASE, LifecycleState.INACTIVE, reachable=True))
    assert robot.core.change(change).status is ChangeStatus.SUCCEEDED


# --- the window itself ---------------------------------------------------------------------------


class Ticking:
    """A catch-up whose tick a test says."""

    def __init__(self) -> None:
        self.tick_due: Instant | None = 0
        self.catch_up = CatchUp(ManualClock(), lambda: self.tick_due)


def test_deadlines_do_not_wait_before_the_first_tick() -> None:
    ticking = Ticking()
    ticking.tick_due = None
    assert not ticking.catch_up.is_on(seconds(100))


def test_a_loop_that_is_hardly_late_lets_nothing_wait() -> None:
    assert not Ticking().catch_up.is_on(LATE)


def test_deadlines_wait_for_one_window_after_a_stall() -> None:
    ticking, stalled = Ticking(), LATE + 1
    assert ticking.catch_up.is_on(stalled)
    assert ticking.catch_up.until == stalled + WINDOW
    ticking.tick_due = stalled + seconds(0.05)
    assert ticking.catch_up.is_on(stalled + WINDOW - 1)
    assert not ticking.catch_up.is_on(stalled + WINDOW)
    assert ticking.catch_up.until is None


def test_a_tick_that_is_late_lets_deadlines_wait_though_the_next_one_is_not() -> None:
    ticking, stalled = Ticking(), LATE + 1
    ticking.catch_up.note_tick(stalled)
    ticking.tick_due = stalled + seconds(0.05)
    assert ticking.catch_up.is_on(stalled)


def test_a_window_that_passed_unused_does_not_hide_the_next_stall() -> None:
    ticking, stalled = Ticking(), LATE + 1
    ticking.catch_up.note_tick(stalled)
    again = stalled + seconds(10)
    ticking.catch_up.note_tick(again)
    ticking.tick_due = again + seconds(0.05)
    assert ticking.catch_up.is_on(again)


def test_a_tick_does_not_end_a_window_that_no_deadline_was_judged_after() -> None:
    ticking, now = Ticking(), LATE + 1
    for _ in range(MOST_WINDOWS):
        ticking.catch_up.is_on(now)
        now += seconds(1)
    ticking.catch_up.note_tick(now)
    assert not ticking.catch_up.is_on(now)


def test_deadlines_are_judged_in_the_end_however_late_the_loop_is() -> None:
    ticking, now, waited = Ticking(), LATE + 1, 0
    while ticking.catch_up.is_on(now):
        waited += 1
        now += seconds(1)
    assert waited == MOST_WINDOWS
