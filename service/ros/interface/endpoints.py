"""Services and topics of the interface, and the listeners of the topics.

Messages are mappings, as in JSON, with all fields of their type. Where ROS has no type, those of
`system_modes_msgs` and a package of `message_sets` are used.
"""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

from domain.actor import Actor

Fields: TypeAlias = Mapping[str, Any]

OWN_NODE = "pilothouse"
"""Name of the ROS node for services and topics that belong to no system."""


@dataclass(frozen=True, slots=True)
class OfferedService:
    """A service that Pilothouse offers."""

    name: str
    """Full name, as `/actuation/change_state`."""
    type: str
    """As `lifecycle_msgs/srv/ChangeState`."""
    node: str
    """Name of the ROS node that has it, without the leading slash: the system, or `OWN_NODE`."""
    of_a_node: bool
    """Whether a lifecycle node offers it itself: then the gateway does not offer it in ROS 2."""
    call: Callable[[Fields, Actor], Awaitable[Fields]]
    """Takes a request and the caller, returns the response. That may take long, since success is
    reported only once it was verified.

    Raises:
        InvalidValueError: A field is unknown or has a wrong type.
    """
    writes: bool = False
    """Whether it changes something, so that its calls are in the audit trail."""


@dataclass(frozen=True, slots=True)
class OfferedTopic:
    """A topic that Pilothouse publishes."""

    name: str
    """Full name, as `/actuation/mode_event`."""
    type: str
    """As `system_modes_msgs/msg/ModeEvent`."""
    node: str
    """As in `OfferedService`."""
    of_a_node: bool
    """As in `OfferedService`."""
    latched: bool
    """Whether a late subscriber gets the last message (transient local)."""
    on_demand: bool = False
    """Whether the gateway listens only while somebody subscribes in ROS 2: making a message costs
    something."""


@dataclass(frozen=True, slots=True)
class SubscribedTopic:
    """A topic that Pilothouse subscribes to."""

    name: str
    """Full name, as `/battery_level`."""
    type: str
    """As `pilothouse_msgs/msg/BatteryLevel`."""
    take: Callable[[Fields, Actor], str | None]
    """Takes a message and its sender; returns what it ignored of a message that asks for a stop.

    Raises:
        PilothouseError: The message is rejected; nothing was changed.
    """
    needs_all: bool = False
    """Whether each message counts; False: an older one means nothing once there is a newer one."""


class Listeners:
    """The listeners of topics; a listener that was added twice gets each message twice."""

    def __init__(self) -> None:
        self._takes: dict[str, dict[object, Callable[[Fields], None]]] = {}

    def add(self, topic: str, take: Callable[[Fields], None]) -> Callable[[], None]:
        """Add a listener; return a function that removes it and may be called repeatedly."""
        token = object()
        self._takes.setdefault(topic, {})[token] = take
        return partial(self._remove, topic, token)

    def hears(self, topic: str) -> bool:
        """Tell whether a topic has a listener."""
        return topic in self._takes

    def send(self, topic: str, message: Fields) -> None:
        """Pass a message to all listeners of its topic."""
        for take in tuple(self._takes.get(topic, {}).values()):
            take(message)

    def _remove(self, topic: str, token: object) -> None:
        takes = self._takes.get(topic, {})
        takes.pop(token, None)
        if not takes:
            self._takes.pop(topic, None)
