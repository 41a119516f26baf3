"""What is on offer: each service, each topic that is published, and each that may be published to.

Messages are mappings, as in JSON, and have all fields of their type. Types are the native ones:
those of `system_modes_msgs` and `gem_state_msgs` where ROS itself has none.
"""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

Fields: TypeAlias = Mapping[str, Any]

OWN_NODE = "pilothouse"
"""Name of the ROS node that has what belongs to no system."""


@dataclass(frozen=True, slots=True)
class OfferedService:
    """One service."""

    name: str
    """Full name, as `/actuation/change_state`."""
    type: str
    """As `lifecycle_msgs/srv/ChangeState`."""
    node: str
    """Name of the ROS node that has it, without the leading slash: the system, or `OWN_NODE`."""
    of_a_node: bool
    """Whether a real ROS 2 node offers it by itself: then it is offered only where the nodes are
    none."""
    call: Callable[[Fields, str], Awaitable[Fields]]
    """Takes a request and who asks (as `rosbridge:127.0.0.1`), returns the response. A request is a
    success only once its end was verified, and so it may take its time.

    Raises:
        InvalidValueError: A field is unknown or has a wrong type.
    """


@dataclass(frozen=True, slots=True)
class OfferedTopic:
    """One topic that is published."""

    name: str
    """Full name, as `/actuation/mode_event`."""
    type: str
    """As `system_modes_msgs/msg/ModeEvent`."""
    node: str
    """As of `OfferedService`."""
    of_a_node: bool
    """As of `OfferedService`."""
    latched: bool
    """Whether who comes late gets the last message."""


@dataclass(frozen=True, slots=True)
class HeardTopic:
    """One topic that others may publish to."""

    name: str
    """Full name, as `/battery_level`."""
    type: str
    """As `gem_state_msgs/msg/BatteryLevelStamped`."""
    take: Callable[[Fields, str], None]
    """Is handed a message and who sent it.

    Raises:
        PilothouseError: It is refused; nothing was changed.
    """
