"""What every backend must keep of its vehicle; `test_node_backend.py` says it of its nodes.

An adapter joins with a `VehicleUnderTest` of its own in `UNDER_TEST`; the assertions are the same
for all. Nothing here knows how quickly a vehicle follows: the tests wait for what should come, each
in its own kind of time, and leave room for what a real one needs.
"""

import asyncio
import math
from collections.abc import AsyncIterator, Callable
from itertools import pairwise
from typing import Protocol

import pytest

from domain.commands import Drive
from domain.inputs import VehicleReport
from domain.simulation.robot import SimulatedRobot
from domain.simulation.vehicle_settings import Noise, Plant, VehicleSettings
from domain.timebase import seconds, to_seconds
from domain.vehicle import DriveCommand, Pose, VehicleLimits, VehicleState
from service.ports import BackendMessage, VehicleBackend
from service.simulation.simulated import SimulatedBackend
from tests.support.manual_clock import ManualClock
from tests.support.models import actuation_model
from tests.support.ros_graph import FakeGraph
from tests.support.ros_vehicle import RosBase, RosVehicleBackend

STANDS_MPS = 0.05
"""Below this a vehicle counts as standing; noise of its speed included."""
STOPS_WITHIN_S = 6.0
"""How long braking from `CRUISE` may take, once a vehicle is told or void of commands."""
CRUISE = 2.0
"""In m/s."""


class VehicleUnderTest(Protocol):
    """A backend whose vehicle has room to drive some 50 m each way."""

    backend: VehicleBackend
    limits: VehicleLimits
    """What it can do."""

    def now_s(self) -> float:
        """Return the time that reports are stamped with, s."""

    async def pass_time(self, by_s: float) -> None:
        """Let this much time pass for the vehicle and the backend."""

    def lose(self, *, lost: bool) -> None:
        """Let the localization be silent, or speak again; skip the test where that cannot be."""


class Simulated:
    """The simulated vehicle, in virtual time."""

    plant = Plant()
    pose = Pose(0.0, 0.0, 0.0)

    def __init__(self) -> None:
        self._clock = ManualClock()
        settings = VehicleSettings(self.pose, self.plant)
        self.limits = settings.limits
        robot = SimulatedRobot(actuation_model(), self._clock.now(), vehicle=settings)
        self._simulated = SimulatedBackend(robot, self._clock)
        self.backend: VehicleBackend = self._simulated

    def now_s(self) -> float:
        return to_seconds(self._clock.now())

    async def pass_time(self, by_s: float) -> None:
        await self._clock.advance(by_s)

    def lose(self, *, lost: bool) -> None:
        self._simulated.set_vehicle_fault("silent" if lost else None)


class SimulatedWithInertia(Simulated):
    """The same, with all that keeps a real vehicle from following at once."""

    plant = Plant(
        acceleration_mps2=1.0,
        braking_mps2=1.5,
        steering_rate_radps=0.5,
        steering_lag_s=0.15,
        speed_lag_s=0.1,
        delay=seconds(0.1),
        noise=Noise(position_m=0.01, yaw_rad=0.002, speed_mps=0.005, seed=1),
    )
    pose = Pose(120.0, -40.0, 2.5)


class RosTopics:
    """A vehicle behind topics of ROS, in virtual time; its base heeds no time limit of commands."""

    plant = Plant()
    pose = Pose(0.0, 0.0, 0.0)

    def __init__(self) -> None:
        self._clock = ManualClock()
        settings = VehicleSettings(self.pose, self.plant)
        self.limits = settings.limits
        graph = FakeGraph(self._clock)
        base = RosBase(settings, graph, self._clock)
        self.pass_time = base.pass_time
        self.lose = base.lose
        self.backend: VehicleBackend = RosVehicleBackend(self.limits, graph, self._clock)

    def now_s(self) -> float:
        return to_seconds(self._clock.now())


class RosTopicsWithInertia(RosTopics):
    """The same, with all that keeps a real vehicle from following at once."""

    plant = SimulatedWithInertia.plant
    pose = SimulatedWithInertia.pose


UNDER_TEST: list[Callable[[], VehicleUnderTest]] = [
    Simulated,
    SimulatedWithInertia,
    RosTopics,
    RosTopicsWithInertia,
]


