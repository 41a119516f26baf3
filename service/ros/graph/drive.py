"""Drive commands as messages, and how long one is valid."""

import time
from collections.abc import Callable
from dataclasses import replace
from math import tan
from struct import Struct

from domain.timebase import NANOSECONDS_PER_SECOND, Duration, Instant, seconds
from domain.vehicle import COMMAND_VALID_FOR, DriveCommand
from service.ros.graph.graph import Fields

REPEAT_EVERY: Duration = seconds(0.1)
REPEATS = 20
"""Speed 0 is commanded so often, since a message may be lost; then another program can drive."""

RECORD = Struct("!qdd")
"""A command on its way to the process that publishes it: instant, speed and steering angle."""

_AT_REST = DriveCommand(0.0, 0.0)


class Deadman:
    """Says when speed 0 has to be commanded, since there was no new command."""

    def __init__(self) -> None:
        self._told = _AT_REST
        self._due: Instant | None = None
        self._left = 0

    def take(self, command: DriveCommand, sent_at: Instant) -> None:
        """Remember a command; it is valid for 0.5 s from when it was sent."""
        self._told = command
        self._due = sent_at + COMMAND_VALID_FOR if command.speed_mps != 0.0 else None
        self._left = REPEATS

    def wake_at(self) -> Instant | None:
        """Return when speed 0 is to be commanded next; None: not before there is a command."""
        return self._due

    def advance(self, now: Instant) -> DriveCommand | None:
        """Return the command that is due by now: speed 0 with the wheels as they are."""
        if self._due is None or now < self._due:
            return None
        self._left -= 1
        self._due = now + REPEAT_EVERY if self._left else None
        return self.stop()

    def stop(self) -> DriveCommand:
        """Return the command to stop with the wheels as they are."""
        return replace(self._told, speed_mps=0.0)


def _twist(command: DriveCommand, wheelbase_m: float, _: Fields) -> Fields:
    yaw_rate = command.speed_mps * tan(command.steering_angle_rad) / wheelbase_m
    return {"linear": {"x": command.speed_mps}, "angular": {"z": yaw_rate}}


def _twist_stamped(command: DriveCommand, wheelbase_m: float, stamp: Fields) -> Fields:
    return {"header": {"stamp": stamp}, "twist": _twist(command, wheelbase_m, stamp)}


def _ackermann(command: DriveCommand, _wheelbase_m: float, _: Fields) -> Fields:
    return {"speed": command.speed_mps, "steering_angle": command.steering_angle_rad}


def _ackermann_stamped(command: DriveCommand, wheelbase_m: float, stamp: Fields) -> Fields:
    return {"header": {"stamp": stamp}, "drive": _ackermann(command, wheelbase_m, stamp)}


_BODIES: dict[str, Callable[[DriveCommand, float, Fields], Fields]] = {
    "geometry_msgs/msg/Twist": _twist,
    "geometry_msgs/msg/TwistStamped": _twist_stamped,
    "ackermann_msgs/msg/AckermannDrive": _ackermann,
    "ackermann_msgs/msg/AckermannDriveStamped": _ackermann_stamped,
}


def drive_message(
    command: DriveCommand, type_name: str, wheelbase_m: float, since_epoch: int | None = None
) -> Fields:
    """Return the message for a command.

    Args:
        command: Speed and steering angle.
        type_name: One of the types of `service.files.ros2_block.CommandType`.
        wheelbase_m: Of the vehicle, m.
        since_epoch: When it is sent, in ns since 1970; None: now.
    """
    since = time.time_ns() if since_epoch is None else since_epoch
    sec, nanosec = divmod(since, NANOSECONDS_PER_SECOND)
    return _BODIES[type_name](command, wheelbase_m, {"sec": sec, "nanosec": nanosec})
