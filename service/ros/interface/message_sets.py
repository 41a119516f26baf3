"""Packages of messages with the same fields: ours, and one with the names of smart_polaris.

Their names are all that differs, so that a robot may offer one or the other, and a client of
rosbridge may name either.
"""

from collections.abc import Mapping
from enum import StrEnum
from types import MappingProxyType


class MessageSet(StrEnum):
    """A package of messages for signals and the state of the robot."""

    PILOTHOUSE = "pilothouse_msgs"
    """Source: examples/ros2/interfaces."""
    GEM = "gem_state_msgs"
    """Of smart_polaris, ported to ROS 2; whoever has it may use it."""


_GEM_NAMES: Mapping[str, str] = {
    "BatteryLevel": "BatteryLevelStamped",
    "EmergencyStop": "EstopStamped",
    "GpsAccuracy": "GpsAccuracyStamped",
    "SignalStrength": "SignalStrengthStamped",
    "SystemState": "SystemStateStamped",
    "TaskStatus": "TaskPlannerStatus",
    "Temperature": "TemperatureStamped",
}


def type_in(messages: MessageSet, name: str) -> str:
    """Return the full name of a message in a package.

    Args:
        messages: The package.
        name: As the message is named in our own, such as `BatteryLevel`.
    """
    given = _GEM_NAMES[name] if messages is MessageSet.GEM else name
    return f"{messages}/msg/{given}"


ALIASES: Mapping[str, str] = MappingProxyType(
    {type_in(MessageSet.GEM, name): type_in(MessageSet.PILOTHOUSE, name) for name in _GEM_NAMES}
)
"""Types of our own package, by that of the other one with the same fields."""


def own_type(type_name: str) -> str:
    """Return the type of our own package with the same fields, or the type itself."""
    return ALIASES.get(type_name, type_name)
