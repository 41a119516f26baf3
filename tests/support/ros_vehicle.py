"""A vehicle behind topics of ROS, in memory and in virtual time."""

import math
from collections.abc import Callable

from domain.commands import Drive
from domain.simulation.vehicle import SimulatedVehicle
from domain.simulation.vehicle_settings import VehicleSettings
from domain.timebase import seconds
from domain.vehicle import DriveCommand, VehicleLimits, VehicleState
from service.files.ros2_block import Ros2Block
from service.ports import BackendMessage
from service.ros.backend.vehicle import RosVehicle
from service.ros.graph.graph import Fields, Lane, Message, Qos
from tests.support.manual_clock import ManualClock
from tests.support.ros_graph import FakeGraph

ODOMETRY, COMMANDS = "/odom", "/ackermann_cmd"
ACKERMANN = "ackermann_msgs/msg/AckermannDrive"


class RosBase:
    """What drives the vehicle, and publishes its odometry.

    It goes on for ever with the last command that it heard, as some do.
    """

    def __init__(self, settings: VehicleSettings, graph: FakeGraph, clock: ManualClock) -> None:
        self._wheelbase_m = settings.limits.wheelbase_m
        self._graph = graph
        self._clock = clock
        self._vehicle = SimulatedVehicle(settings, clock.now())
        self._heard = DriveCommand(0.0, 0.0)
        self._is_lost = False
        node = graph.node("base", Lane.SENSORS)
        node.subscribe(COMMANDS, ACKERMANN, Qos.COMMANDS, _command, self._follow)

    async def pass_time(self, by_s: float) -> None:
        """Let time pass for it and for all that waits for the clock."""
        end = self._clock.now() + seconds(by_s)
        while (due := self._vehicle.wake_at()) <= end:
            await self._clock.advance_to(due)
            self._vehicle.drive(self._heard, due)
            for report in self._vehicle.advance(due):
                if not self._is_lost:
                    self._graph.publish(ODOMETRY, self._odometry(report.state))
        await self._clock.advance_to(end)

    def lose(self, *, lost: bool) -> None:
        """Let its localization be silent, or speak again."""
        self._is_lost = lost

    def _follow(self, command: DriveCommand) -> None:
        self._heard = command
        self._vehicle.drive(command, self._clock.now())

    def _odometry(self, state: VehicleState) -> Fields:
        pose, speed = state.pose, state.speed_mps
        yaw_rate = speed * math.tan(state.steering_angle_rad) / self._wheelbase_m
        half = pose.yaw_rad / 2
        turn = {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)}
        place = {"x": pose.x_m, "y": pose.y_m}
        return {
            "pose": {"pose": {"position": place, "orientation": turn}},
            "twist": {"twist": {"linear": {"x": speed}, "angular": {"z": yaw_rate}}},
        }


class RosVehicleBackend:
    """A `VehicleBackend` of nothing but a `RosVehicle`."""

    def __init__(self, limits: VehicleLimits, graph: FakeGraph, clock: ManualClock) -> None:
        block = {
            "odometry": {"topic": ODOMETRY},
            "command": {"topic": COMMANDS, "type": ACKERMANN},
        }
        self._vehicle = RosVehicle(Ros2Block.model_validate(block), limits, graph, clock)
        self._graph = graph

    async def run(self, deliver: Callable[[BackendMessage], None]) -> None:
        """Deliver how the vehicle moves, until cancelled."""
        self._vehicle.start(deliver)
        try:
            await self._vehicle.run()
        finally:
            await self._graph.close()

    def send(self, command: Drive, /) -> None:
        """Tell the vehicle how to drive."""
        self._vehicle.send(command)


def _command(message: Message) -> DriveCommand:
    return DriveCommand(message.speed, message.steering_angle)
