"""What all clients of rosbridge share of the robot."""

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
from service.ros.interface.endpoints import Fields, OfferedService, OfferedTopic, SubscribedTopic
from service.ros.interface.message_check import CHANGE_MODE, CHANGE_STATE, Shape
from service.ros.interface.services import CANCEL_TASKS


class Interface(Protocol):
    """What is used of `service.ros.interface.interface.RosInterface`."""

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
        """Hand each message of a topic to `take`, and return what ends that."""
        ...

    async def run(self) -> None:
        """Make messages of what happens, until cancelled."""
        ...


class Bridge:
    """The interface of the robot, with what rosbridge adds to it."""

    def __init__(
        self, interface: Interface, frames: FrameFeed, clock: Clock, calls_per_s: int
    ) -> None:
        """Begin.

        Args:
            interface: What is on offer.
            frames: Published 20 times a second: what goes by time is looked at then.
            clock: Of the robot.
            calls_per_s: Calls of services that one client address may make; twice as many may come
                at once.
        """
        self.interface = interface
        self.frames = frames
        self.clock = clock
        self.texts = PublishedTexts()
        self.turn = asyncio.Lock()
        """Held while a message of a client is done: one in each turn of the event loop."""
        topics: list[SubscribedTopic | OfferedTopic] = [
            *interface.heard.values(),
            *interface.topics.values(),
        ]
        self.services = RosApi(interface.services, topics, clock).services
        """Those of the interface and those of rosapi, by full name."""
        self.calls_per_s = calls_per_s
        self._buckets = TokenBuckets(calls_per_s)

    def may_call(self, service: str, caller: Actor) -> bool:
        """Count a call, and tell whether it may be made.

        As over HTTP, what makes the robot safe always may.

        Args:
            service: Full name.
            caller: With the address of the client.
        """
        return service == CANCEL_TASKS or not self._buckets.take(caller.label, self.clock.now())


_REQUESTS: Mapping[str, Shape] = {
    "lifecycle_msgs/srv/ChangeState": CHANGE_STATE,
    "system_modes_msgs/srv/ChangeMode": CHANGE_MODE,
    **{f"rosapi_msgs/srv/{name}": shape for name, shape in REQUESTS.items()},
}
"""What requests look like; those of other types are empty."""


def request_of(type_name: str, args: Mapping[str, Any] | list[Any] | None) -> Fields:
    """Return the request of a call with its fields by name.

    Args:
        type_name: Of the service.
        args: As `call_service` has them; a list holds values in the order of the definition.

    Raises:
        InvalidValueError: A list has more values than the request has fields.
    """
    if not isinstance(args, list):
        return args or {}
    names = (*_REQUESTS.get(type_name, {}),)
    if len(args) > len(names):
        there_are = f"takes {', '.join(names)}" if names else "takes nothing"
        raise InvalidValueError(f"{type_name} {there_are}, and {len(args)} values came", "/args")
    return dict(zip(names, args, strict=False))
