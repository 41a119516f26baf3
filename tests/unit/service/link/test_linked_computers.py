"""A robot of three computers in virtual time: each is the whole service, only the network is not.

The clocks of the three are five minutes apart.
"""

from collections.abc import AsyncIterator

import pytest

from domain.computers import SUPERVISOR, ComputerName
from domain.inputs import EmergencyStopRequest, ModeRequest, Reading, TransitionRequest
from domain.lifecycle import LifecycleState, Transition
from domain.simulation.network import Wire
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.timebase import seconds
from service.link.memory import MemoryNetwork
from service.simulation.simulated import SimulatedBackend
from service.supervisor import Supervisor
from tests.support.linked_robot import Running, make_computer, names_of, settings_of
from tests.support.manual_clock import ManualClock
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    PERFORMANCE,
    STRONG,
    active,
    actuation_model,
    inactive,
)
from tests.support.offset_clock import OffsetClock

AHEAD_S = {"base": 300.0, "arm": -300.0}
MOTOR = "motor_temperature"
"""A signal that is read at the arm."""


class Robot:
    """The computers of the robot, and the network between them."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.network = MemoryNetwork(names_of(), self.clock)
        self.running = Running()
        self.services: dict[str, Supervisor] = {}
        self.nodes: dict[str, SimulatedBackend] = {}
        for name in names_of():
            self.start(name)

    @property
    def supervisor(self) -> Supervisor:
        return self.services[SUPERVISOR]

    def start(self, name: str) -> None:
        """Start a computer, with nodes that are new too."""
        clock = OffsetClock(self.clock, AHEAD_S.get(name, 0.0))
        link = self.network.link(ComputerName(name))
        robot = settings_of(name, signals={MOTOR: {"unit": "degC", "part": ARM}})
        made = make_computer(actuation_model(), robot, link, clock)
        self.services[name], self.nodes[name] = made
        self.running.start(name, self.services[name])

    def cut(self, name: str, *, is_cut: bool = True) -> None:
        """Cut all that a device says to the supervisor, and the other way, or mend it."""
        self.network.set_cut(SUPERVISOR, ComputerName(name), is_cut=is_cut)

    def actual(self, *parts: PartName) -> list[StateAndMode]:
        """Return what the supervisor sees of parts."""
        return [self.supervisor.core.part(part).actual.state_and_mode for part in parts]

    async def ask(self, part: PartName, mode: ModeName) -> None:
        """Ask the supervisor for a mode, and let it come."""
        self.supervisor.submit(ModeRequest(part, mode))
        await self.clock.advance(5.0)


@pytest.fixture
async def robot() -> AsyncIterator[Robot]:
    robot = Robot()
    await robot.clock.advance(2.0)
    yield robot
    await robot.running.stop()


async def test_the_supervisor_sees_the_nodes_of_all_devices(robot: Robot) -> None:
    views = [robot.supervisor.core.part(part) for part in (BASE, ARM)]

    assert all(view.reachable for view in views)
    assert robot.actual(BASE, ARM) == [StateAndMode(LifecycleState.UNCONFIGURED)] * 2


async def test_annex_4_is_the_same_over_devices(robot: Robot) -> None:
    robot.supervisor.submit(TransitionRequest(ACTUATION, Transition.CONFIGURE))
    await robot.clock.advance(5.0)
    assert robot.actual(ACTUATION, BASE, ARM) == [inactive(), inactive(), inactive()]

    robot.supervisor.submit(TransitionRequest(ACTUATION, Transition.ACTIVATE))
    await robot.clock.advance(5.0)
    assert robot.actual(ACTUATION, BASE, ARM) == [active(), active(), inactive()]

    await robot.ask(ACTUATION, PERFORMANCE)
    assert robot.actual(ACTUATION, BASE, ARM) == [
        active("PERFORMANCE"),
        active("FAST"),
        active("STRONG"),
    ]

    await robot.ask(BASE, ModeName("SLOW"))
    await robot.ask(ARM, ModeName("WEAK"))
    assert robot.actual(ACTUATION, BASE, ARM) == [
        StateAndMode(LifecycleState.ACTIVATING, ModeName("MODERATE")),
        active("SLOW"),
        active("WEAK"),
    ]


async def test_a_device_that_is_cut_off_is_not_ok_and_back_as_it_is(robot: Robot) -> None:
    await robot.ask(ARM, STRONG)
    robot.cut("arm")
    await robot.clock.advance(1.8)
    assert not robot.supervisor.core.part(ARM).reachable

    robot.nodes["arm"].set_parameters(ARM, {"max_torque": 0.123})
    robot.cut("arm", is_cut=False)
    await robot.clock.advance(2.0)

    assert robot.supervisor.core.part(ARM).reachable
    torque = {view.name: view.value for view in robot.supervisor.core.parameters(ARM)}["max_torque"]
    assert torque == 0.123


async def test_an_order_of_before_the_cut_is_never_carried_out_after_it(robot: Robot) -> None:
    arm = ComputerName("arm")
    # What is sent to the arm comes after the cut, all at once.
    robot.network.set_wire(SUPERVISOR, arm, Wire(delay=5_000_000_000))
    robot.supervisor.submit(TransitionRequest(ARM, Transition.CONFIGURE))
    await robot.clock.advance(3.0)
    robot.network.set_wire(SUPERVISOR, arm, Wire())
    await robot.clock.advance(10.0)

    assert robot.actual(ARM) == [StateAndMode(LifecycleState.UNCONFIGURED)]


async def test_a_supervisor_that_is_started_again_knows_all_within_two_seconds(
    robot: Robot,
) -> None:
    await robot.ask(ACTUATION, PERFORMANCE)
    await robot.running.stop(SUPERVISOR)
    await robot.clock.advance(0.5)
    robot.start(SUPERVISOR)
    await robot.clock.advance(2.0)

    # Nothing was kept, so that there is no target by which the mode of a system is inferred.
    assert robot.actual(BASE, ARM) == [active("FAST"), active("STRONG")]
    assert robot.actual(ACTUATION)[0].state is LifecycleState.ACTIVE


async def test_a_device_that_is_started_again_is_known_as_new_and_is_not_commanded(
    robot: Robot,
) -> None:
    await robot.ask(ARM, STRONG)
    await robot.running.stop("arm")
    robot.start("arm")
    await robot.clock.advance(10.0)

    assert robot.actual(ARM) == [StateAndMode(LifecycleState.UNCONFIGURED)]
    assert robot.supervisor.core.part(ARM).reachable


@pytest.mark.parametrize("pressed_at", names_of())
async def test_a_stop_on_any_computer_stops_all_within_a_beat(
    robot: Robot, pressed_at: str
) -> None:
    robot.services[pressed_at].submit(EmergencyStopRequest(engaged=True, reason="a dog"))
    await robot.clock.advance(0.1)

    assert all(service.core.emergency_stop().engaged for service in robot.services.values())


async def test_a_reading_at_a_device_is_as_old_at_the_supervisor_as_it_is_there(
    robot: Robot,
) -> None:
    arm = robot.services["arm"]
    a_second_ago = arm.clock.now() - seconds(1)
    arm.readings.submit([Reading(MOTOR, 40.0, a_second_ago)], "somebody at the arm")
    await robot.clock.advance(0.1)

    seen = robot.supervisor.core.signal(MOTOR)
    assert seen.value == 40.0
    assert seen.stamp == robot.clock.now() - seconds(1.1)
