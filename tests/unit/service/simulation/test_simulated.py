import asyncio
from collections.abc import AsyncIterator
from itertools import pairwise

import pytest

from domain.commands import AskTransition, Drive
from domain.errors import UnknownParameterError, UnknownPartError
from domain.inputs import (
    BackendStatus,
    NodeAnswer,
    NodeReport,
    Readings,
    ReportBacklog,
    VehicleReport,
)
from domain.lifecycle import LifecycleState, Transition
from domain.simulation.node_settings import Fault
from domain.simulation.robot import SimulatedRobot
from domain.state_and_mode import PartName
from domain.timebase import to_seconds
from domain.vehicle import DriveCommand
from service.pacing import AT_ONCE
from service.ports import BackendMessage
from service.simulation.simulated import SimulatedBackend
from tests.support.big_model import big_model
from tests.support.manual_clock import ManualClock, settle
from tests.support.models import ARM, BASE, actuation_model
from tests.support.waiting import until


class Listening:
    """A simulated backend that runs on a clock, and what was heard of it, when."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        robot = SimulatedRobot(actuation_model(), self.clock.now())
        self.backend = SimulatedBackend(robot, self.clock)
        self.heard: list[tuple[float, BackendMessage]] = []

    def hear(self, message: BackendMessage) -> None:
        self.heard.append((to_seconds(self.clock.now()), message))

    def of(self, kind: type[BackendMessage]) -> list[tuple[float, BackendMessage]]:
        """Return what was heard of one kind, and when."""
        return [(at, message) for at, message in self.heard if isinstance(message, kind)]


ALL_TAKEN = ReportBacklog("simulated nodes", None)


@pytest.fixture
async def listening() -> AsyncIterator[Listening]:
    listening = Listening()
    running = asyncio.create_task(listening.backend.run(listening.hear))
    await settle()
    yield listening
    running.cancel()
    await asyncio.wait([running])


async def test_it_is_there_before_its_nodes(listening: Listening) -> None:
    first, *others = [message for _, message in listening.heard]

    assert first == BackendStatus(available=True)
    assert {m.node for m in others if isinstance(m, NodeReport)} == {BASE, ARM}


async def test_of_thousands_of_messages_those_of_signals_and_vehicle_come_first() -> None:
    clock, heard = ManualClock(), list[BackendMessage]()
    backend = SimulatedBackend(SimulatedRobot(big_model(1_000), 0, mock=True), clock)
    running = asyncio.create_task(backend.run(heard.append))
    by_turn = []
    while ALL_TAKEN not in heard:
        await asyncio.sleep(0)
        by_turn.append(len(heard))
    clock.stall(1.0)
    running.cancel()
    await asyncio.wait([running])

    kinds = [type(message) for message in heard]
    assert kinds[:2] == [BackendStatus, ReportBacklog]
    assert {*kinds[2:4]} == {Readings, VehicleReport}
    assert {*kinds[4:-1]} == {NodeReport}
    assert heard[-1] == ALL_TAKEN
    assert max(b - a for a, b in pairwise(by_turn)) <= AT_ONCE + 1, "others run in between"


async def test_a_pose_that_comes_meanwhile_overtakes_the_nodes() -> None:
    clock, heard = ManualClock(), list[BackendMessage]()
    backend = SimulatedBackend(SimulatedRobot(big_model(1_000), 0), clock)
    running = asyncio.create_task(backend.run(heard.append))
    await until(lambda: len(heard) > 100)
    clock.stall(0.05)
    await until(lambda: len(heard) > 100 + 3 * AT_ONCE)
    running.cancel()
    await asyncio.wait([running])

    poses = [n for n, message in enumerate(heard) if isinstance(message, VehicleReport)]
    assert poses[1] <= 100 + 2 * AT_ONCE


async def test_a_node_arrives_exactly_after_its_time(listening: Listening) -> None:
    await listening.clock.advance(1.0)
    listening.backend.send(AskTransition(1, BASE, Transition.CONFIGURE))
    await listening.clock.advance(1.0)

    assert listening.of(NodeReport)[-1] == (1.3, NodeReport(BASE, state=LifecycleState.INACTIVE))


async def test_a_node_answers_without_waiting_for_the_next_report_of_the_vehicle(
    listening: Listening,
) -> None:
    await listening.clock.advance(1.01)
    listening.backend.send(AskTransition(1, BASE, Transition.CONFIGURE))
    await settle()

    assert listening.of(NodeAnswer) == [(1.01, NodeAnswer(1, BASE, True))]


async def test_a_fault_takes_effect_at_once(listening: Listening) -> None:
    await listening.clock.advance(1.0)
    listening.backend.set_fault(BASE, Fault.DIE)
    await listening.clock.advance(5.0)

    assert listening.of(NodeReport)[-1] == (2.0, NodeReport(BASE, reachable=False))


async def test_a_parameter_changed_from_outside_is_heard_at_once(listening: Listening) -> None:
    listening.backend.set_parameters(BASE, {"max_speed": 0.3})
    await settle()

    assert listening.of(NodeReport)[-1] == (0.0, NodeReport(BASE, parameters={"max_speed": 0.3}))


async def test_what_cannot_be_is_refused_where_it_is_asked(listening: Listening) -> None:
    with pytest.raises(UnknownPartError):
        listening.backend.set_fault(PartName("nowhere"), Fault.DIE)
    with pytest.raises(UnknownParameterError):
        listening.backend.set_parameters(BASE, {"wheels": 4})


async def test_the_vehicle_is_heard_20_times_a_second(listening: Listening) -> None:
    await listening.clock.advance(0.2)

    assert [at for at, _ in listening.of(VehicleReport)] == [0.0, 0.05, 0.1, 0.15, 0.2]


async def test_a_command_to_drive_is_seen_in_the_next_report(listening: Listening) -> None:
    await listening.clock.advance(0.98)
    listening.backend.send(Drive(DriveCommand(2.0, 0.0)))
    await listening.clock.advance(0.02)

    at, report = listening.of(VehicleReport)[-1]
    assert isinstance(report, VehicleReport)
    assert (at, report.state.speed_mps) == (1.0, 2.0)
    assert report.state.pose.x_m == pytest.approx(0.04)


async def test_a_vehicle_that_is_told_to_be_silent_is_heard_again_when_it_may_speak(
    listening: Listening,
) -> None:
    listening.backend.set_vehicle_fault("silent")
    await listening.clock.advance(1.0)
    listening.backend.set_vehicle_fault(None)
    await listening.clock.advance(0.1)

    assert [at for at, _ in listening.of(VehicleReport)] == [0.0, 1.05, 1.1]


async def test_a_robot_without_mock_signals_publishes_none(listening: Listening) -> None:
    await listening.clock.advance(1.0)

    assert listening.backend.mock is None
    assert listening.of(Readings) == []
