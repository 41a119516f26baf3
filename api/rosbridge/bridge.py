"""The services and topics of the robot, shared by all clients of rosbridge."""

import asyncio
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from api.http.gate.rate import TokenBuckets
from api.rosbridge.replies import PublishedTexts
from api.rosbridge.rosapi import REQUESTS, RosApi
from domain.actor import Actor
from domain.errors import InvalidValueError
from service.clock import Clock
from service.frame_feed import FrameFeed
from service.refused_readings import RefusedReadings
from service.ros.interface.endpoints import Fields, OfferedService, OfferedTopic, SubscribedTopic
from service.ros.interface.message_check import (
    CHANGE_MODE,
    CHANGE_STATE,
    DRIVE_WAYPOINTS,
    START_TASK,
    Shape,
)
from service.ros.interface.services import CANCEL_TASKS


class Interface(Protocol):
    """The used part of `service.ros.interface.interface.RosInterface`."""

    @property
    def services(self) -> Mapping[str, OfferedService]:
        """By full name."""
        ...

    @property
    def topics(self) -> Mapping[str, OfferedTopic]:
        """By full name."""
        ...

    @property
    def heard(self) -> Mapping[str, SubscribedTopic]:
        """By full name."""
        ...

    def listen(self, topic: str, take: Callable[[Fields], None]) -> Callable[[], None]:
        """Pass each message of a topic to `take`; return a function that ends this."""
        ...

    async def run(self) -> None:
        """Publish messages about events and states, until cancelled."""
        ...


class Bridge:
    """The interface of the robot, with the services that rosbridge adds to it."""

    def __init__(
        self,
        interface: Interface,
        frames: FrameFeed,
        clock: Clock,
        calls_per_s: int,
        refused: RefusedReadings,
    ) -> None:
        """Prepare.

        Args:
            interface: The services and topics.
            frames: Published 20 times a second; deadlines of clients are checked then.
            clock: Of the robot.
            calls_per_s: Service calls per second that one client address may make; twice as many
                may come at once.
            refused: Counts messages to topics of signals that cannot be read.
        """
        self.refused = refused
        self.interface = interface
        self.frames = frames
        self.clock = clock
        self.texts = PublishedTexts()
        self.turn = asyncio.Lock()
        """Held while a message is processed: one per pass of the event loop, for all clients."""
        topics: list[SubscribedTopic | OfferedTopic] = [
            *interface.heard.values(),
            *interface.topics.values(),
        ]
        self.services = RosApi(interface.services, topics, clock).services
        """The services of the interface and of rosapi, by full name."""
        self.calls_per_s = calls_per_s
        self._buckets = TokenBuckets(calls_per_s)

    def may_call(self, service: str, caller: Actor) -> bool:
        """Count a call, and tell whether it is within the rate limit.

        As over HTTP, calls that make the robot safe are not limited.

        Args:
            service: Full name.
            caller: The client, with its address.
        """
        return service == CANCEL_TASKS or not self._buckets.take(caller.label, self.clock.now())


_REQUESTS: Mapping[str, Shape] = {
    "lifecycle_msgs/srv/ChangeState": CHANGE_STATE,
    "system_modes_msgs/srv/ChangeMode": CHANGE_MODE,
    "pilothouse_msgs/srv/StartTask": START_TASK,
    "pilothouse_msgs/srv/DriveWaypoints": DRIVE_WAYPOINTS,
    **{f"rosapi_msgs/srv/{name}": shape for name, shape in REQUESTS.items()},
}
"""Fields of requests, by type of the service; those of other types are empty."""


def request_of(type_name: str, args: Mapping[str, Any] | list[Any] | None) -> Fields:
    """Return the request of a call with its fields by name.

    Args:
        type_name: Of the service.
        args: As in `call_service`; a list holds values in the order of the definition.

    Raises:
        InvalidValueError: A list has more values than the request has fields.
    """
    if not isinstance(args, list):
        return args or {}
    names = (*_REQUESTS.get(type_name, {}),)
    if len(args) > len(names):
        fields = f"has the fields {', '.join(names)}" if names else "has no fields"
        message = f"a request of {type_name} {fields}, but {len(args)} values were sent"
        raise InvalidValueError(message, "/args")
    return dict(zip(names, args, strict=False))