class Vehicle:
    """A running backend, what its vehicle said and when, and commands that are kept up."""

    def __init__(self, under_test: VehicleUnderTest) -> None:
        self.under_test = under_test
        self.heard: list[tuple[float, VehicleState]] = []
        self.running = asyncio.create_task(
            under_test.backend.run(self._hear), name="backend under test"
        )

    def _hear(self, message: BackendMessage) -> None:
        if isinstance(message, VehicleReport):
            self.heard.append((self.under_test.now_s(), message.state))

    def tell(self, speed_mps: float, steering_angle_rad: float = 0.0) -> None:
        """Send one command."""
        self.under_test.backend.send(Drive(DriveCommand(speed_mps, steering_angle_rad)))

    async def drive(self, for_s: float, speed_mps: float, steering_angle_rad: float = 0.0) -> None:
        """Send the same command 20 times a second for a time."""
        for _ in range(round(for_s / _PERIOD_S)):
            self.tell(speed_mps, steering_angle_rad)
            await self.under_test.pass_time(_PERIOD_S)

    async def until(self, is_it: Callable[[], bool], within_s: float) -> None:
        """Let time pass until something is the case."""
        waited_s = 0.0
        while not is_it():
            if self.running.done():
                self.running.result()
            assert waited_s < within_s, f"did not come in {within_s} s; heard: {self.heard[-3:]}"
            await self.under_test.pass_time(_PERIOD_S)
            waited_s += _PERIOD_S

    @property
    def state(self) -> VehicleState:
        """Return how it moves, as it said last."""
        return self.heard[-1][1]

    @property
    def stands(self) -> bool:
        return abs(self.state.speed_mps) < STANDS_MPS

    def way_from(self, pose: Pose) -> tuple[float, float]:
        """Return how far it is from a pose, ahead and to the left of it, m."""
        here = self.state.pose
        dx, dy = here.x_m - pose.x_m, here.y_m - pose.y_m
        cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        return cos * dx + sin * dy, cos * dy - sin * dx


_PERIOD_S = 0.05


@pytest.fixture(params=UNDER_TEST, ids=lambda made: made.__name__.lower())
async def under_test(request: pytest.FixtureRequest) -> VehicleUnderTest:
    made: VehicleUnderTest = request.param()
    return made


@pytest.fixture
async def vehicle(under_test: VehicleUnderTest) -> AsyncIterator[Vehicle]:
    vehicle = Vehicle(under_test)
    await vehicle.until(lambda: bool(vehicle.heard), within_s=1.0)
    yield vehicle
    vehicle.running.cancel()
    await asyncio.wait([vehicle.running])


async def test_where_it_is_is_said_at_once(under_test: VehicleUnderTest) -> None:
    vehicle = Vehicle(under_test)
    began = under_test.now_s()
    await vehicle.until(lambda: bool(vehicle.heard), within_s=1.0)
    vehicle.running.cancel()
    await asyncio.wait([vehicle.running])

    assert vehicle.heard[0][0] - began < 0.1


async def test_where_it_is_is_said_some_twenty_times_a_second(vehicle: Vehicle) -> None:
    await vehicle.under_test.pass_time(5.0)

    times = [at for at, _ in vehicle.heard]
    assert 15 * 5 <= len(times) <= 30 * 5
    assert max(b - a for a, b in pairwise(times)) < 0.2


async def test_a_vehicle_that_is_told_nothing_stands(vehicle: Vehicle) -> None:
    begin = vehicle.state.pose
    await vehicle.under_test.pass_time(3.0)

    assert vehicle.stands
    assert math.hypot(*vehicle.way_from(begin)) < 0.2


async def test_a_vehicle_drives_straight_ahead_along_its_heading(vehicle: Vehicle) -> None:
    begin = vehicle.state.pose
    await vehicle.drive(6.0, CRUISE)

    ahead, left = vehicle.way_from(begin)
    assert 6.0 < ahead < 12.5
    assert abs(left) < 0.5
    assert vehicle.state.speed_mps == pytest.approx(CRUISE, abs=0.2)


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["left", "right"])
async def test_a_positive_steering_angle_leads_to_the_left(vehicle: Vehicle, side: float) -> None:
    begin = vehicle.state.pose
    await vehicle.drive(4.0, CRUISE, side * 0.2)

    _, left = vehicle.way_from(begin)
    turned = math.remainder(vehicle.state.pose.yaw_rad - begin.yaw_rad, math.tau)
    assert left * side > 0.5
    assert turned * side > 0.2
    assert vehicle.state.steering_angle_rad == pytest.approx(side * 0.2, abs=0.03)


async def test_a_vehicle_drives_backwards_when_it_is_told_to(vehicle: Vehicle) -> None:
    begin = vehicle.state.pose
    await vehicle.drive(4.0, -1.0)

    ahead, _ = vehicle.way_from(begin)
    assert ahead < -1.0
    assert vehicle.state.speed_mps == pytest.approx(-1.0, abs=0.2)


async def test_speed_0_stops_it(vehicle: Vehicle) -> None:
    await vehicle.drive(4.0, CRUISE)
    await vehicle.drive(STOPS_WITHIN_S, 0.0)
    rest = vehicle.state.pose
    await vehicle.drive(2.0, 0.0)

    assert vehicle.stands
    assert math.hypot(*vehicle.way_from(rest)) < 0.2


async def test_a_vehicle_that_hears_nothing_for_half_a_second_stops_by_itself(
    vehicle: Vehicle,
) -> None:
    await vehicle.drive(4.0, CRUISE, 0.1)
    await vehicle.under_test.pass_time(0.5 + STOPS_WITHIN_S)
    rest = vehicle.state.pose
    await vehicle.under_test.pass_time(5.0)

    assert vehicle.stands
    assert math.hypot(*vehicle.way_from(rest)) < 0.2


async def test_a_vehicle_that_hears_nothing_keeps_its_steering(vehicle: Vehicle) -> None:
    await vehicle.drive(4.0, CRUISE, 0.1)
    await vehicle.under_test.pass_time(0.5 + STOPS_WITHIN_S)

    assert vehicle.state.steering_angle_rad == pytest.approx(0.1, abs=0.03)


