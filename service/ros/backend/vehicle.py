"""The vehicle: odometry from one ROS topic, drive commands on another."""

import asyncio
import logging
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from domain.commands import Drive
from domain.inputs import DriveStatus, VehicleReport
from domain.timebase import Duration, Instant, seconds
from domain.vehicle import DriveCommand, Pose, VehicleLimits, VehicleState
from service.clock import Clock
from service.files.ros2_block import Ros2Block
from service.ros.graph.graph import OWNER, DriveOutput, Lane, Message, Qos, RosGraph

log = logging.getLogger(__name__)

ODOMETRY = "nav_msgs/msg/Odometry"

_PERIOD: Duration = seconds(0.04)
"""Least period of odometry; a topic that is faster is thinned out."""
_EARLY: Duration = seconds(0.02)
"""A message may come this much early after a late one, so that jitter drops none."""
_QUIET: Duration = seconds(60)
"""Faults of the odometry are logged no more often than this."""
_ROLLS_MPS = 0.1
"""Below this speed the steering angle cannot be computed from the yaw rate."""
_AT_REST = DriveCommand(0.0, 0.0)


class RosVehicle:
    """Reports the motion of the vehicle, and passes drive commands to the output of the graph.

    A vehicle that cannot be commanded must not be driven on, so that is reported, too.
    """

    def __init__(
        self,
        settings: Ros2Block,
        limits: VehicleLimits,
        graph: RosGraph,
        clock: Clock,
        owner: str = OWNER,
    ) -> None:
        """Prepare; `start` subscribes.

        Args:
            settings: Topics of odometry and commands.
            limits: Of the vehicle.
            graph: The ROS 2 graph.
            clock: Of the service.
            owner: The names of its nodes begin with this.
        """
        self._owner = owner
        self._settings = settings
        self._limits = limits
        self._graph = graph
        self._odometry = _Odometry(clock, settings.odometry.topic if settings.odometry else "")
        self._output: DriveOutput | None = None
        self._told = _AT_REST
        self._deliver: Callable[[VehicleReport | DriveStatus], None] | None = None

    def start(self, deliver: Callable[[VehicleReport | DriveStatus], None]) -> None:
        """Subscribe, and deliver the motion of the vehicle at 25 Hz at most until the graph closes.

        Also whether commands reach it is delivered, now and whenever that changes.

        Raises:
            UnknownTypeError: The type of a topic is not installed.
        """
        odometry, command = self._settings.odometry, self._settings.command
        if odometry is None and command is None:
            return
        self._deliver = deliver
        if command is not None:
            self._output = self._graph.drive_output(
                command.topic, command.type, self._limits.wheelbase_m, self._owner
            )
            self._tell_drive_status()
        if odometry is not None:

            def take(motion: _Motion) -> None:
                deliver(VehicleReport(self._state(motion)))

            node = self._graph.node(f"{self._owner}_vehicle", Lane.SENSORS)
            node.subscribe(odometry.topic, ODOMETRY, Qos.SENSOR, self._odometry.pick, take)

    async def run(self) -> None:
        """Run the output for commands, if there is one, until cancelled."""
        if self._output is None:
            await asyncio.Event().wait()
        else:
            await self._output.run(self._tell_drive_status)

    def send(self, drive: Drive) -> None:
        """Publish a drive command, clipped to the limits; a value that is not finite is a stop."""
        self._told = self._possible(drive.command)
        if self._output is not None:
            self._output.send(self._told)

    def _tell_drive_status(self) -> None:
        if self._output is not None and self._deliver is not None:
            trouble = self._output.trouble
            self._deliver(DriveStatus(available=not trouble, reason=trouble))

    def _possible(self, command: DriveCommand) -> DriveCommand:
        """Return a command clipped to the limits of the vehicle."""
        speed, steering = command.speed_mps, command.steering_angle_rad
        if not (math.isfinite(speed) and math.isfinite(steering)):
            return replace(self._told, speed_mps=0.0)
        return DriveCommand(
            _clipped(speed, self._limits.max_speed_mps),
            _clipped(steering, self._limits.max_steering_angle_rad),
        )

    def _state(self, motion: "_Motion") -> VehicleState:
        speed, steering = motion.speed_mps, self._told.steering_angle_rad
        if abs(speed) > _ROLLS_MPS:
            bend = math.atan(self._limits.wheelbase_m * motion.yaw_rate_radps / speed)
            steering = _clipped(bend, self._limits.max_steering_angle_rad)
        return VehicleState(motion.pose, speed, steering)


@dataclass(frozen=True, slots=True)
class _Motion:
    """The motion in one message."""

    pose: Pose
    speed_mps: float
    yaw_rate_radps: float


class _Odometry:
    """Reads the motion of the vehicle from messages; runs on the thread of ROS."""

    def __init__(self, clock: Clock, topic: str) -> None:
        self._clock = clock
        self._topic = topic
        self._next: Instant = 0
        self._quiet_until: Instant = 0

    def pick(self, message: Message) -> _Motion | None:
        """Return the motion in a message; None: it is invalid, or messages come too fast."""
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        speed, yaw_rate = message.twist.twist.linear.x, message.twist.twist.angular.z
        now = self._clock.now()
        numbers = (place.x, place.y, speed, yaw_rate)
        length = math.hypot(turn.x, turn.y, turn.z, turn.w)
        # Length 0: the sender did not fill in the quaternion.
        if not all(map(math.isfinite, numbers)) or not 0.9 < length < 1.1:
            if now >= self._quiet_until:
                self._quiet_until = now + _QUIET
                log.warning(
                    "invalid odometry on %s: x, y, speed and yaw rate are %s, and the quaternion "
                    "has the length %s",
                    self._topic,
                    numbers,
                    length,
                )
            return None
        due = max(self._next, now - _EARLY)
        if due > now:
            return None
        self._next = due + _PERIOD
        return _Motion(Pose(place.x, place.y, _yaw(turn)), speed, yaw_rate)


def _yaw(turn: Message) -> float:
    """Return the heading of a quaternion, in rad."""
    return math.atan2(
        2.0 * (turn.w * turn.z + turn.x * turn.y),
        turn.w**2 + turn.x**2 - turn.y**2 - turn.z**2,
    )


def _clipped(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
