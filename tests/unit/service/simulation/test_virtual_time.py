import asyncio
from collections.abc import Callable
from typing import Any, Protocol, TypeAlias

import numpy as np

from domain.actor import Actor
from domain.events.event import RecordedEvent
from domain.inputs import (
    EmergencyStopRequest,
    HoldRequest,
    ModeRequest,
    Reading,
    ReleaseRequest,
    TaskRequest,
)
from domain.paths.path import Path
from domain.simulation.node_settings import Fault
from domain.simulation.robot import SimulatedRobot
from domain.snapshot import ChangeStatus
from domain.timebase import seconds, to_seconds
from service.event_log import EventLog
from service.files.model_file import LoadedModel
from service.simulation.simulated import SimulatedBackend
from service.simulation.virtual_time import VirtualService
from service.supervisor import Supervisor
from service.virtual_clock import VirtualClock
from tests.support.live_robot import make_onboard, running
from tests.support.manual_clock import START, ManualClock
from tests.support.models import ACTUATION, BASE, PERFORMANCE, actuation_model

MODEL = actuation_model()
LOADED = LoadedModel(model=MODEL, warnings=(), text="")


def virtual(start_s: float = 0.0, *, mock: bool = True) -> VirtualService:
    start = seconds(start_s)
    return VirtualService(
        LOADED,
        make_onboard(MODEL, start),
        SimulatedRobot(MODEL, start, mock=mock),
        VirtualClock(start, START),
        EventLog(epoch="test"),
    )


def straight(length_m: float) -> Path:
    x = np.linspace(0.0, length_m, round(length_m / 0.5) + 1)
    return Path(np.column_stack((x, np.zeros_like(x), np.zeros_like(x))))


def happened(log: EventLog) -> list[tuple[float, str]]:
    """Return when, in seconds, and what happened, without what happens all the time."""
    often = ("signal.read", "vehicle.reported", "task.progress")
    return [
        (to_seconds(event.at), event.kind)
        for event in log.oldest_first()
        if event.kind not in often
    ]


def test_nothing_has_happened_before_time_passes() -> None:
    robot = virtual(50.0)

    assert happened(robot.supervisor.events) == []
    assert robot.clock.now() == seconds(50.0)


def test_what_is_due_at_the_end_of_a_time_is_part_of_it() -> None:
    robot = virtual()
    robot.advance_to(0)
    assert robot.supervisor.core.part(BASE).reachable

    robot.supervisor.submit(ModeRequest(BASE, "FAST"))
    robot.advance_to(seconds(0.3) - 1)
    assert robot.supervisor.core.part(BASE).actual.state_and_mode.label == "configuring"
    robot.advance_to(seconds(0.3))
    assert robot.supervisor.core.part(BASE).actual.state_and_mode.label != "configuring"
    assert robot.clock.now() == seconds(0.3)


def test_a_change_ends_in_virtual_time() -> None:
    robot = virtual()
    robot.advance_to(seconds(1))
    change = robot.supervisor.submit(ModeRequest(ACTUATION, PERFORMANCE)).change
    assert change is not None
    robot.advance_to(seconds(3))

    assert robot.supervisor.core.change(change).status is ChangeStatus.SUCCEEDED


async def test_who_waits_for_a_change_gets_it_at_once_as_it_is() -> None:
    robot = virtual()
    robot.advance_to(0)
    change = robot.supervisor.submit(ModeRequest(ACTUATION, PERFORMANCE)).change
    assert change is not None
    view = await asyncio.wait_for(robot.supervisor.change_ends.wait(change, 60), 5)

    assert view.status is ChangeStatus.RUNNING


def test_deadlines_of_the_core_are_kept_between_what_the_robot_says() -> None:
    robot = virtual()
    robot.advance_to(seconds(1.03))
    assert robot.backend.mock is not None
    robot.backend.mock.set_publishing("temperature", False)
    robot.supervisor.readings.submit([Reading("temperature", 20.0)], source="test")
    robot.advance_to(seconds(5))

    raised = [event.at for event in told(robot.supervisor.events) if event.kind == "error.raised"]
    # Stale is what is older than 2 s, by a nanosecond at least.
    assert raised == [seconds(3.03) + 1]


