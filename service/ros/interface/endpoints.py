"""Services and topics of the interface, and who listens to the topics.

Messages are mappings, as in JSON, and have all fields of their type. Types are the native ones:
those of `system_modes_msgs` and `gem_state_msgs` where ROS itself has none.
"""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

from domain.actor import Actor

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
    """Whether a lifecycle node has it itself: then it is not offered in ROS 2 again."""
    call: Callable[[Fields, Actor], Awaitable[Fields]]
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
    """Whether a late subscriber gets the last message."""


@dataclass(frozen=True, slots=True)
class SubscribedTopic:
    """One topic that others may publish to."""

    name: str
    """Full name, as `/battery_level`."""
    type: str
    """As `gem_state_msgs/msg/BatteryLevelStamped`."""
    take: Callable[[Fields, Actor], None]
    """Is handed a message and who sent it.

    Raises:
        PilothouseError: It is refused; nothing was changed.
    """


class Listeners:
    """The listeners of topics; one that was added twice gets each message twice."""

    def __init__(self) -> None:
        self._takes: dict[str, dict[object, Callable[[Fields], None]]] = {}

    def add(self, topic: str, take: Callable[[Fields], None]) -> Callable[[], None]:
        """Add a listener, and return what removes it; it may be called more than once."""
        token = object()
        self._takes.setdefault(topic, {})[token] = take
        return partial(self._remove, topic, token)

    def hears(self, topic: str) -> bool:
        """Tell whether anybody listens to a topic."""
        return topic in self._takes

    def send(self, topic: str, message: Fields) -> None:
        """Hand a message to all who listen to its topic."""
        for take in tuple(self._takes.get(topic, {}).values()):
            take(message)

    def _remove(self, topic: str, token: object) -> None:
        takes = self._takes.get(topic, {})
        takes.pop(token, None)
        if not takes:
            self._takes.pop(topic, None)