async def test_a_command_is_not_void_before_half_a_second(vehicle: Vehicle) -> None:
    await vehicle.drive(4.0, CRUISE)
    speeds = []
    for _ in range(10):
        await vehicle.under_test.pass_time(0.4)
        speeds.append(vehicle.state.speed_mps)
        vehicle.tell(CRUISE)

    assert min(speeds) == pytest.approx(CRUISE, abs=0.2)


async def test_it_drives_again_after_it_stopped_by_itself(vehicle: Vehicle) -> None:
    await vehicle.drive(2.0, CRUISE)
    await vehicle.until(lambda: vehicle.stands, within_s=0.6 + STOPS_WITHIN_S)
    rest = vehicle.state.pose
    await vehicle.drive(4.0, CRUISE)

    assert vehicle.way_from(rest)[0] > 3.0


async def test_a_speed_beyond_the_limit_is_cut(vehicle: Vehicle) -> None:
    top = vehicle.under_test.limits.max_speed_mps
    await vehicle.drive(3.0, top * 10)

    assert max(state.speed_mps for _, state in vehicle.heard) <= top + 0.1


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["left", "right"])
async def test_a_steering_angle_beyond_the_limit_is_cut(vehicle: Vehicle, side: float) -> None:
    sharpest = vehicle.under_test.limits.max_steering_angle_rad
    await vehicle.drive(4.0, 1.0, side * sharpest * 4)

    angles = [abs(state.steering_angle_rad) for _, state in vehicle.heard]
    assert max(angles) <= sharpest + 0.03
    assert vehicle.state.steering_angle_rad == pytest.approx(side * sharpest, abs=0.05)


@pytest.mark.parametrize("command", [(math.nan, 0.0), (math.inf, 0.0), (CRUISE, math.nan)])
async def test_a_command_that_is_no_number_stops_it(
    vehicle: Vehicle, command: tuple[float, float]
) -> None:
    await vehicle.drive(3.0, CRUISE)
    await vehicle.drive(STOPS_WITHIN_S, *command)

    assert vehicle.stands
    assert all(math.isfinite(s.speed_mps) for _, s in vehicle.heard)
    assert all(math.isfinite(s.pose.x_m + s.pose.y_m + s.pose.yaw_rad) for _, s in vehicle.heard)


async def test_a_vehicle_whose_localization_is_silent_is_not_heard_and_is_back_afterwards(
    vehicle: Vehicle,
) -> None:
    vehicle.under_test.lose(lost=True)
    await vehicle.under_test.pass_time(0.2)
    vehicle.heard.clear()
    await vehicle.under_test.pass_time(3.0)
    assert vehicle.heard == []

    vehicle.under_test.lose(lost=False)
    await vehicle.under_test.pass_time(2.0)
    assert 15 * 2 <= len(vehicle.heard) <= 30 * 2


async def test_a_vehicle_that_is_back_is_where_it_has_driven_to_meanwhile(
    vehicle: Vehicle,
) -> None:
    begin = vehicle.state.pose
    vehicle.under_test.lose(lost=True)
    await vehicle.drive(4.0, CRUISE)
    vehicle.under_test.lose(lost=False)
    vehicle.heard.clear()
    await vehicle.until(lambda: bool(vehicle.heard), within_s=1.0)

    assert vehicle.way_from(begin)[0] > 3.0


async def test_a_vehicle_whose_localization_is_silent_stops_by_itself_as_well(
    vehicle: Vehicle,
) -> None:
    await vehicle.drive(2.0, CRUISE)
    vehicle.under_test.lose(lost=True)
    await vehicle.under_test.pass_time(0.5 + STOPS_WITHIN_S)
    vehicle.under_test.lose(lost=False)
    vehicle.heard.clear()
    await vehicle.until(lambda: bool(vehicle.heard), within_s=1.0)

    assert vehicle.stands


async def test_it_runs_until_it_is_cancelled_and_leaves_no_task(vehicle: Vehicle) -> None:
    before = asyncio.all_tasks()
    await vehicle.drive(1.0, CRUISE)
    assert not vehicle.running.done()

    vehicle.running.cancel()
    await asyncio.wait([vehicle.running])

    assert vehicle.running.cancelled()
    assert asyncio.all_tasks() <= before - {vehicle.running}


async def test_after_it_was_cancelled_nothing_is_delivered(vehicle: Vehicle) -> None:
    vehicle.running.cancel()
    await asyncio.wait([vehicle.running])
    vehicle.heard.clear()
    await vehicle.under_test.pass_time(1.0)

    assert vehicle.heard == []


async def test_a_command_may_come_before_it_runs(under_test: VehicleUnderTest) -> None:
    under_test.backend.send(Drive(DriveCommand(1.0, 0.0)))
    vehicle = Vehicle(under_test)
    await vehicle.until(lambda: bool(vehicle.heard), within_s=1.0)
    vehicle.running.cancel()
    await asyncio.wait([vehicle.running])

    assert vehicle.heard