def test_the_robot_is_advanced_no_more_often_than_it_wants() -> None:
    robot = virtual(mock=False)
    advanced: list[float] = []
    advance = robot.robot.advance

    def counting(now: int) -> Any:  # noqa: ANN401  # whatever it is
        advanced.append(to_seconds(now))
        return advance(now)

    robot.robot.advance = counting  # type: ignore[method-assign]
    robot.advance_to(seconds(1))

    assert len(advanced) <= 30


def test_a_task_is_driven_to_its_end() -> None:
    robot = virtual()
    robot.advance_to(0)
    robot.supervisor.submit(TaskRequest(straight(20.0), 0, "pure_pursuit", 2.8, Actor("operator")))
    robot.advance_to(seconds(40))

    kinds = [kind for _, kind in happened(robot.supervisor.events)]
    assert "task.succeeded" in kinds
    vehicle = robot.supervisor.core.driving.vehicle.state
    assert vehicle is not None
    assert abs(vehicle.pose.x_m - 20.0) < 0.3


class Story(Protocol):
    """A robot that is told something at a time; live or virtual."""

    supervisor: Supervisor
    backend: SimulatedBackend


Act: TypeAlias = Callable[[Story], object]


def _drive(story: Story) -> None:
    story.supervisor.submit(TaskRequest(straight(30.0), 0, "stanley", 2.8, Actor("operator")))


STORY: list[tuple[float, Act]] = [
    (0.5, lambda s: s.supervisor.submit(ModeRequest(ACTUATION, PERFORMANCE, Actor("operator")))),
    (0.7, lambda s: s.backend.set_fault(BASE, Fault.DIE)),
    (2.5, lambda s: s.backend.set_fault(BASE, None)),
    (3.0, _drive),
    (5.123, lambda s: s.supervisor.readings.submit([Reading("estop", value=True)])),
    (6.0, lambda s: s.supervisor.readings.submit([Reading("estop", value=False)])),
    (7.0, lambda s: s.supervisor.submit(HoldRequest("operator", "lunch", Actor("operator")))),
    (8.0, lambda s: s.supervisor.submit(ReleaseRequest("operator", Actor("operator")))),
    (9.0, lambda s: s.backend.set_vehicle_fault("silent")),
    (9.5, lambda s: s.backend.set_vehicle_fault(None)),
    (10.5, lambda s: s.supervisor.submit(EmergencyStopRequest(True, "test", Actor("operator")))),
    (11.0, lambda s: s.supervisor.submit(EmergencyStopRequest(False, "test", Actor("operator")))),
]
END_S = 40.0


def told(log: EventLog) -> list[RecordedEvent]:
    return list(log.oldest_first())


class Live:
    """The same robot, run by tasks on a clock."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        robot = SimulatedRobot(MODEL, 0, mock=True)
        self.backend = SimulatedBackend(robot, self.clock)
        onboard = make_onboard(MODEL, 0)
        self.supervisor = Supervisor(
            LOADED, onboard, self.clock, self.backend, self.backend.readings, robot.what
        )


async def test_the_same_happens_at_the_same_times_as_with_a_live_robot() -> None:
    fast = virtual()
    for at_s, act in STORY:
        fast.advance_to(seconds(at_s))
        act(fast)
    fast.advance_to(seconds(END_S))

    live = Live()
    async with running(live.supervisor):
        for at_s, act in STORY:
            await live.clock.advance_to(seconds(at_s))
            act(live)
        await live.clock.advance_to(seconds(END_S))

    kinds = {kind for _, kind in happened(fast.supervisor.events)}
    assert {"task.paused", "task.resumed", "task.succeeded", "hold.set"} <= kinds
    assert told(fast.supervisor.events) == told(live.supervisor.events)
